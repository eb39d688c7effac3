#include <gtest/gtest.h>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::tracked_campaign;

TEST(Registration, FindsAnyBaseAndTargetsFromNothing) {
    const Campaign blind = [] {
        Campaign campaign = tracked_campaign(testing::fanuc());
        campaign.nominal.world_from_base.setIdentity();
        campaign.nominal.sensor.setZero();
        return campaign;
    }();
    for (Index i = 0; i < testing::sweep_count() / 10; ++i) {
        RandomStream stream(41, static_cast<std::uint64_t>(i));
        Parameters truth;
        truth.world_from_base = testing::random_pose(stream);
        truth.robot = VectorXd::Zero(18);
        truth.sensor = testing::random_vector(stream, 9, 0.4);
        Campaign exact = blind;
        exact.model_error = 0;
        exact.sensor = std::make_shared<PointSensor>(
            std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-12);
        const auto configurations =
            random_configurations(blind.robot, 12, static_cast<std::uint64_t>(i));
        const Measurements measurements = simulate_measurements(exact, truth, configurations, 1, 5);
        const Parameters found = register_base_and_targets(blind, measurements).parameters;
        EXPECT_LT((found.world_from_base.matrix() - truth.world_from_base.matrix()).norm(), 1e-9);
        EXPECT_LT((found.sensor - truth.sensor).norm(), 1e-9);
    }
}

/// Any robot anywhere, its errors not known, measured as instruments do.
TEST(Registration, SucceedsForRandomRobots) {
    double worst = 0;
    for (Index i = 0; i < testing::sweep_count(); ++i) {
        RandomStream stream(83, static_cast<std::uint64_t>(i));
        Campaign campaign = tracked_campaign(testing::random_robot(stream));
        Parameters truth = campaign.nominal;
        truth.world_from_base = testing::random_pose(stream);
        truth.sensor = testing::random_vector(stream, 9, 0.4);
        campaign.nominal = {};
        campaign.nominal.robot = VectorXd::Zero(0);
        campaign.nominal.sensor = VectorXd::Zero(9);
        campaign.has_nominal_base = campaign.has_nominal_targets = false;
        const auto seed = static_cast<std::uint64_t>(i);
        const auto configurations = random_configurations(campaign.robot, 20, seed);
        const Measurements measurements =
            simulate_measurements(campaign, truth, configurations, 1, seed);
        const Parameters found = register_base_and_targets(campaign, measurements).parameters;
        const double miss = make_metrics(residuals(campaign, found, measurements)).distance_rms;
        EXPECT_LT(miss, 4e-4) << i;  // noise 0.05 and model error 0.1 mm a coordinate
        const Matrix3d R = found.world_from_base.linear();
        EXPECT_NEAR(R.determinant(), 1, 1e-9) << i;
        const double turned =
            Eigen::AngleAxisd(Matrix3d(R * truth.world_from_base.linear().transpose())).angle();
        worst = std::max(worst, turned);
        EXPECT_LT(turned, 2e-3) << i;
        EXPECT_LT((found.sensor - truth.sensor).cwiseAbs().maxCoeff(), 2e-3) << i;
    }
    RecordProperty("largest_turn_of_the_base_rad", std::to_string(worst));
}

TEST(Registration, WithKnownTargetsFindsTheBase) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>{Vector3d(0.3, 0.1, 0), Vector3d(0.2, -0.1, 0.1)},
        5e-5);
    campaign.nominal.sensor.resize(0);
    campaign.model_error = 0;
    const auto measurements = simulate_measurements(
        campaign, campaign.nominal, random_configurations(campaign.robot, 10, 2), 1, 3);
    const Parameters found = register_base_and_targets(campaign, measurements).parameters;
    EXPECT_LT((found.world_from_base.matrix() - campaign.nominal.world_from_base.matrix()).norm(),
              5e-4);
}

TEST(Registration, IsNotDeterminedByConfigurationsThatDoNotTurnTheTool) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    RowMatrixXd configurations = RowMatrixXd::Zero(8, 6);
    for (Index i = 0; i < 8; ++i) configurations(i, 0) = 0.1 * static_cast<double>(i);
    const auto measurements =
        simulate_measurements(campaign, campaign.nominal, configurations, 1, 3);
    const Registration registered = register_base_and_targets(campaign, measurements);
    EXPECT_EQ(registered.undetermined.find("these 8 configurations with 24 points do not"), 0U);
    EXPECT_THROW(determined(registered), InputError);
}

// ---- Robots of which the linear equations leave a part of the base's rotation open ----

/// Two joints; the second turns about z (all points move in planes) or about y.
Chain two_joint_arm(Axis second, double height, double upper_arm, double forearm) {
    const auto R = Motion::Rotation;
    return Chain({{"q1", -2, 2}, {"q2", -2, 2}},
                 {testing::driven(R, Axis::Z, 0), testing::translation(Axis::Z, height),
                  testing::translation(Axis::X, upper_arm), testing::driven(R, second, 1),
                  testing::translation(Axis::X, forearm)});
}

