#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/model/controller.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/plan.hpp"
#include "posewise/task/planning.hpp"

/// Programs of joint moves for robot controllers, written and read back; designs/programs.md has an
/// example of each.
namespace posewise::io {

enum class ProgramFormat {
    Fanuc,    ///< TP program as text, .ls: degrees, 3 decimals
    Kuka,     ///< KRL, .src and .dat: degrees, 5 decimals
    Abb,      ///< RAPID module, .mod: degrees, 4 decimals
    Ur,       ///< URScript, .script: radians, 6 decimals
    Yaskawa,  ///< INFORM job, .jbi: whole pulses
    Staubli,  ///< VAL3 project, a folder: degrees, 5 decimals
    Ros2,     ///< JointTrajectory goals and named states, .yaml: radians and metres, 9 decimals
    Csv,      ///< .csv: degrees and millimetres, 6 decimals
};

/// "fanuc", "kuka", "abb", "ur", "yaskawa", "staubli", "ros2" or "csv".
std::string_view program_format_name(ProgramFormat format);
/// Throws InputError for any other.
ProgramFormat parse_program_format(const std::string& name);
std::vector<std::string> program_format_names();

/// The smallest step of each controller joint in such a file, rad or m. Throws InputError if the
/// format cannot have these joints, or for pulses that are not stated.
VectorXd joint_steps(ProgramFormat format, const ControllerJoints& joints);

/// What ends a stop at a measured pose, after the dwell.
enum class Handshake {
    None,
    Pause,  ///< an operator continues
    Io,     ///< digital output 1 says that it stands, input 1 that it was measured
};

/// One stop of a program; every move ends in one.
struct ProgramStop {
    /// The name of a measured pose; of another stop "home", "via" or, read back, nothing.
    std::string label;
    VectorXd joints;  ///< controller joints, rad or m
    /// Read back: it has a name, or the program waits there.
    bool is_measured = false;
    Index samples = 1;        ///< how often the dwell
    FileLocation place = {};  ///< where it was read
};

/// A program of joint moves with an exact stop at the end of each.
struct RobotProgram {
    std::string title;  ///< for a comment
    std::string date;   ///< "2026/01/31 12:00", for Yaskawa's
    ControllerJoints joints;
    std::vector<ProgramStop> stops;
    Index speed_percent = 20;  ///< 1 to 100
    double settle = 0;         ///< standstill before the first sample, s
    double dwell = 2;          ///< s; 0: none
    Handshake handshake = Handshake::None;
    VectorXd joint_speed;  ///< the largest of each, rad/s or m/s, for ROS; empty: 1
};

/// Names for poses in programs, distinct whatever their case, in the order of the ids: the id where
/// it is at most 16 letters, digits and underscores, else what is legal of it.
std::vector<std::string> pose_labels(const std::vector<std::string>& ids);

/// The name of a program that comes nearest to this text and is legal for the controller: letters,
/// digits and underscores, none of its language's words, as long as it may be.
std::string legal_program_name(ProgramFormat format, std::string_view text);

/// Throws InputError for a stop with a joint that is missing, not finite or where no robot is.
void check_stops(const RobotProgram& program);

/// The files that write_robot_program() writes. Throws InputError if `path` has another ending than
/// the format's, or, where the file must have the program's name, one that is not legal.
std::vector<std::string> program_files(const std::string& path, ProgramFormat format,
                                       const RobotProgram& program);

/// Parts of an earlier, longer program of the same name that lie in its folder and that the new one
/// does not call.
std::vector<std::string> stale_program_files(const std::string& path, ProgramFormat format,
                                             const RobotProgram& program);

/// Writes the program and, unless its path is empty, the plan as it is sent as CSV of
/// write_configurations_csv(), in model coordinates: all files or none. Throws InputError as
/// joint_steps() and program_files(), for a handshake that the format has none of, for more stops
/// than the controller takes, and as check_stops().
void write_robot_program(const std::string& path, ProgramFormat format, const RobotProgram& program,
                         const std::string& sent_path, const Campaign& campaign, const Plan& sent);

/// Reads the stops of a program that write_robot_program() wrote, perhaps edited since: comments
/// name the move that follows. Throws InputError with the place for what is not a joint move to
/// numbers, or does not stop there.
std::vector<ProgramStop> read_robot_program(const std::string& path, ProgramFormat format,
                                            const ControllerJoints& joints);

/// A pose that a program visits elsewhere than was sent.
struct MovedPose {
    std::string id;
    Index joint = 0;    ///< joint of the controller that moved most
    double change = 0;  ///< rad or m
};

/// What a program that was read holds, in model coordinates.
struct ProgramContent {
    /// In the order of first visits; purposes as in write_configurations_csv().
    std::vector<std::string> ids;
    RowMatrixXd joints;  ///< stops x joints, rad or m
    std::vector<std::string> purposes;
    std::vector<std::string> dropped;  ///< poses of the plan that the program does not visit
    std::vector<MovedPose> moved;      ///< poses elsewhere than sent, by over half a step
    std::vector<std::string> added;  ///< names that the plan has none of, elsewhere than its poses
    /// Names that the plan has none of at one of its poses, and that: a visit of the reference
    /// pose.
    std::vector<std::pair<std::string, std::string>> again;
    /// Poses that a stop without a name is at.
    std::vector<std::string> recognised;
    /// Stops without a name where the program waits, at none of the plan's poses: "stop5" is the
    /// fifth move.
    std::vector<std::string> unnamed;
    Index visits = 1;                                         ///< how often most poses are visited
    std::vector<std::pair<std::string, Index>> other_visits;  ///< the others, and how often
    /// What keeps the robot from running it, see find_faults() of the task.
    std::vector<std::string> faults;
};

/// The stops as configurations, home and repeated visits left out. `sent` is empty where no plan is
/// known. A stop without a name is the pose of the plan that it is at, to half a step; else, if the
/// program waits there, a pose of its own; else a via. Throws InputError, beginning with `path`,
/// if visits of one pose differ by more than half a step, and for a campaign whose cell contradicts
/// itself.
ProgramContent program_content(const std::string& path, const std::vector<ProgramStop>& stops,
                               const CampaignFile& campaign, const VectorXd& steps,
                               const std::optional<Plan>& sent);

/// What was written.
struct ProgramReport {
    ProgramFormat format = ProgramFormat::Csv;
    std::vector<std::string> files;  ///< of the program
    std::string sent;                ///< the plan as it is sent, CSV
    Index stop_count = 0;            ///< moves
    Index visit_count = 0;           ///< moves to poses that are measured
    std::string by_hand = {};        ///< what is done by hand beside it, in words; empty: nothing
    std::optional<RoundingLoss> loss = {};
    std::vector<std::string> stale = {};  ///< see stale_program_files()
};
std::string to_json(const ProgramReport& report, const Campaign& campaign);
std::string to_json(const ProgramContent& content, const CampaignFile& campaign);

/// Writes CSV: config, the joints in degrees or mm, purpose.
void write_program_content(const std::string& path, const Campaign& campaign,
                           const ProgramContent& content);

// Joint targets of programs that exist, whoever wrote them: read, replaced in place, written.

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
    VectorXd steps = {};           ///< of the last digit in which each is to be written, rad or m
    VectorXd rounding = {};  ///< half of the last digit that each has, rad or m; 0: it has none
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

/// The tool that a program states for its places: URScript's set_tcp(p[...]), KUKA's $TOOL={...} or
/// $NULLFRAME, ABB's tool0 or tooldata of the same file.
struct StatedTool {
    long line = 0;
    Vector3d position = Vector3d::Zero();  ///< in the controller's flange frame, m
};

struct TargetProgram {
    std::string content;
    std::vector<JointTarget> targets;
    std::vector<PlaceTarget> places = {};
    std::optional<StatedTool> tool = {};  ///< of the places; nothing: no numbers state one
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
/// where no robot is, places of several tools or frames or that the program shifts, and a program
/// without targets.
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
