#include "fuzzed_file.hpp"
#include "posewise/io/robot_files.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "kinematics.yaml",
                                   [](const std::string& path) { io::read_ur_kinematics(path); });
}
