#include "fuzzed_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const io::CampaignFile campaign = testing::corpus_campaign("points");
    static const Measurements measurements = simulate(campaign, {.pose_count = 3}).measurements;
    return testing::read_or_refuse(data, size, "estimate.json", [](const std::string& path) {
        io::is_made_from(path, measurements);
        io::read_earlier(path, campaign, {.is_prior = true});
        io::read_estimate(path, campaign);
    });
}
