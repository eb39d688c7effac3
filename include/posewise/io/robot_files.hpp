#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/model/cell.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/dh.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/inspection.hpp"

namespace posewise::io {

/// The serial robot between two links of a URDF file.
struct UrdfSource {
    std::string path;
    std::string base_link;  ///< empty: the root of the tree
    std::string tip_link;   ///< empty: the only leaf below the base
};

enum class UrdfJointKind { Fixed, Revolute, Continuous, Prismatic };

/// A joint that follows another one: factor * q + offset.
struct UrdfMimic {
    std::string joint;  ///< its name in the file
    double factor = 1;
    double offset = 0;  ///< rad or m
};

/// A joint of a URDF file: parent_from_child(q) = origin(xyz, rpy) * motion about or along the
/// axis.
struct UrdfJoint {
    std::string name;
    UrdfJointKind kind = UrdfJointKind::Fixed;
    Vector3d xyz = Vector3d::Zero();    ///< m
    Vector3d rpy = Vector3d::Zero();    ///< see rotation_from_rpy()
    Vector3d axis = Vector3d::UnitX();  ///< unit vector
    /// rad or m; half a turn both ways for a continuous joint, and for a revolute one beyond
    /// 1000 rad. Nothing: the file states none, equal ones, or limits beyond 1000 m.
    std::optional<Interval> limits;
    double speed = 0;                   ///< largest, rad/s or m/s; 0: the file states none
    double pitch = 0;                   ///< see Joint::pitch; no URDF states one
    std::optional<UrdfMimic> mimic;     ///< for a joint that does not move by itself
    std::vector<std::string> warnings;  ///< what was not understood and is ignored, a sentence each
    FileLocation location;
};
/// Whether the joint is one of the chain's, neither fixed nor a mimic.
bool is_driven(const UrdfJoint& joint);

struct UrdfRobot {
    UrdfSource source;  ///< with no link name empty
    std::string name;
    std::vector<UrdfJoint> joints;  ///< from base to tip, including fixed ones
};

/// Reads the joints from base link to tip link. Throws InputError with path:line:column if the file
/// is no URDF, the links are not connected, or a joint between them cannot be part of a serial
/// chain: floating or planar, a mimic of a joint that is not between them, with a zero axis, with
/// limits that are out of order or look like degrees.
UrdfRobot read_urdf(const UrdfSource& source);

/// The motion of a joint that is not fixed.
Motion joint_motion(const UrdfJoint& joint);

/// Name of a joint in the chain, in columns and parameters: its name in the file, with '_' for
/// whatever is not a letter, digit or underscore.
std::string chain_joint_name(const std::string& urdf_name);

/// The chain from base link to tip link, without error parameters; its flange is the tip link.
/// Throws InputError if a joint has no limits or two have one name.
Chain make_chain(const UrdfRobot& robot);

/// Masses of the links from base to tip, without those that branch off. Throws InputError with
/// path:line:column for a link that is not in the file or moves with a mimic, for a mass that is
/// missing, negative or no number, and if no link has one.
std::vector<Load> read_urdf_loads(const UrdfSource& source);

/// The robot's own solids, for a cell.
struct UrdfBodies {
    std::vector<Link> links;           ///< capsules around the collision shapes, from base to tip
    std::vector<std::string> skipped;  ///< shapes without capsules, a sentence each: mostly meshes
};
/// Encloses the links from base to tip and those fixed to them. A box, cylinder, sphere or capsule
/// lies within its capsules, up to four of them for a flat box. If two that are no neighbours
/// overlap wherever the robot stands, the smaller one is skipped. Throws InputError with the place
/// for a shape whose size is missing or not positive.
UrdfBodies read_urdf_bodies(const UrdfRobot& robot);

/// Largest speed of each joint of the chain, rad/s or m/s; empty unless the file states all.
VectorXd joint_speeds(const UrdfRobot& robot);

/// What to check in the file, a sentence each: ignored parts, joints without limits.
std::vector<std::string> describe_doubts(const UrdfRobot& robot);

/// A campaign file for the robot, complete except for what only its user knows; its comments say
/// what to fill in. It must be saved as `path`, from where it refers to the URDF.
std::string make_campaign_text(const UrdfRobot& robot, const std::string& path);

/// Change of a joint's origin.
struct OriginChange {
    std::string joint;       ///< its name in the file
    double translation = 0;  ///< m
    double rotation = 0;     ///< rad
};

struct CalibratedUrdf {
    /// The file as it was, except for numbers in the origins of the joints below.
    std::string text;
    std::vector<OriginChange> changes;
    /// Parameters that no origin between base and tip link can express: those after the last joint
    /// if no fixed joint follows it.
    std::vector<std::string> not_expressed;
    /// Error terms that are not zero; a URDF has no errors that depend on the configuration.
    std::vector<std::string> terms;
};

/// The URDF that predicts the pose of the tip link as `robot` does with error parameters
/// `parameters`, without error terms. `robot` moves like make_chain() of the source, but has error
/// parameters or other amounts. Each constant transform between two moving joints goes into the
/// origin of the second one, the one after the last joint into the first fixed joint there.
CalibratedUrdf make_calibrated_urdf(const UrdfSource& source, const Chain& robot,
                                    const VectorXd& parameters);

// Calibrated robots in formats for other programs. A file is read back before it replaces an old
// one. All functions return its largest flange difference from `robot` with these errors (error
// terms left out) over 1000 configurations. They throw InputError, and leave the place as it was,
// if that exceeds 1e-9 m or 1e-9 rad (for UR kinematics by more than ur_rounding), or if no file
// can be at that place.

/// `urdf` is make_calibrated_urdf() of the other arguments. What it could not express is left out.
FlangeDifference write_calibrated_urdf(const std::string& path, const CalibratedUrdf& urdf,
                                       const UrdfSource& source, const Chain& robot,
                                       const VectorXd& errors);

/// `rows` are dh_rows() of the robot; `title` becomes a comment at the top.
FlangeDifference write_dh(const std::string& path, const std::string& title,
                          const std::vector<DhRow>& rows, const Chain& robot,
                          const VectorXd& errors);

/// The file config/<type>/default_kinematics.yaml of the ROS package ur_description. `frames` are
/// ur_frames() of the robot. Its hash, "posewise_" and 16 digits, is a checksum of the numbers; the
/// controller's own, "calib_...", identifies the factory's.
FlangeDifference write_ur_kinematics(const std::string& path, const std::string& title,
                                     const UrFrames& frames, const Chain& robot,
                                     const VectorXd& errors);

/// A model for MuJoCo (MJCF): qpos of the joints that are called as the robot's are their values,
/// rad or m. A joint "q2.2", where q2 drives a further element (couplings) or one by another
/// factor, follows it by an equality. Sites are "flange" and "target1", ... or "tool"; masses are
/// not known. Throws InputError also if a joint drives no element by a factor of 1 or -1.
FlangeDifference write_mujoco(const std::string& path, const std::string& title,
                              const Geometry& geometry);

/// Parameters for RoboDK, a Python script (.py) that sends them: modified Denavit-Hartenberg rows
/// in rad and mm, with frames before and behind. It was not tried in RoboDK. `table` is
/// modified_dh() of the robot.
FlangeDifference write_robodk(const std::string& path, const std::string& title,
                              const ModifiedDh& table, const Chain& robot, const VectorXd& errors);

/// Reads UR kinematics. Throws InputError with path:line:column for another file.
UrFrames read_ur_kinematics(const std::string& path);

/// A robot as the section `robot` of a campaign file with a standard Denavit-Hartenberg table, in
/// mm and deg with enough digits to read the numbers back. `rows` are those of dh_rows(); names and
/// limits are those of the chain's joints. Throws InputError if a joint drives two rows and no row
/// is its own.
std::string make_dh_text(const Chain& chain, const std::vector<DhRow>& rows);

/// Writes a map for a cell's own software, with what it is, how it is used and how far it is off:
/// a C99 source with the table and two functions (`.c`), or the table alone (`.csv`). Throws
/// InputError for another ending.
void write_correction_map(const std::string& path, const std::string& title,
                          const CorrectionMap& map);

/// Throws InputError unless the path ends in .c or .csv.
void check_map_path(const std::string& path);

}  // namespace posewise::io
