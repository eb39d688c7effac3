#include "../../src/io/measurements/matrix_file.hpp"
#include "fuzzed_file.hpp"
#include "posewise/io/measurements_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const io::CampaignFile campaign = testing::corpus_campaign("points");
    testing::read_or_refuse(data, size, "blocks.mat",
                            [](const std::string& path) { detail::read_matrix(path); });
    return testing::read_or_refuse(data, size, "measurements.mat", [](const std::string& path) {
        io::read_measurements(path, campaign);
    });
}
