#include <array>

#include "fuzzed_file.hpp"
#include "posewise/io/measurements_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::array campaigns{testing::corpus_campaign("points"),
                                      testing::corpus_campaign("poses"),
                                      testing::corpus_campaign("distances")};
    for (const io::CampaignFile& campaign : campaigns) {
        testing::read_or_refuse(data, size, "measurements.csv", [&](const std::string& path) {
            io::read_measurements(path, campaign);
        });
        testing::read_or_refuse(data, size, "program.csv",
                                [&](const std::string& path) { io::read_program(path, campaign); });
    }
    return 0;
}
