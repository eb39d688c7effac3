#pragma once

#include <fmt/format.h>

#include "io/format/atomic_file.hpp"
#include "posewise/io/robot_programs.hpp"
#include "support/places.hpp"

/// Programs of the FANUC cell, for each controller.
namespace posewise::io {

inline constexpr ProgramFormat all_formats[] = {
    ProgramFormat::Fanuc,   ProgramFormat::Kuka,    ProgramFormat::Abb,  ProgramFormat::Ur,
    ProgramFormat::Yaskawa, ProgramFormat::Staubli, ProgramFormat::Ros2, ProgramFormat::Csv};

inline std::string file_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return "CELL.LS";
        case ProgramFormat::Kuka:
            return "poses.src";
        case ProgramFormat::Abb:
            return "cell.mod";
        case ProgramFormat::Ur:
            return "cell.script";
        case ProgramFormat::Yaskawa:
            return "CELL.JBI";
        case ProgramFormat::Staubli:
            return "cell";
        case ProgramFormat::Ros2:
            return "cell.yaml";
        case ProgramFormat::Csv:
            break;
    }
    return "cell.csv";
}

inline bool has_handshake(ProgramFormat format) {
    return format != ProgramFormat::Ros2 && format != ProgramFormat::Csv;
}

/// The FANUC cell's campaign with a controller.
inline CampaignFile cell_with(const std::string& controller) {
    const std::string path = source_folder() + "/designs/cell_demo/campaign.yaml";
    return parse_campaign(detail::read_file(path) + "\ncontroller: " + controller + '\n', path);
}

inline const std::string example_pulses =
    "pulses_per_deg: [1341.38, 1907.67, 1592.89, 1022.86, 980.24, 454.75]";
inline const std::string reversed_joints =
    "{joints: [-q1, q2 - 90 deg, q3 - q2 + 90 deg, -q4, q5, -q6], " + example_pulses + "}";

inline std::string controller_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return "{maker: fanuc, j23_factor: 1}";
        case ProgramFormat::Kuka:
            return "{joints: [-q1, q2 - 90 deg, 90 deg - q3, q4, -q5, q6]}";
        case ProgramFormat::Yaskawa:
            return "{" + example_pulses + "}";
        case ProgramFormat::Ros2:
            return "{joints: {joint_1: q1, joint_2: q2, joint_3: q3, joint_4: q4, joint_5: q5, "
                   "joint_6: q6}}";
        default:
            return "{}";
    }
}

inline ProgramStop stop_at(const ControllerJoints& joints, const std::string& label,
                           const std::vector<double>& q_deg, Index samples = 1) {
    const VectorXd q = Eigen::Map<const VectorXd>(q_deg.data(), std::ssize(q_deg)) * to_radians(1);
    return {label, joints.to_controller(q), label != "home" && label != "via", samples};
}

/// Home, three poses and a via, home.
inline RobotProgram cell_program(const ControllerJoints& joints) {
    RobotProgram program;
    program.title = "posewise, FANUC R-2000iC/165F in a cell";
    program.date = "2026/01/31 12:00";
    program.joints = joints;
    program.stops = {
        stop_at(joints, "home", {0, -30, 0, 0, 0, 0}),
        stop_at(joints, "p1",
                {78.7863738, 16.9178212, -61.6481882, 101.9217523, -63.5325953, 28.3155305}),
        stop_at(joints, "via", {50, 0, -20, 95, -70, 60}),
        stop_at(joints, "p2",
                {32.7248523, -31.2371082, -17.7869347, 91.8262611, -81.6135222, 92.633084}, 2),
        stop_at(joints, "v1",
                {-10.9420508, 55.8516709, 42.5794502, 85.3322467, -40.4908827, 148.2132266}),
        stop_at(joints, "home", {0, -30, 0, 0, 0, 0})};
    program.dwell = 2;
    program.joint_speed = VectorXd::Constant(joints.count(), 2);
    return program;
}

}  // namespace posewise::io
