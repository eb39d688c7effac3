#include "fuzzed_file.hpp"
#include "posewise/io/estimate_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const io::CampaignFile campaign = testing::corpus_campaign("points");
    return testing::read_or_refuse(data, size, "estimate.json", [](const std::string& path) {
        io::measurements_checksum_of(path);
        io::read_earlier(path, campaign, {.is_prior = true});
        io::read_estimate(path, campaign);
    });
}
