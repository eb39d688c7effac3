#pragma once

#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "posewise/model/geometry.hpp"

/// What stands around a robot and what it may do there: plain data, every part optional. All
/// places are in the robot's base frame, where a cell is surveyed; the tracker's comes from the
/// campaign's base pose, since the tracker's own frame is the world.
namespace posewise {

struct Interval {
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
};

/// A part of the robot as a solid, for collisions and sight lines.
struct Link {
    std::string name;
    /// Which frame of Chain::base_from_links() it is fixed to: 0 the base, j right after joint j
    /// (counting from 1), joint_count() + 1 the flange.
    Index frame = 0;
    Capsule solid;  ///< in that frame
};

/// A solid that links must not enter, and that hides what is behind it.
struct KeepOut {
    std::string name;
    Shape solid;
};

/// What the tracker must see, in its own frame: x ahead, z up; azimuth atan2(y, x), elevation above
/// the xy plane. Metres and radians; an interval left out does not restrict.
struct Sight {
    Interval range;
    Interval azimuth;  ///< at most a full turn wide; may lie across +-180 deg, as 150 to 210
    Interval elevation;
    /// Normals of the reflectors in the flange frame, length 1, one a target: the directions they
    /// look in. Empty: seen from everywhere.
    std::vector<Vector3d> normals;
    /// Largest angle between a reflector's normal and the direction to the tracker.
    double acceptance_half_angle = std::numbers::pi / 6;
    /// Whether links and keep-outs hide targets. A keep-out around the tracker itself hides none.
    bool is_line_required = true;
    /// How many targets must be seen at once; nothing: all. A pose measures those it shows.
    std::optional<Index> least_visible;
};

/// The two bodies that are nearest to each other where one of them moves: links, keep-outs, and
/// the balls at the targets.
struct Clearance {
    /// Of their surfaces, m; negative: how deep they overlap. Infinite: nothing is near.
    double distance = std::numeric_limits<double>::infinity();
    std::string body;   ///< a link's name, or "target 1"
    std::string other;  ///< a keep-out's name, or a link's
};

/// What configurations keep from the joint limits.
struct JointMargin {
    double angle = 0;   ///< of revolute joints, rad
    double length = 0;  ///< of prismatic joints, m
};

struct Cell {
    JointMargin limit_margin;
    std::map<Index, double> fixed_joints;  ///< joint index (from 0) to its value, rad or m
    /// Least distance of two poses of a plan, see joint_distance(); rad or m.
    double least_joint_distance = 0;
    /// Every target must lie in one of them; empty: anywhere.
    std::vector<Box> target_boxes;
    std::vector<Link> links;
    std::vector<KeepOut> keep_outs;
    /// What links and the balls at the targets keep from keep-outs and from each other, m.
    double safety_distance = 0;
    std::optional<Sight> sight;
    VectorXd home;     ///< where visiting starts, rad or m; empty: anywhere
    VectorXd speed;    ///< largest speed of each joint, rad/s or m/s; empty: 1
    double dwell = 0;  ///< that the robot stands still for each sample, s
};

}  // namespace posewise
