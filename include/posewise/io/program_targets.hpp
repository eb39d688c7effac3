#pragma once

#include <string>
#include <vector>

#include "posewise/io/robot_programs.hpp"
#include "posewise/task/cartesian_targets.hpp"

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
    VectorXd steps = {};           ///< of the last digit in which each is written, rad or m
};

/// A position that is stated by coordinates of a tool in a frame.
struct PlaceTarget {
    std::string id;  ///< as of a JointTarget
    Isometry3d frame_from_tool = Isometry3d::Identity();
    std::vector<TextSpan> values;  ///< x, y, z, then the orientation as the format has it
    /// Numbers that say with which joints it is reached: ABB's cf1, cf4, cf6; KUKA's T; else none.
    std::vector<TextSpan> configuration = {};
    std::vector<long> states = {};  ///< those numbers
};

/// What replaces a PlaceTarget.
struct CorrectedPlace {
    Isometry3d frame_from_tool = Isometry3d::Identity();
    VectorXd nominal;  ///< the controller's joints there (rad) before
    VectorXd joints;   ///< and now
};

struct TargetProgram {
    std::string content;
    std::vector<JointTarget> targets;
    std::vector<PlaceTarget> places = {};
    /// Lines of targets that are no joint values, or that are added to others: they stay as they
    /// are.
    std::vector<long> others;
};

/// The formats whose programs can be corrected.
std::vector<std::string> target_format_names();

/// Which targets are read.
enum class TargetKinds {
    Joints,           ///< those of coordinates are among `others`
    JointsAndPlaces,  ///< of coordinates, too
};

/// Finds joint targets: FANUC's positions in joints (.ls), KUKA's aggregates A1 to A6 of PTP and of
/// AXIS and E6AXIS (.src, .dat), ABB's jointtargets (.mod), lists that moves of URScript take
/// (.script). If asked for, also places: FANUC's positions with CONFIG, KUKA's with X to C, ABB's
/// robtargets, poses p[...] that moves of URScript take. What else the program does is not looked
/// at. Throws InputError, with the place, for another format, a target that lacks joints or has one
/// where no robot is, places of several tools or frames, and a program without targets.
TargetProgram read_program_targets(const std::string& path, ProgramFormat format,
                                   const ControllerJoints& joints,
                                   TargetKinds kinds = TargetKinds::Joints);

/// Whether a place is reached with these controller joints (rad) in the configuration that is
/// stated with it, within 0.05 deg: ABB's quadrants of axes 1, 4 and 6 [ABB, RAPID reference,
/// confdata], the signs in KUKA's T [KUKA, expert programming, Status and Turn]. FANUC's CONFIG and
/// KUKA's S depend on the model of robot and are not looked at.
bool is_of_configuration(const PlaceTarget& place, ProgramFormat format, const VectorXd& joints);

/// The program with these controller joints (rad) in the place of its targets, and with these
/// places, in the digits that the file has, at least those of joint_steps() (quaternions: 8). A
/// value that is the same in these digits, and all else, stays as it is, byte by byte. Throws
/// InputError where a correction would need another turn number in FANUC's CONFIG.
std::string replace_targets(const TargetProgram& program, ProgramFormat format,
                            const ControllerJoints& joints, const std::vector<VectorXd>& values,
                            const std::vector<CorrectedPlace>& places = {});

/// Writes replace_targets() to a file.
void write_program_targets(const std::string& path, const TargetProgram& program,
                           ProgramFormat format, const ControllerJoints& joints,
                           const std::vector<VectorXd>& values,
                           const std::vector<CorrectedPlace>& places = {});

/// Reads Cartesian targets (CSV): config; x, y, z with _mm or _m; the orientation as rx, ry, rz (a
/// rotation vector) or roll, pitch, yaw with _deg or _rad, or as qw, qx, qy, qz; and, all or none,
/// joint values near those that are meant, the campaign's or, with
/// CampaignFile::has_controller_columns, the controller's. Other columns are refused.
std::vector<CartesianTarget> read_cartesian_targets(const std::string& path,
                                                    const CampaignFile& campaign);

}  // namespace posewise::io
