#pragma once

#include <variant>

#include "posewise/core/types.hpp"

/// Solid shapes and the exact distances between them that collision and sight lines need. Lengths
/// in m, all shapes of one call in the same frame.
namespace posewise {

/// All points within `radius` of the segment; radius 0 is the segment, equal ends a sphere.
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

/// Everything behind a plane: {x : normal . (x - point) <= 0}. The normal has length 1 and points
/// to the free side (up, for a floor).
struct HalfSpace {
    Vector3d point = Vector3d::Zero();
    Vector3d normal = Vector3d::UnitZ();
};

using Shape = std::variant<Box, Sphere, Capsule, HalfSpace>;

/// Throws InputError for a shape without extent, with a value that is not finite, or a normal
/// whose length is not 1.
void check_shape(const Shape& shape);

/// The capsule moved rigidly.
Capsule operator*(const Isometry3d& pose, const Capsule& capsule);

double distance(const Vector3d& point, const Vector3d& from, const Vector3d& to);

/// Distance between two segments: their lines' if its feet lie in both, else from an end.
double distance(const Vector3d& from_a, const Vector3d& to_a, const Vector3d& from_b,
                const Vector3d& to_b);

/// Signed distance of a point to a box's surface, negative inside.
double signed_distance(const Vector3d& point, const Box& box);

/// Least signed distance of a segment's points to the box; exact: where the segment leaves a slab
/// the function changes its formula, and within each piece the minimum is known.
double signed_distance(const Vector3d& from, const Vector3d& to, const Box& box);

/// Free space between a capsule and a shape: the distance of their surfaces, negative where they
/// overlap (then, how deep the capsule's axis lies in the shape, plus its radius). It is continuous
/// and changes by no more than a point of the capsule moves.
double clearance(const Capsule& capsule, const Box& box);
double clearance(const Capsule& capsule, const Sphere& sphere);
double clearance(const Capsule& capsule, const Capsule& other);
double clearance(const Capsule& capsule, const HalfSpace& half_space);
double clearance(const Capsule& capsule, const Shape& shape);

/// Whether a point lies in the shape's interior.
bool contains(const Shape& shape, const Vector3d& point);

}  // namespace posewise
