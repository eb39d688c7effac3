#include "posewise/measurement/campaign.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

TEST(Campaign, OrdersParametersBaseRobotSensor) {
    const Campaign campaign = tracked_campaign(fanuc());
    const auto names = parameter_names(campaign);
    ASSERT_EQ(names.size(), 33U);
    EXPECT_EQ(parameter_count(campaign), 33);
    EXPECT_EQ(names[0], "base.x");
    EXPECT_EQ(names[5], "base.rz");
    EXPECT_EQ(names[6], "Tx1");
    EXPECT_EQ(names[24], "target1.x");
    const auto is_angle = parameter_is_angle(campaign);
    EXPECT_EQ(std::count(is_angle.begin(), is_angle.end(), true), 3 + 10);
    EXPECT_FALSE(is_angle[2]);
    EXPECT_TRUE(is_angle[3]);
    EXPECT_FALSE(is_angle[6]);
    EXPECT_TRUE(is_angle[8]);  // Rx1
}

TEST(ParameterScale, FollowsTheSpreadAndItsExceptions) {
    Campaign campaign = tracked_campaign(planar_arm({1, 1}));
    campaign.spread = {2e-3, 3e-4, {{"dl2", 5e-3}}};
    VectorXd expected(19);
    expected << 2e-3, 2e-3, 2e-3, 3e-4, 3e-4, 3e-4, 3e-4, 2e-3, 3e-4, 5e-3,
        VectorXd::Constant(9, 2e-3);
    EXPECT_EQ(parameter_scale(campaign), expected);
    campaign.spread.by_name["dl3"] = 1;
    EXPECT_THROW(parameter_scale(campaign), InputError);
}

TEST(Advance, TurnsTheBaseAboutItsOwnOriginInWorldAxes) {
    const Campaign campaign = tracked_campaign(planar_arm({1, 1}));
    VectorXd step = VectorXd::Zero(19);
    step.head<6>() << 0.1, 0.2, 0.3, 0, 0, 0.5;
    step[7] = 4e-3;
    step[18] = 5e-3;
    const Parameters moved = advance(campaign, campaign.nominal, step);
    const Isometry3d& base = campaign.nominal.world_from_base;
    const Matrix3d turn = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()).toRotationMatrix();
    EXPECT_TRUE(moved.world_from_base.linear().isApprox(turn * base.linear(), 1e-14));
    EXPECT_TRUE(moved.world_from_base.translation().isApprox(
        base.translation() + Vector3d(0.1, 0.2, 0.3), 1e-15));
    EXPECT_EQ(moved.robot, Eigen::Vector4d(0, 4e-3, 0, 0));
    EXPECT_EQ(moved.sensor[8], campaign.nominal.sensor[8] + 5e-3);
}

TEST(StepBetween, HasTheDerivativeOfDifferences) {
    Campaign campaign = tracked_campaign(planar_arm({1, 1}));
    campaign.base_is_known[1] = true;
    const Index size = parameter_count(campaign);
    for (const double turn : {0.0, 1e-6, 1e-3, 0.7, 2.5}) {
        VectorXd step = VectorXd::LinSpaced(size, -0.3, 0.2);
        step.segment<3>(2) = turn * Vector3d(0.6, -0.5, 0.62);
        const Parameters to = advance(campaign, campaign.nominal, step);
        const MatrixXd D = differentiate_step(campaign, campaign.nominal, to);
        constexpr double h = 1e-5;
        for (Index k = 0; k < size; ++k) {
            const VectorXd d = h * VectorXd::Unit(size, k);
            const VectorXd difference =
                (step_between(campaign, campaign.nominal, advance(campaign, to, d)) -
                 step_between(campaign, campaign.nominal, advance(campaign, to, -d))) /
                (2 * h);
            EXPECT_TRUE(D.col(k).isApprox(difference, 1e-7)) << turn << ' ' << k;
        }
    }
}

TEST(Advance, KeepsTheBaseARotationForever) {
    RandomStream stream(51);
    const Campaign campaign = tracked_campaign(planar_arm({1, 1}));
    Parameters parameters = campaign.nominal;
    for (Index k = 0; k < sweep_count() * 10; ++k) {
        parameters = advance(campaign, parameters, random_vector(stream, 19, 1));
    }
    const Matrix3d R = parameters.world_from_base.linear();
    EXPECT_LT((R * R.transpose() - Matrix3d::Identity()).norm(), 1e-14);
}

TEST(WithRobot, StartsAtZeroErrorsAndForgetsTheSpreadOfLostParameters) {
    Campaign campaign = tracked_campaign(planar_arm({1, 1}));
    campaign.spread.by_name = {{"dl2", 5e-3}, {"target1.x", 1e-2}};
    const Campaign changed = with_robot(campaign, without_parameters(campaign.robot));
    EXPECT_EQ(parameter_count(changed), 15);
    EXPECT_EQ(changed.nominal.robot.size(), 0);
    EXPECT_EQ(changed.spread.by_name.size(), 1U);
    EXPECT_EQ(parameter_scale(changed)[6], 1e-2);
}

}  // namespace
}  // namespace posewise
