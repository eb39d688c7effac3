#include <gtest/gtest.h>

#include <functional>

#include "posewise/core/errors.hpp"
#include "posewise/model/cell.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using testing::random_vector;
using testing::sweep_count;

/// Least of a function over points of a segment: a fine grid, then a finer one about the best.
double sampled_least(const Capsule& segment, const std::function<double(const Vector3d&)>& f) {
    double center = 0.5;
    double half_width = 0.5;
    double least = std::numeric_limits<double>::infinity();
    for (int level = 0; level < 6; ++level) {
        double best = center;
        for (int i = -20; i <= 20; ++i) {
            const double t = std::clamp(center + half_width * i / 20, 0.0, 1.0);
            const double value = f(segment.from + t * (segment.to - segment.from));
            if (value < least) {
                least = value;
                best = t;
            }
        }
        center = best;
        half_width /= 10;
    }
    return least;
}

/// Random capsules; one in ten has equal ends, one in ten is parallel to an axis.
Capsule random_capsule(RandomStream& stream) {
    Capsule capsule{random_vector(stream, 3, 1.5), random_vector(stream, 3, 1.5),
                    stream.uniform(0, 0.4)};
    const Index kind = stream.index(10);
    if (kind == 0) capsule.to = capsule.from;
    if (kind == 1) capsule.to = capsule.from + stream.uniform(-2, 2) * Vector3d::Unit(1);
    return capsule;
}

Box random_box(RandomStream& stream) {
    const Vector3d corner = random_vector(stream, 3, 1);
    return {corner, corner + Vector3d::Constant(1e-3) + random_vector(stream, 3, 1).cwiseAbs()};
}

/// Signed distance of a point to a box by its faces, edges and corners: independent of the library.
double sampled_signed_distance(const Vector3d& point, const Box& box) {
    const Vector3d nearest = point.cwiseMax(box.lower).cwiseMin(box.upper);
    if (nearest != point) return (point - nearest).norm();
    return -std::min((point - box.lower).minCoeff(), (box.upper - point).minCoeff());
}

TEST(Clearance, OfACapsuleToEachShapeIsWhatSamplingFinds) {
    for (Index i = 0; i < sweep_count(); ++i) {
        RandomStream stream(11, static_cast<std::uint64_t>(i));
        const Capsule capsule = random_capsule(stream);
        const Capsule other = random_capsule(stream);
        const Box box = random_box(stream);
        const Sphere sphere{random_vector(stream, 3, 1), stream.uniform(0.01, 0.5)};
        const HalfSpace wall{random_vector(stream, 3, 1), random_vector(stream, 3, 1).normalized()};
        const auto to_box = [&](const Vector3d& x) { return sampled_signed_distance(x, box); };
        const auto to_sphere = [&](const Vector3d& x) {
            return (x - sphere.center).norm() - sphere.radius;
        };
        const auto to_other = [&](const Vector3d& x) {
            return sampled_least(other, [&](const Vector3d& y) { return (x - y).norm(); }) -
                   other.radius;
        };
        const auto to_wall = [&](const Vector3d& x) { return wall.normal.dot(x - wall.point); };
        EXPECT_NEAR(clearance(capsule, box), sampled_least(capsule, to_box) - capsule.radius, 2e-6);
        EXPECT_NEAR(clearance(capsule, sphere), sampled_least(capsule, to_sphere) - capsule.radius,
                    2e-6);
        EXPECT_NEAR(clearance(capsule, other), sampled_least(capsule, to_other) - capsule.radius,
                    2e-6);
        EXPECT_NEAR(clearance(capsule, wall), sampled_least(capsule, to_wall) - capsule.radius,
                    2e-6);
        EXPECT_EQ(clearance(capsule, Shape(box)), clearance(capsule, box));
    }
}

