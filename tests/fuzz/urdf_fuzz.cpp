#include "fuzzed_file.hpp"
#include "posewise/io/robot_files.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "robot.urdf", [](const std::string& path) {
        const io::UrdfRobot robot = io::read_urdf({path, "", ""});
        io::make_chain(robot);
        io::describe_doubts(robot);
        io::make_campaign_text(robot, path);
        io::read_urdf_loads(robot.source);
    });
}
