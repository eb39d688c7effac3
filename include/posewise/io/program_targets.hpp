#pragma once

#include <string>
#include <vector>

#include "posewise/io/robot_programs.hpp"

/// Joint targets of programs that exist, whoever wrote them: read, replaced in place, written.
namespace posewise::io {

/// Bytes [begin, end) of a text.
struct TextSpan {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// A position that is stated by joint values.
struct JointTarget {
    std::string id;                ///< "P[3]" of FANUC, else line and column: "12:14"
    VectorXd joints;               ///< values of the controller's joints, rad
    std::vector<TextSpan> values;  ///< where each stands in the program
};

struct TargetProgram {
    std::string content;
    std::vector<JointTarget> targets;
    /// Lines of targets that are no joint values, or that are added to others: they stay as they
    /// are.
    std::vector<long> others;
};

/// The formats whose programs can be corrected.
std::vector<std::string> target_format_names();

/// Finds joint targets: FANUC's positions in joints (.ls), KUKA's aggregates A1 to A6 of PTP and of
/// AXIS and E6AXIS (.src, .dat), ABB's jointtargets (.mod), lists that moves of URScript take
/// (.script). What else the program does is not looked at. Throws InputError, with the place, for
/// another format, a target that lacks joints or has one where no robot is, and a program without
/// joint targets.
TargetProgram read_program_targets(const std::string& path, ProgramFormat format,
                                   const ControllerJoints& joints);

/// The program with these controller joints (rad) in the place of its targets, in the digits that
/// the file has, at least those of joint_steps(). A value that is the same in these digits, and all
/// else, stays as it is, byte by byte.
std::string replace_targets(const TargetProgram& program, ProgramFormat format,
                            const ControllerJoints& joints, const std::vector<VectorXd>& values);

/// Writes replace_targets() to a file.
void write_program_targets(const std::string& path, const TargetProgram& program,
                           ProgramFormat format, const ControllerJoints& joints,
                           const std::vector<VectorXd>& values);

}  // namespace posewise::io
