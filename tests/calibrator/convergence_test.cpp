#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "support/campaigns.hpp"

// How many steps an identification takes where gross errors meet directions that only priors hold.

namespace posewise {
namespace {

/// Poses of a tool on an arm of seven joints, all errors of which are identified beside priors.
Campaign arm_campaign() {
    const Chain robot = without_parameters(testing::seven_joint_arm());
    Campaign campaign = testing::tracked_campaign(detail::full_model(robot));
    campaign.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 2e-4);
    campaign.nominal.sensor = tool_unknowns(Isometry3d(Eigen::Translation3d(0.01, 0.02, 0.12)));
    campaign.spread = population_spread(robot);
    campaign.spread.is_prior = true;
    campaign.model_error = campaign.model_error_orientation = 1e-4;
    return campaign;
}

/// Joints 1 and 7 stand still.
Measurements measure_at_rest(const Campaign& campaign, std::uint64_t seed) {
    RowMatrixXd configurations = detail::random_configurations(campaign.robot, 40, seed);
    configurations.col(0).setConstant(0.17);
    configurations.col(6).setConstant(-0.35);
    return simulate_measurements(campaign, draw_truth(campaign, seed + 1), configurations, 1,
                                 seed + 2);
}

void turn(Measurements& measured, Index configuration, const Vector3d& by) {
    auto orientation = measured.observations.row(configuration).tail<3>();
    const Matrix3d turned =
        rotation_from_vector(by) * rotation_from_vector(Vector3d(orientation.transpose()));
    orientation = vector_from_rotation(turned).transpose();
}

TEST(Convergence, TakesFewStepsBesideOrientationsThatAreTurnedAndJointsThatStandStill) {
    const Campaign campaign = arm_campaign();
    Index all = 0;
    constexpr Index campaigns = 20;
    for (std::uint64_t seed = 1; seed <= campaigns; ++seed) {
        Measurements measured = measure_at_rest(campaign, 10 * seed);
        const Vector3d axis =
            detail::random_configurations(campaign.robot, 1, seed).row(0).head<3>();
        turn(measured, 7, 3 * axis.normalized());
        turn(measured, 19, -3 * axis.reverse().normalized());
        const Parameters start = register_base_and_targets(campaign, measured).parameters;
        const Estimate estimate = identify(campaign, measured, start);
        EXPECT_EQ(estimate.ending, Ending::Converged) << seed;
        all += estimate.iterations;
    }
    EXPECT_LT(all, campaigns * 10);
}

TEST(Convergence, TakesHardlyMoreThanOneStepForEachModelErrorOfACleanCampaign) {
    const Campaign campaign = arm_campaign();
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Measurements measured = measure_at_rest(campaign, 10 * seed);
        const Parameters start = register_base_and_targets(campaign, measured).parameters;
        const Estimate estimate = identify(campaign, measured, start);
        EXPECT_EQ(estimate.ending, Ending::Converged) << seed;
        EXPECT_LE(estimate.iterations, 8) << seed;
    }
}

}  // namespace
}  // namespace posewise
