#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/model/cell.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/gravity_torque.hpp"

namespace posewise::io {

/// The serial robot between two links of a URDF file.
struct UrdfSource {
    std::string path;
    std::string base_link;  ///< empty: the root of the tree
    std::string tip_link;   ///< empty: the only leaf below the base
};

enum class UrdfJointKind { Fixed, Revolute, Continuous, Prismatic };

/// A joint that moves as another one does: factor * q + offset.
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
    /// rad or m; a continuous joint's, and of one that turns beyond 1000 rad, are half a turn both
    /// ways. Nothing: the file states none, or both the same, or beyond 1000 m.
    std::optional<Interval> limits;
    double speed = 0;                   ///< largest, rad/s or m/s; 0: the file states none
    std::optional<UrdfMimic> mimic;     ///< of a joint that does not move by itself
    std::vector<std::string> warnings;  ///< what was not understood and left out, a sentence each
    FileLocation location;
};
/// Whether it is a joint of the chain, neither fixed nor a mimic.
bool is_driven(const UrdfJoint& joint);

struct UrdfRobot {
    UrdfSource source;  ///< no link's name is empty
    std::string name;
    std::vector<UrdfJoint> joints;  ///< from base to tip, fixed ones too
};

/// Reads the joints from base link to tip link. Throws InputError with path:line:column if the file
/// is no URDF, the links are not joined, or a joint on the way cannot be part of a serial chain:
/// floating or planar, a mimic of a joint that is not on the way, with a zero axis, with limits
/// that are out of order or in degrees by the look of them.
UrdfRobot read_urdf(const UrdfSource& source);

/// What a joint that is not fixed does.
Motion joint_motion(const UrdfJoint& joint);

/// What a joint is called in the chain, in columns and parameters: its name in the file, with '_'
/// for whatever is not a letter, digit or underscore.
std::string chain_joint_name(const std::string& urdf_name);

/// The chain from base link to tip link without error parameters; its flange is the tip link.
/// Throws InputError if a joint has no limits or two have one name.
Chain make_chain(const UrdfRobot& robot);

/// The masses of the links from base to tip; those that branch off are not among them. Throws
/// InputError with path:line:column for a link that is not in the file, for a mass that is missing,
/// negative or no number, and if no link has one.
std::vector<Load> read_urdf_loads(const UrdfSource& source);

/// The robot's own solids for a cell.
struct UrdfBodies {
    std::vector<Link> links;           ///< capsules around the collision shapes, from base to tip
    std::vector<std::string> skipped;  ///< what has none, a sentence each: meshes, mostly
};
/// Of the links from base to tip and of those that fixed joints hang on them. A box, cylinder,
/// sphere or capsule lies within its capsules, up to four of them where a box is flat. Of two that
/// overlap wherever the robot stands, though they are no neighbours, the smaller one is skipped.
/// Throws InputError with the place for a shape whose size is missing or not positive.
UrdfBodies read_urdf_bodies(const UrdfRobot& robot);

/// Largest speed of each joint of the chain, rad/s or m/s; empty unless the file states all.
VectorXd joint_speeds(const UrdfRobot& robot);

/// What to look at in the file, a sentence each: what was left out, joints without limits.
std::vector<std::string> describe_doubts(const UrdfRobot& robot);

/// A campaign file for the robot, complete but for what only its user knows, with comments that say
/// what to fill in. It shall stand at `path` and find the URDF from there.
std::string make_campaign_text(const UrdfRobot& robot, const std::string& path);

/// How much the origin of a joint was changed.
struct OriginChange {
    std::string joint;       ///< its name in the file
    double translation = 0;  ///< m
    double rotation = 0;     ///< rad
};

struct CalibratedUrdf {
    /// The file as it was, but for numbers in the origins of the joints below.
    std::string text;
    std::vector<OriginChange> changes;
    /// Parameters whose errors no origin between base and tip link can express: those after the
    /// last joint if no fixed joint follows it.
    std::vector<std::string> not_expressed;
    /// Error terms that are not zero: a URDF has no errors that depend on the configuration.
    std::vector<std::string> terms;
};

/// The URDF that predicts the pose of the tip link as `robot` does with error parameters
/// `parameters`, its error terms left out. `robot` moves as make_chain() of the source does, with
/// error parameters or other amounts. Each constant transform between two moving joints goes into
/// the origin of the second one, that after the last into the first fixed joint there.
CalibratedUrdf make_calibrated_urdf(const UrdfSource& source, const Chain& robot,
                                    const VectorXd& parameters);

}  // namespace posewise::io
