#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "posewise/core/random.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/task/calibration.hpp"
#include "support/derivative_check.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

using namespace testing;

/// An estimate of the nominal parameters with any covariance.
Estimate estimate_of(const Campaign& campaign) {
    Estimate estimate;
    estimate.parameters = campaign.nominal;
    const Index count = parameter_count(campaign);
    const MatrixXd root = MatrixXd::NullaryExpr(count, count, [](Index i, Index j) {
        return 1e-4 * std::sin(static_cast<double>(3 * i + 7 * j + i * j));
    });
    estimate.covariance = root * root.transpose();
    return estimate;
}

/// A small motion of `place` from `from`, along the axes of the frame that both are in.
VectorXd motion(const Isometry3d& from, const Isometry3d& place) {
    VectorXd moved(6);
    moved << place.translation() - from.translation(),
        vector_from_rotation(place.linear() * from.linear().transpose());
    return moved;
}

/// Covariance of a place that follows from the parameters, by differences.
template <typename Function>
MatrixXd covariance_by_differences(const Campaign& campaign, const Estimate& estimate,
                                   const Function& place) {
    const Isometry3d from = place(estimate.parameters);
    const auto moved = [&](const VectorXd& step) {
        return motion(from, place(advance(campaign, estimate.parameters, step)));
    };
    const MatrixXd J = numerical_jacobian(moved, VectorXd::Zero(parameter_count(campaign)));
    return J * estimate.covariance * J.transpose();
}

/// The sensor's place of what is on the flange.
Isometry3d place_of(const Campaign& campaign, const Parameters& at) {
    if (const auto* poses = dynamic_cast<const PoseSensor*>(campaign.sensor.get())) {
        return poses->tool(at.sensor);
    }
    return dynamic_cast<const CameraSensor&>(*campaign.sensor).place(at.sensor);
}

void expect_near(const MatrixXd& found, const MatrixXd& expected) {
    EXPECT_LE((found - expected).norm(), 1e-8 * expected.norm());
}

TEST(FindHandEye, HasTheCovarianceThatDifferencesHave) {
    std::vector<std::string> found_of;
    for (const auto& [name, campaign] : campaigns_of_every_sensor(fanuc())) {
        const Estimate estimate = estimate_of(campaign);
        const auto found = find_hand_eye(campaign, estimate);
        if (!found) continue;
        found_of.push_back(name);
        SCOPED_TRACE(name);
        const auto on_flange = [&](const Parameters& at) { return place_of(campaign, at); };
        if (found->on_flange) {
            EXPECT_TRUE(found->on_flange->place.isApprox(on_flange(estimate.parameters), 1e-12));
            expect_near(found->on_flange->covariance,
                        covariance_by_differences(campaign, estimate, on_flange));
        }
        ASSERT_TRUE(found->at_base);
        const auto at_base = [](const Parameters& at) { return at.world_from_base.inverse(); };
        EXPECT_TRUE(found->at_base->place.isApprox(at_base(estimate.parameters), 1e-12));
        expect_near(found->at_base->covariance,
                    covariance_by_differences(campaign, estimate, at_base));
    }
    EXPECT_GE(found_of.size(), 5U);
    EXPECT_EQ(std::ranges::count(found_of, "pose from a camera on the flange"), 1);
}

TEST(FindHandEye, SaysNothingOfWhatIsKnownOrNoCamera) {
    const Campaign points = tracked_campaign(fanuc());
    EXPECT_FALSE(find_hand_eye(points, estimate_of(points)));
    CameraSetup setup = camera_on_flange();
    setup.known_place = Isometry3d::Identity();
    Campaign campaign = before_camera(points, setup);
    auto found = find_hand_eye(campaign, estimate_of(campaign));
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->is_camera_on_flange);
    EXPECT_FALSE(found->on_flange);
    EXPECT_TRUE(found->at_base);
    campaign.base_is_known = {true, true, true, false, true, true};
    found = find_hand_eye(campaign, estimate_of(campaign));
    EXPECT_EQ(Eigen::FullPivLU<MatrixXd>(found->at_base->covariance).rank(), 1);
    campaign.base_is_known.fill(true);
    EXPECT_FALSE(find_hand_eye(campaign, estimate_of(campaign))->at_base);
}

TEST(DeviationsOf, AreAlongTheAxesOfEitherFrame) {
    FoundPlace found;
    found.place.linear() = rotation_from_vector({0, 0, std::acos(0.0)});
    found.covariance.diagonal() << 1, 4, 9, 16, 25, 36;
    EXPECT_TRUE(deviations_of(found, false).isApprox((VectorXd(6) << 1, 2, 3, 4, 5, 6).finished()));
    EXPECT_TRUE(deviations_of(found, true).isApprox((VectorXd(6) << 2, 1, 3, 5, 4, 6).finished()));
}

TEST(EllipsoidOf, Has95PercentOfThePlaces) {
    FoundPlace found;
    Matrix3d root;
    root << 2, 0, 0, 1, 1, 0, -1, 0.5, 3;
    root *= 1e-4;
    found.covariance.topLeftCorner<3, 3>() = root * root.transpose();
    const Matrix3d half_axes = ellipsoid_of(found);
    EXPECT_TRUE((half_axes.transpose() * half_axes).isDiagonal(1e-9));
    EXPECT_LE(half_axes.col(0).norm(), half_axes.col(1).norm());
    EXPECT_LE(half_axes.col(1).norm(), half_axes.col(2).norm());
    const Matrix3d inverse = half_axes.inverse();
    RandomStream random(1, 0);
    Index inside = 0;
    constexpr Index count = 20000;
    for (Index k = 0; k < count; ++k) {
        const Vector3d drawn(random.normal(), random.normal(), random.normal());
        if ((inverse * (root * drawn)).norm() < 1) ++inside;
    }
    EXPECT_NEAR(static_cast<double>(inside) / count, 0.95, 0.005);
}

}  // namespace
}  // namespace posewise
