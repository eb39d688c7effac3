#include "fuzzed_file.hpp"
#include "posewise/io/robot_programs.hpp"

using namespace posewise;

namespace {

/// Six joints, and how the controller counts them, which tables of the pendant's joints name.
io::CampaignFile arm(const std::string& sections) {
    return io::parse_campaign(
        "name: arm\nrobot:\n  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, "
        "q3: {limits_deg: [-90, 90]}, q4: {limits_deg: [-90, 90]}, q5: {limits_deg: [-90, 90]}, "
        "q6: {limits_deg: [-90, 90]}}\n  elements: [Rz q1, Tx 300 mm, Ry q2, Tz 1 m, Ry -q3, "
        "Tx 1 m, Rx -q4, Ry -q5, Rx -q6]\n"
        "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n" +
            sections,
        "arm.yaml");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const io::CampaignFile model = arm("");
    static const io::CampaignFile pendant =
        arm("controller: {joints: {J3: q3 - q2}}\nmeasurements: {columns: controller}\n");
    for (const io::CampaignFile* const campaign : {&model, &pendant}) {
        testing::read_or_refuse(data, size, "targets.csv", [&](const std::string& path) {
            io::read_cartesian_targets(path, *campaign);
        });
    }
    return 0;
}
