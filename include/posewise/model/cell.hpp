#pragma once

#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "posewise/core/types.hpp"

/// Solid shapes and the exact distances between them, for collision checks and lines of sight.
/// Lengths in m; all shapes in one call share a frame.
namespace posewise {

/// All points within `radius` of a segment. Radius 0 is the segment itself; equal ends are a
/// sphere.
struct Capsule {
    Vector3d from = Vector3d::Zero();
    Vector3d to = Vector3d::Zero();
    double radius = 0;
};

struct Sphere {
    Vector3d center = Vector3d::Zero();
    double radius = 0;
};

/// A box with edges along the frame's axes.
struct Box {
    Vector3d lower = Vector3d::Zero();
    Vector3d upper = Vector3d::Zero();
};

/// All points on one side of a plane: {x : normal . (x - point) <= 0}. The normal has length 1 and
/// points to the free side (up, for a floor).
struct HalfSpace {
    Vector3d point = Vector3d::Zero();
    Vector3d normal = Vector3d::UnitZ();
};

using Shape = std::variant<Box, Sphere, Capsule, HalfSpace>;

/// Throws InputError for a shape without extent, with a value that is not finite, or a normal
/// whose length is not 1.
void check_shape(const Shape& shape);

/// The capsule after a rigid motion.
Capsule operator*(const Isometry3d& pose, const Capsule& capsule);

double distance(const Vector3d& point, const Vector3d& from, const Vector3d& to);

/// Distance between two segments: between their lines if both feet of the common normal lie on the
/// segments, else from an end.
double distance(const Vector3d& from_a, const Vector3d& to_a, const Vector3d& from_b,
                const Vector3d& to_b);

/// Signed distance from a point to the surface of a box, negative inside.
double signed_distance(const Vector3d& point, const Box& box);

/// Smallest signed distance from a segment to the box. Exact: the formula changes only where the
/// segment crosses a slab, and the minimum of each piece is known.
double signed_distance(const Vector3d& from, const Vector3d& to, const Box& box);

/// Free space between a capsule and a shape: the distance between their surfaces. Negative where
/// they overlap: the depth of the capsule's axis in the shape, plus its radius. It is continuous
/// and changes by no more than a point of the capsule moves.
double clearance(const Capsule& capsule, const Box& box);
double clearance(const Capsule& capsule, const Sphere& sphere);
double clearance(const Capsule& capsule, const Capsule& other);
double clearance(const Capsule& capsule, const HalfSpace& half_space);
double clearance(const Capsule& capsule, const Shape& shape);

/// Whether a point lies in the shape's interior.
bool contains(const Shape& shape, const Vector3d& point);

// The surroundings of a robot and what it may do there: plain data, every part optional. All places
// are in the robot's base frame, in which a cell is surveyed. The tracker's place follows from the
// campaign's base pose, because the tracker's own frame is the world.

struct Interval {
    double lower = -std::numeric_limits<double>::infinity();
    double upper = std::numeric_limits<double>::infinity();
};

/// A part of the robot as a solid, for collisions and sight lines.
struct Link {
    std::string name;
    /// The frame of Chain::base_from_links() it is fixed to: 0 is the base, j is right after joint
    /// j (counting from 1), joint_count() + 1 is the flange.
    Index frame = 0;
    Capsule solid;  ///< in that frame
};

/// A solid that links must not enter and that blocks lines of sight.
struct KeepOut {
    std::string name;
    Shape solid;
};

/// What the tracker must see, in its own frame: x ahead, z up; azimuth atan2(y, x), elevation above
/// the xy plane. Metres and radians; an unset interval does not restrict.
struct Sight {
    Interval range;
    Interval azimuth;  ///< at most a full turn wide; may cross +-180 deg, e.g. 150 to 210
    Interval elevation;
    /// Directions the reflectors look in: normals in the flange frame, length 1, one per target.
    /// Empty: visible from everywhere.
    std::vector<Vector3d> normals;
    /// Largest angle between a reflector's normal and the direction to the tracker.
    double acceptance_half_angle = std::numbers::pi / 6;
    /// Whether links and keep-outs hide targets. A keep-out around the tracker itself hides none.
    bool is_line_required = true;
    /// How many targets must be visible at once; nothing: all. A pose measures the visible ones.
    std::optional<Index> least_visible;
};

/// The two bodies nearest to each other, at least one of them moving: links, keep-outs, and the
/// balls at the targets.
struct Clearance {
    /// Distance between the surfaces, m; negative: depth of overlap. Infinite: nothing is near.
    double distance = std::numeric_limits<double>::infinity();
    std::string body;   ///< a link's name, or "target 1"
    std::string other;  ///< a keep-out's name, or a link's
};

/// Distance that configurations keep from the joint limits.
struct JointMargin {
    double angle = 0;   ///< for a revolute joint (rad)
    double length = 0;  ///< for a prismatic joint (m)
};

/// A sum of joints that all turn or all slide, and where it must lie: joints that one drive
/// couples, such as a forearm that its rod keeps off the upper arm.
struct JointSum {
    std::string name;       ///< as it was stated: "q3 - q2"
    VectorXd coefficients;  ///< of each joint of the robot
    Interval limits;        ///< rad or m
    double offset = 0;      ///< rad or m; its `name` includes that, its limits do not

    /// What its limits are of at a configuration, whose joints come first; rad or m.
    double amount(const VectorXd& q) const { return coefficients.dot(q.head(coefficients.size())); }
};

struct Cell {
    JointMargin limit_margin;
    std::vector<JointSum> joint_sums;
    std::map<Index, double> fixed_joints;  ///< joint index (from 0) to its value, rad or m
    /// Smallest distance between two poses of a plan, see joint_distance(); rad or m.
    double least_joint_distance = 0;
    /// Every target must lie in one of these boxes; empty: anywhere.
    std::vector<Box> target_boxes;
    std::vector<Link> links;
    std::vector<KeepOut> keep_outs;
    /// Distance that links and the balls at the targets keep from keep-outs and each other, m.
    double safety_distance = 0;
    std::optional<Sight> sight;
    VectorXd home;          ///< where the tour starts, rad or m; empty: anywhere
    VectorXd speed;         ///< largest speed of each joint, rad/s or m/s; empty: 1
    VectorXd acceleration;  ///< of each joint, rad/s^2 or m/s^2; empty: infinite
    double dwell = 0;       ///< standstill for each sample, s
    double settle = 0;      ///< standstill before the first sample of a pose, s
    /// Time to move the one reflector by hand from target to target, s; 0: every target has its
    /// own.
    double target_change = 0;
    Index stations = 1;  ///< places of the instrument, one after the other: all poses at each
    double station_change = 0;  ///< time to move the instrument to its next place, s
};

}  // namespace posewise
