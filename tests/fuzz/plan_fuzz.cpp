#include "fuzzed_file.hpp"
#include "posewise/io/result_files.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "plan.json",
                                   [](const std::string& path) { io::read_plan(path); });
}