/// `count` targets, of which z is known or nothing.
Campaign with_targets(Chain robot, Index count, bool is_z_known) {
    Campaign campaign = tracked_campaign(std::move(robot));
    const VectorXd nominal = campaign.nominal.sensor;
    std::vector<Vector3d> positions;
    for (Index j = 0; j < count; ++j) positions.emplace_back(nominal.segment<3>(3 * j));
    const Targets targets(
        positions, std::vector<std::array<bool, 3>>(positions.size(), {false, false, is_z_known}));
    campaign.sensor = std::make_shared<PointSensor>(targets, IsotropicNoise{5e-5});
    campaign.nominal.sensor.resize(targets.unknown_count());
    for (Index j = 0; j < count; ++j) {
        for (Index axis = 0; axis < 3; ++axis) {
            const Index k = targets.unknown_index(j, axis);
            if (k >= 0) campaign.nominal.sensor[k] = nominal[3 * j + axis];
        }
    }
    return campaign;
}

TEST(Registration, FindsAnyBaseOfTwoJoints) {
    const std::vector<Campaign> campaigns{
        with_targets(two_joint_arm(Axis::Z, 0, 0.5, 0.4), 1, true),
        with_targets(two_joint_arm(Axis::Z, 0, 0.5, 0.4), 3, true),
        with_targets(two_joint_arm(Axis::Y, 0.3, 0, 0.4), 1, false),
        with_targets(two_joint_arm(Axis::Y, 0.3, 0, 0.4), 3, false),
        with_targets(two_joint_arm(Axis::Y, 0, 0, 0), 1, false),
        with_targets(testing::scara(), 1, true)};
    for (std::size_t k = 0; k < campaigns.size(); ++k) {
        for (Index i = 0; i < testing::sweep_count() / 20; ++i) {
            RandomStream stream(57 + k, static_cast<std::uint64_t>(i));
            Campaign blind = campaigns[k];
            Parameters truth = blind.nominal;
            truth.world_from_base = testing::random_pose(stream);
            blind.nominal.world_from_base.setIdentity();
            blind.nominal.sensor.setZero();
            blind.has_nominal_base = blind.has_nominal_targets = false;
            const auto seed = static_cast<std::uint64_t>(i);
            const auto measured = simulate_measurements(
                blind, truth, random_configurations(blind.robot, 20, seed), 1, seed);
            const Registration found = register_base_and_targets(blind, measured);
            ASSERT_TRUE(found.is_determined()) << k << ' ' << i << ' ' << found.undetermined;
            const Isometry3d base = found.parameters.world_from_base;
            const Isometry3d miss = truth.world_from_base.inverse() * base;
            EXPECT_LT((miss.matrix() - Isometry3d::Identity().matrix()).norm(), 2e-3)
                << k << ' ' << i;
            EXPECT_LT((found.parameters.sensor - truth.sensor).norm(), 2e-3) << k << ' ' << i;
        }
    }
}

TEST(Registration, AsksForTheHeightThatNoPoseOfAPlanarArmTells) {
    for (const Index targets : {1, 3}) {
        const Campaign campaign = with_targets(two_joint_arm(Axis::Z, 0, 0.5, 0.4), targets, false);
        const auto measured = simulate(campaign, {.pose_count = 20}).measurements;
        const std::string message = register_base_and_targets(campaign, measured).undetermined;
        EXPECT_NE(message.find("target1.z"), std::string::npos) << message;
        EXPECT_NE(message.find("like known: [z], keys base.known or sensor.targets.known"),
                  std::string::npos)
            << message;
    }
}

// ---- How many poses a calibration can do with ----

/// Whether simulated campaigns of so many poses are calibrated.
bool is_calibrated_by(const Campaign& campaign, Index count) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const SimulateOptions options{.pose_count = count, .truth_seed = seed, .seed = seed};
        const Measurements measured = simulate(campaign, options).measurements;
        const Registration found = register_base_and_targets(campaign, measured);
        if (!found.is_determined()) return false;
        if (identify(campaign, measured, found.parameters).ending != Ending::Converged)
            return false;
    }
    return true;
}

TEST(LeastCalibrationCount, IsEnoughAndNotOneTooMany) {
    Campaign poses = tracked_campaign(testing::fanuc());
    poses.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 1e-4);
    poses.nominal.sensor = tool_unknowns(Isometry3d(Eigen::Translation3d(0.28, 0.05, -0.11)));
    const std::vector<std::pair<Campaign, Index>> with_priors{
        {with_targets(testing::fanuc(), 1, false), 5},
        {with_targets(testing::fanuc(), 3, false), 3},
        {with_targets(two_joint_arm(Axis::Z, 0, 0.5, 0.4), 1, true), 5},
        {poses, 3}};
    for (const auto& [stated, least] : with_priors) {
        Campaign campaign = stated;
        campaign.spread = population_spread(campaign.robot);
        EXPECT_EQ(least_calibration_count(campaign), least);
        EXPECT_TRUE(is_calibrated_by(campaign, least)) << least;
        EXPECT_FALSE(is_calibrated_by(campaign, least - 1)) << least;
    }
    const Campaign without = with_targets(testing::fanuc(), 1, false);
    EXPECT_EQ(least_calibration_count(without), least_pose_count(without));
}

TEST(LeastCalibrationCount, NeedsNoNominalValues) {
    Campaign campaign = with_targets(testing::fanuc(), 3, false);
    campaign.base_is_known[2] = true;
    campaign.has_nominal_base = campaign.has_nominal_targets = false;
    EXPECT_EQ(least_calibration_count(campaign), least_pose_count(campaign));
}

}  // namespace
}  // namespace posewise
