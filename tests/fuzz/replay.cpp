// Instead of libFuzzer where the compiler has none: gives a target all files of its corpus, and as
// many mutants of them as asked for, the same ones each time.
//
//   posewise_fuzz_<reader> CORPUS COUNT
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

#include "fuzzed_file.hpp"
#include "support/mutate.hpp"

namespace {

void give(const std::string& input) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

std::string read(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    const std::filesystem::directory_iterator folder(argv[1]);
    const std::set<std::filesystem::path> paths(begin(folder), end(folder));
    const long count = std::atol(argv[2]);
    if (paths.empty() || count <= 0) return 2;
    posewise::RandomStream stream(1);
    for (const auto& path : paths) {
        const std::string seed = read(path);
        give(seed);
        for (long k = 0; k < count; ++k) give(posewise::testing::mutate_bytes(seed, stream));
    }
}
