#include "../../src/io/measurements/groups_file.hpp"
#include "fuzzed_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "groups.csv", [](const std::string& path) {
        detail::read_groups(path, {"0", "1", "2", "3"});
    });
}
