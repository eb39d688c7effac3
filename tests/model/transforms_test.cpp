#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "posewise/model/chain.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

Isometry3d pose_of(const std::vector<Element>& elements, double q) {
    const Chain chain({{"q1", -4, 4}}, elements);
    return chain.base_from_flange(VectorXd::Constant(1, q), VectorXd());
}

TEST(RpyFromRotation, GivesTheRotationBack) {
    RandomStream stream(1);
    for (Index i = 0; i < sweep_count(); ++i) {
        const Matrix3d R = random_pose(stream).linear();
        EXPECT_LT((rotation_from_rpy(rpy_from_rotation(R)) - R).cwiseAbs().maxCoeff(), 2e-15);
    }
}

TEST(RpyFromRotation, GivesTheRotationBackAtUprightPitch) {
    RandomStream stream(2);
    for (const double distance : {0.0, 1e-17, 1e-14, 1e-12, 1e-10, 1e-8, 1e-5, -1e-13, -1e-9}) {
        for (const double sign : {-1.0, 1.0}) {
            const Vector3d rpy(stream.uniform(-3, 3), sign * std::numbers::pi / 2 - distance,
                               stream.uniform(-3, 3));
            const Matrix3d R = rotation_from_rpy(rpy);
            const Vector3d again = rpy_from_rotation(R);
            EXPECT_LT((rotation_from_rpy(again) - R).cwiseAbs().maxCoeff(), 2e-15) << distance;
            EXPECT_LE(std::abs(again[1]), std::numbers::pi / 2);
        }
    }
}

TEST(RpyFromRotation, IsWhatWasPutIn) {
    const Vector3d rpy(-2.5, 0.7, 3.1);
    EXPECT_TRUE(rpy_from_rotation(rotation_from_rpy(rpy)).isApprox(rpy, 1e-14));
}

TEST(OriginElements, AreTheOrigin) {
    RandomStream stream(3);
    const Vector3d xyz = random_vector(stream, 3, 2);
    const Vector3d rpy = random_vector(stream, 3, 1.5);
    auto elements = origin_elements(xyz, rpy);
    EXPECT_EQ(elements.size(), 6U);
    elements.push_back({Motion::Rotation, Axis::Z, 0, {{0, 1.0}}, ""});
    const Isometry3d pose = pose_of(elements, 0);
    EXPECT_TRUE(pose.translation().isApprox(xyz, 1e-15));
    EXPECT_TRUE(pose.linear().isApprox(rotation_from_rpy(rpy), 1e-15));
    EXPECT_TRUE(origin_elements(Vector3d::Zero(), Vector3d::Zero()).empty());
}

TEST(RotationBetween, IsTheSmallestThatTurnsOneDirectionIntoTheOther) {
    RandomStream stream(5);
    for (Index i = 0; i < sweep_count(); ++i) {
        const Vector3d from = random_vector(stream, 3, 2);
        const Vector3d to = random_vector(stream, 3, 2);
        const Matrix3d R = rotation_between(from, to);
        EXPECT_LT((R * from.normalized() - to.normalized()).norm(), 1e-13);
        const Vector3d turn = vector_from_rotation(R);
        EXPECT_LT(std::abs(turn.dot(from)), 1e-12);
        EXPECT_LT(std::abs(turn.dot(to)), 1e-12);
        EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-13);
        EXPECT_GT(R.determinant(), 0);
        const Matrix3d half_turn = rotation_between(from, -2 * from);
        EXPECT_LT((half_turn * from + from).norm(), 1e-13);
        EXPECT_GT(half_turn.determinant(), 0);
    }
}

TEST(JointElements, TurnAboutAndSlideAlongAnyAxis) {
    RandomStream stream(4);
    for (Index i = 0; i < sweep_count(); ++i) {
        Vector3d axis = random_vector(stream, 3, 1).normalized();
        if (i % 5 == 0) axis = (Vector3d::Unit(i % 3) + 1e-9 * axis).normalized();
        const double q = stream.uniform(-3, 3);
        const Isometry3d turned = pose_of(joint_elements(Motion::Rotation, axis, 0), q);
        const Matrix3d expected = Eigen::AngleAxisd(q, axis).toRotationMatrix();
        EXPECT_LT((turned.linear() - expected).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_TRUE(turned.translation().isZero(0));
        const Isometry3d slid = pose_of(joint_elements(Motion::Translation, axis, 0), q);
        EXPECT_LT((slid.translation() - q * axis).cwiseAbs().maxCoeff(), 1e-14);
        EXPECT_LT((slid.linear() - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-14);
    }
}

TEST(JointElements, OfACoordinateAxisAreOne) {
    for (Index k = 0; k < 3; ++k) {
        for (const double sign : {1.0, -1.0}) {
            const auto elements = joint_elements(Motion::Rotation, sign * Vector3d::Unit(k), 0);
            ASSERT_EQ(elements.size(), 1U);
            EXPECT_EQ(elements[0].axis, static_cast<Axis>(k));
            EXPECT_EQ(elements[0].joints[0].coefficient, sign);
        }
    }
}

}  // namespace
}  // namespace posewise
