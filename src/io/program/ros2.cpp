#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/text.hpp"
#include "io/format/yaml_reader.hpp"
#include "program_stops.hpp"

/// ROS 2: one trajectory_msgs/JointTrajectory for each stop, as YAML, and named states.
namespace posewise::detail {
namespace {

constexpr double least_ros_time = 0.5;  // s, of a move

/// Of a straight move at the program's speed. Where the robot begins is not known: half a turn or
/// a metre away.
double ros_move_time(const io::RobotProgram& program, std::size_t stop) {
    const VectorXd& to = program.stops[stop].joints;
    double longest = least_ros_time;
    for (Index i = 0; i < to.size(); ++i) {
        const bool turns = program.joints.motion(i) == Motion::Rotation;
        const double way = stop > 0 ? std::abs(to[i] - program.stops[stop - 1].joints[i])
                                    : (turns ? std::numbers::pi : 1);
        const double speed = program.joint_speed.size() > 0 ? program.joint_speed[i] : 1;
        longest = std::max(longest, way / speed * 100 / static_cast<double>(program.speed_percent));
    }
    return longest;
}

std::string ros_goal(const io::RobotProgram& program, std::size_t number) {
    const ProgramRules& rules = ros2_program().rules;
    const io::ProgramStop& stop = program.stops[number];
    const double time = std::ceil(ros_move_time(program, number) * 100) / 100;
    const double seconds = std::floor(time);
    return fmt::format(
        "  - name: \"{}\"\n    dwell_s: {}\n    trajectory:\n      joint_names: [{}]\n      "
        "points:\n        - positions: [{}]\n          velocities: [{}]\n          "
        "time_from_start: {{sec: {}, nanosec: {}}}\n",
        stop.label, seconds_text(dwell_of(rules, program, stop)),
        fmt::join(program.joints.names(), ", "),
        joints_text(rules, program.joints, stop.joints, ", "),
        fmt::join(std::vector<std::string>(static_cast<std::size_t>(stop.joints.size()), "0.0"),
                  ", "),
        static_cast<long long>(seconds), std::llround((time - seconds) * 1e9));
}

/// As in group_state of an SRDF, each pose once.
std::string ros_states(const io::RobotProgram& program) {
    const ProgramRules& rules = ros2_program().rules;
    std::string text = "named_states:\n";
    std::vector<std::string> known;
    for (const io::ProgramStop& stop : program.stops) {
        if (stop.label == "via" || std::ranges::find(known, stop.label) != known.end()) continue;
        known.push_back(stop.label);
        fmt::format_to(std::back_inserter(text), "  \"{}\": {{", stop.label);
        for (Index i = 0; i < stop.joints.size(); ++i) {
            fmt::format_to(std::back_inserter(text), "{}{}: {}", i == 0 ? "" : ", ",
                           program.joints.names()[static_cast<std::size_t>(i)],
                           joint_text(rules, program.joints.motion(i), stop.joints[i]));
        }
        text += "}\n";
    }
    return text;
}

/// A time, s. Throws InputError below 0.
double read_seconds(const YamlValue& value) {
    if (value.number() < 0) throw value.error("is below 0; must not be");
    return value.number();
}

/// The point's positions in the order of the controller's joints.
std::vector<double> read_ros_positions(const YamlMap& trajectory, const ControllerJoints& joints) {
    const std::vector<YamlValue> names = trajectory.require("joint_names").list();
    const std::vector<YamlValue> points = trajectory.require("points").list();
    if (points.size() != 1) {
        throw trajectory.require("points").error("must have one point, where the robot stops");
    }
    const YamlMap point(points[0],
                        {"positions", "velocities", "accelerations", "effort", "time_from_start"});
    if (const auto time = point.find("time_from_start")) {
        const YamlMap parts(*time, {"sec", "nanosec"});
        for (const char* const part : {"sec", "nanosec"}) {
            if (const auto stated = parts.find(part)) read_seconds(*stated);
        }
    }
    const std::vector<double> positions = point.require("positions").numbers(names.size());
    std::vector<double> ordered(static_cast<std::size_t>(joints.count()));
    std::vector<bool> is_known(ordered.size());
    for (std::size_t k = 0; k < names.size(); ++k) {
        const auto found = std::ranges::find(joints.names(), names[k].text());
        if (found == joints.names().end()) {
            throw names[k].error("is " + quote(names[k].text()) + ", no joint of the controller; " +
                                 suggest(names[k].text(), joints.names()));
        }
        const auto joint = static_cast<std::size_t>(found - joints.names().begin());
        if (is_known[joint]) throw names[k].error("occurs twice");
        is_known[joint] = true;
        ordered[joint] = positions[k];
    }
    if (names.size() != ordered.size()) {
        throw trajectory.require("joint_names")
            .error(fmt::format("names {} joints; must name {}", names.size(), ordered.size()));
    }
    return ordered;
}

std::vector<FileContent> ros2_files(const std::string& path, const io::RobotProgram& program) {
    std::string text = fmt::format(
        "# {}\n# One goal a stop for a follow_joint_trajectory action: stand still for dwell_s "
        "before the next.\ngoals:\n",
        comment_text(program.title));
    for (std::size_t k = 0; k < program.stops.size(); ++k) text += ros_goal(program, k);
    return {{path, text + ros_states(program)}};
}

std::vector<io::ProgramStop> read_ros2(const std::string& path, const ControllerJoints& joints) {
    constexpr std::size_t most_bytes = 1 << 26;
    const YamlMap file(parse_yaml(read_file(path, most_bytes), path), {"goals", "named_states"});
    if (!file.find("named_states")) {
        throw input_error_at({path}, "has no named_states at its end; must be the whole file");
    }
    StopCollector stops(ros2_program().rules, joints);
    for (const YamlValue& goal : file.require("goals").list()) {
        const YamlMap map(goal, {"name", "dwell_s", "trajectory"});
        if (const auto name = map.find("name")) stops.name(name->text());
        const YamlMap trajectory(map.require("trajectory"), {"header", "joint_names", "points"});
        const TextLine line{"", map.require("trajectory").location()};
        stops.move(line, read_ros_positions(trajectory, joints));
        const auto dwell = map.find("dwell_s");
        if (dwell && read_seconds(*dwell) > 0) stops.wait();
    }
    return stops.finish();
}

}  // namespace

const ProgramKind& ros2_program() {
    static const ProgramKind kind{{.ending = ".yaml",
                                   .decimals = 9,
                                   .is_in_radians = true,
                                   .has_six_joints = false,
                                   .has_program_name = false,
                                   .has_pause = false,
                                   .has_io = false},
                                  &ros2_files,
                                  &read_ros2};
    return kind;
}

}  // namespace posewise::detail
