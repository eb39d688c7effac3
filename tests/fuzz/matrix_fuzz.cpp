#include "../../src/io/measurements/matrix_file.hpp"
#include "fuzzed_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "blocks.csv",
                                   [](const std::string& path) { detail::read_matrix(path); });
}
