#include "../../src/io/measurements/matrix_file.hpp"
#include "fuzzed_file.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto read = [](const std::string& path) { detail::read_matrix(path); };
    testing::read_or_refuse(data, size, "blocks.npz", read);
    return testing::read_or_refuse(data, size, "blocks.npy", read);
}
