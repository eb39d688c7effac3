#include "fuzzed_file.hpp"
#include "posewise/io/measurements_file.hpp"

using namespace posewise;

namespace {

/// An arm of six joints, whose tables others write, with this sensor.
io::CampaignFile arm_with(const std::string& sensor) {
    std::string text = "name: arm\nrobot:\n  joints:\n";
    for (int j = 1; j <= 6; ++j)
        text += "    q" + std::to_string(j) + ": {limits_deg: [-180, 180]}\n";
    text +=
        "  elements: [Rz q1, Tz 290 mm, Ry q2, Tz 270 mm, Ry q3, Tz 70 mm, Rx q4, Tx 302 mm, "
        "Ry q5, Tx 72 mm, Rx q6]\nsensor: " +
        sensor + '\n';
    return io::parse_campaign(text, "arm.yaml");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const io::CampaignFile poses =
        arm_with("{kind: poses, sigma_mm: 0.05, sigma_orientation_mrad: 0.2}");
    static const io::CampaignFile points =
        arm_with("{kind: points, sigma_mm: 0.05, targets: {count: 3}}");
    testing::read_or_refuse(data, size, "m.csv",
                            [](const std::string& path) { io::read_measurements(path, poses); });
    return testing::read_or_refuse(
        data, size, "m.yaml", [](const std::string& path) { io::read_measurements(path, points); });
}