TEST(Clearance, KnowsCrossingParallelAndTouchingSegments) {
    const Vector3d o = Vector3d::Zero();
    const Vector3d x = Vector3d::UnitX();
    const Vector3d y = Vector3d::UnitY();
    const Vector3d z = Vector3d::UnitZ();
    EXPECT_DOUBLE_EQ(distance(-x, x, z - y, z + y), 1);
    EXPECT_DOUBLE_EQ(distance(-x, x, -y, y), 0);
    EXPECT_DOUBLE_EQ(distance(o, x, y, y + x), 1);
    EXPECT_DOUBLE_EQ(distance(o, x, y + 2 * x, y + 3 * x), std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(distance(o, x, 3 * x, 5 * x), 2);
    EXPECT_DOUBLE_EQ(distance(o, x, x, x + y), 0);
    EXPECT_DOUBLE_EQ(distance(o, o, y, y), 1);
    const Box cube{Vector3d::Constant(-1), Vector3d::Constant(1)};
    EXPECT_DOUBLE_EQ(signed_distance(-3 * x, 3 * x, cube), -1);
    EXPECT_DOUBLE_EQ(signed_distance(2 * x - 5 * y, 2 * x + 5 * y, cube), 1);
    EXPECT_DOUBLE_EQ(signed_distance(o, o, cube), -1);
}

TEST(Clearance, ChangesByNoMoreThanTheCapsuleMoves) {
    for (Index i = 0; i < sweep_count(); ++i) {
        RandomStream stream(12, static_cast<std::uint64_t>(i));
        const Capsule capsule = random_capsule(stream);
        const Shape shapes[] = {random_box(stream), random_capsule(stream)};
        Capsule moved = capsule;
        moved.from += random_vector(stream, 3, 0.05);
        moved.to += random_vector(stream, 3, 0.05);
        const double motion =
            std::max((moved.from - capsule.from).norm(), (moved.to - capsule.to).norm());
        for (const Shape& shape : shapes) {
            EXPECT_LE(std::abs(clearance(moved, shape) - clearance(capsule, shape)),
                      motion + 1e-12);
        }
    }
}

TEST(Clearance, DoesNotDependOnWhereTheFrameIs) {
    RandomStream stream(13);
    for (int i = 0; i < 100; ++i) {
        const Capsule a = random_capsule(stream);
        const Capsule b = random_capsule(stream);
        const Isometry3d pose = testing::random_pose(stream);
        EXPECT_NEAR(clearance(pose * a, pose * b), clearance(a, b), 1e-12);
        EXPECT_NEAR(clearance(b, a), clearance(a, b), 1e-12);
    }
}

TEST(Contains, TellsInsideFromOutside) {
    const Box cube{Vector3d::Zero(), Vector3d::Ones()};
    EXPECT_TRUE(contains(cube, Vector3d(0.5, 0.5, 0.9)));
    EXPECT_FALSE(contains(cube, Vector3d(0.5, 0.5, 1.1)));
    EXPECT_TRUE(contains(HalfSpace{}, Vector3d(0, 0, -1)));
    EXPECT_FALSE(contains(HalfSpace{}, Vector3d(0, 0, 1)));
}

TEST(CheckShape, RejectsShapesWithoutExtent) {
    const Vector3d o = Vector3d::Zero();
    const double nan = std::nan("");
    EXPECT_NO_THROW(check_shape(Capsule{o, o, 1}));
    EXPECT_THROW(check_shape(Box{o, Vector3d(1, 0, 1)}), InputError);
    EXPECT_THROW(check_shape(Box{o, Vector3d(1, nan, 1)}), InputError);
    EXPECT_THROW(check_shape(Sphere{o, 0}), InputError);
    EXPECT_THROW(check_shape(Sphere{o, nan}), InputError);
    EXPECT_THROW(check_shape(Capsule{o, Vector3d(nan, 0, 0), 1}), InputError);
    EXPECT_THROW(check_shape(Capsule{o, o, -1}), InputError);
    EXPECT_THROW(check_shape(HalfSpace{o, o}), InputError);
    EXPECT_THROW(check_shape(HalfSpace{o, Vector3d(0, 0, 2)}), InputError);
}

}  // namespace
}  // namespace posewise
