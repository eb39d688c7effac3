#include <algorithm>
#include <array>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/model/cell.hpp"

namespace posewise {
namespace {

using Eigen::Array3d;

/// How far a point lies beyond each of the box's three slabs; negative within.
Array3d excess(const Vector3d& point, const Box& box) {
    return (box.lower - point).cwiseMax(point - box.upper).array();
}

/// Arguments in (0, 1) at which a segment crosses the six planes of a box, sorted, with 0 and 1.
class Breakpoints {
  public:
    Breakpoints(const Vector3d& from, const Vector3d& step, const Box& box) {
        for (Index k = 0; k < 3; ++k) {
            if (step[k] == 0) continue;
            add((box.lower[k] - from[k]) / step[k]);
            add((box.upper[k] - from[k]) / step[k]);
        }
        values_[count_++] = 1;
        std::sort(values_.begin(), std::next(values_.begin(), static_cast<std::ptrdiff_t>(count_)));
    }
    std::size_t count() const { return count_; }
    double operator[](std::size_t i) const { return values_[i]; }

  private:
    void add(double t) {
        if (t > 0 && t < 1) values_[count_++] = t;
    }

    std::array<double, 8> values_{0};
    std::size_t count_ = 1;
};

/// Least distance of a segment's points to a box, 0 where they meet.
double unsigned_distance(const Vector3d& from, const Vector3d& step, const Box& box) {
    const Breakpoints at(from, step, box);
    double least = excess(from, box).max(0).matrix().norm();
    for (std::size_t i = 1; i < at.count() && least > 0; ++i) {
        // Between two breakpoints the squared distance is one quadratic function of t, made of
        // the slabs the piece lies beyond.
        const Vector3d middle = from + (at[i - 1] + at[i]) / 2 * step;
        double slope = 0;
        double curvature = 0;
        for (Index k = 0; k < 3; ++k) {
            const bool is_below = middle[k] < box.lower[k];
            if (!is_below && !(middle[k] > box.upper[k])) continue;
            slope += (from[k] - (is_below ? box.lower[k] : box.upper[k])) * step[k];
            curvature += step[k] * step[k];
        }
        const double t = curvature > 0 ? std::clamp(-slope / curvature, at[i - 1], at[i]) : at[i];
        least = std::min(least, excess(from + t * step, box).max(0).matrix().norm());
    }
    return least;
}

/// Least over the segment of the largest of the six linear functions that bound a box: found at an
/// end or where two of them are equal.
double least_excess(const Vector3d& from, const Vector3d& step, const Box& box) {
    std::array<double, 6> offset{};
    std::array<double, 6> slope{};
    for (Index k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(2 * k);
        offset[i] = box.lower[k] - from[k];
        offset[i + 1] = from[k] - box.upper[k];
        slope[i] = -step[k];
        slope[i + 1] = step[k];
    }
    double least = std::min(excess(from, box).maxCoeff(), excess(from + step, box).maxCoeff());
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (slope[i] == slope[j]) continue;
            const double t = (offset[j] - offset[i]) / (slope[i] - slope[j]);
            if (t > 0 && t < 1) least = std::min(least, excess(from + t * step, box).maxCoeff());
        }
    }
    return least;
}

void require(bool is_met, const char* what) {
    if (!is_met) throw InputError(what);
}

void check(const Box& box) {
    require(box.lower.allFinite() && box.upper.allFinite() &&
                (box.lower.array() < box.upper.array()).all(),
            "a box must have finite corners, the lower one below the upper one in x, y and z");
}

void check(const Sphere& sphere) {
    require(sphere.center.allFinite() && std::isfinite(sphere.radius) && sphere.radius > 0,
            "a sphere must have a finite center and a positive radius");
}

void check(const Capsule& capsule) {
    require(capsule.from.allFinite() && capsule.to.allFinite() && std::isfinite(capsule.radius) &&
                capsule.radius > 0,
            "a capsule must have finite ends and a positive radius");
}

void check(const HalfSpace& half_space) {
    require(half_space.point.allFinite() && std::abs(half_space.normal.norm() - 1) < 1e-9,
            "a half-space must have a finite point and a normal of length 1");
}

}  // namespace

void check_shape(const Shape& shape) {
    std::visit([](const auto& solid) { check(solid); }, shape);
}

Capsule operator*(const Isometry3d& pose, const Capsule& capsule) {
    return {pose * capsule.from, pose * capsule.to, capsule.radius};
}

double distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
    const Vector3d step = to - from;
    const double squared_length = step.squaredNorm();
    const double t =
        squared_length > 0 ? std::clamp((point - from).dot(step) / squared_length, 0.0, 1.0) : 0;
    return (point - from - t * step).norm();
}

double distance(const Vector3d& from_a, const Vector3d& to_a, const Vector3d& from_b,
                const Vector3d& to_b) {
    const Vector3d a = to_a - from_a;
    const Vector3d b = to_b - from_b;
    const Vector3d offset = from_b - from_a;
    const Vector3d normal = a.cross(b);
    const double squared = normal.squaredNorm();
    if (squared > 0) {  // the feet of the lines' common perpendicular, by Cramer's rule
        const double s = offset.cross(b).dot(normal) / squared;
        const double t = offset.cross(a).dot(normal) / squared;
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) return (from_a + s * a - from_b - t * b).norm();
    }
    return std::min({distance(from_a, from_b, to_b), distance(to_a, from_b, to_b),
                     distance(from_b, from_a, to_a), distance(to_b, from_a, to_a)});
}

double signed_distance(const Vector3d& point, const Box& box) {
    const Array3d beyond = excess(point, box);
    const double largest = beyond.maxCoeff();
    return largest > 0 ? beyond.max(0).matrix().norm() : largest;
}

double signed_distance(const Vector3d& from, const Vector3d& to, const Box& box) {
    const Vector3d step = to - from;
    const double inside = least_excess(from, step, box);
    return inside < 0 ? inside : unsigned_distance(from, step, box);
}

double clearance(const Capsule& capsule, const Box& box) {
    return signed_distance(capsule.from, capsule.to, box) - capsule.radius;
}

double clearance(const Capsule& capsule, const Sphere& sphere) {
    return distance(sphere.center, capsule.from, capsule.to) - capsule.radius - sphere.radius;
}

double clearance(const Capsule& capsule, const Capsule& other) {
    return distance(capsule.from, capsule.to, other.from, other.to) - capsule.radius - other.radius;
}

double clearance(const Capsule& capsule, const HalfSpace& half_space) {
    return std::min(half_space.normal.dot(capsule.from - half_space.point),
                    half_space.normal.dot(capsule.to - half_space.point)) -
           capsule.radius;
}

double clearance(const Capsule& capsule, const Shape& shape) {
    return std::visit([&](const auto& solid) { return clearance(capsule, solid); }, shape);
}

bool contains(const Shape& shape, const Vector3d& point) {
    return clearance(Capsule{point, point, 0}, shape) < 0;
}

}  // namespace posewise
