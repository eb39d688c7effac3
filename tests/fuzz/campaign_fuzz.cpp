#include "fuzzed_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "campaign.yaml",
                                   [](const std::string& path) { io::read_campaign(path); });
}
