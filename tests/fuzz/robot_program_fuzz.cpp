#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "fuzzed_file.hpp"
#include "posewise/io/robot_programs.hpp"

using namespace posewise;
using io::ProgramFormat;

namespace {

constexpr const char* data_of_none =
    "<Database><Datas><Data name=\"joints\"><Value key=\"0\" j1=\"1\" j2=\"2\" j3=\"3\" j4=\"4\" "
    "j5=\"5\" j6=\"6\"/></Data><Data name=\"slow\"><Value key=\"0\" blend=\"off\"/></Data></Datas>"
    "</Database>";
constexpr const char* move_to_none =
    "<Programs><![CDATA[\nbegin\n// p1\nmovej(joints[0],flange,slow)\nend\n]]></Programs>";

const io::CampaignFile& arm() {
    static const io::CampaignFile six = io::parse_campaign(
        "name: arm\nrobot:\n  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, "
        "q3: {limits_deg: [-90, 90]}, q4: {limits_deg: [-90, 90]}, q5: {limits_deg: [-90, 90]}, "
        "q6: {limits_deg: [-90, 90]}}\n  elements: [Rz q1, Tx 300 mm, Ry q2, Tz 1 m, Ry -q3, "
        "Tx 1 m, Rx -q4, Ry -q5, Rx -q6]\n"
        "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n"
        "controller: {pulses_per_deg: [1000, 1000, 1000, 1000, 1000, 1000]}\n",
        "arm.yaml");
    return six;
}

void read(const std::string& path, ProgramFormat format) {
    const auto stops = io::read_robot_program(path, format, arm().controller);
    io::program_content(path, stops, arm(), io::joint_steps(format, arm().controller),
                        std::nullopt);
}

/// Targets that are replaced by themselves leave the program as it is.
void replace(const std::string& path, ProgramFormat format) {
    const io::TargetProgram program =
        io::read_program_targets(path, format, arm().controller, io::TargetKinds::JointsAndPlaces);
    std::vector<VectorXd> values;
    for (const io::JointTarget& target : program.targets) values.push_back(target.joints);
    std::vector<io::CorrectedPlace> places;
    for (const io::PlaceTarget& place : program.places) {
        const VectorXd joints = VectorXd::Zero(6);
        io::is_of_configuration(place, format, joints);
        places.push_back({place.frame_from_tool, joints, joints});
    }
    io::replace_targets(program, format, arm().controller, values, places);
}

/// A project whose data, or else whose program, is the input.
int read_project(const std::uint8_t* data, std::size_t size, bool is_data) {
    static const testing::TemporaryFolder folder;
    const std::string project = folder.path("cell");
    std::filesystem::create_directory(project);
    std::ofstream(project + "/cell.dtx") << data_of_none;
    std::ofstream(project + "/start.pgx") << move_to_none;
    std::ofstream(project + "/cell.pjx") << "<Project/>";
    std::ofstream(project + "/stop.pgx") << "<Programs/>";
    const std::string name = is_data ? "/cell.dtx" : "/start.pgx";
    std::ofstream(project + name, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        read(project, ProgramFormat::Staubli);
    } catch (const InputError& error) {
        const std::string_view message = error.what();
        if (!message.starts_with(project) || message.find('\n') != message.npos) std::abort();
    }
    return 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::array<std::pair<ProgramFormat, const char*>, 7> formats{
        {{ProgramFormat::Fanuc, "CELL.LS"},
         {ProgramFormat::Kuka, "cell.src"},
         {ProgramFormat::Abb, "cell.mod"},
         {ProgramFormat::Ur, "cell.script"},
         {ProgramFormat::Yaskawa, "CELL.JBI"},
         {ProgramFormat::Ros2, "cell.yaml"},
         {ProgramFormat::Csv, "cell.csv"}}};
    for (const auto& [format, name] : formats) {
        const auto read_it = [kind = format](const std::string& path) { read(path, kind); };
        testing::read_or_refuse(data, size, name, read_it);
        const auto corrected = io::target_format_names();
        const std::string called(io::program_format_name(format));
        if (std::ranges::find(corrected, called) == corrected.end()) continue;
        const auto replace_it = [kind = format](const std::string& path) { replace(path, kind); };
        testing::read_or_refuse(data, size, name, replace_it);
    }
    read_project(data, size, true);
    return read_project(data, size, false);
}
