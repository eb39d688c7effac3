#include "posewise/calibrator/registration.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/simulation.hpp"
#include "posewise/model/sampling.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

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
        const Parameters found = register_base_and_targets(blind, measurements);
        EXPECT_LT((found.world_from_base.matrix() - truth.world_from_base.matrix()).norm(), 1e-9);
        EXPECT_LT((found.sensor - truth.sensor).norm(), 1e-9);
    }
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
    const Parameters found = register_base_and_targets(campaign, measurements);
    EXPECT_LT((found.world_from_base.matrix() - campaign.nominal.world_from_base.matrix()).norm(),
              5e-4);
}

TEST(Registration, RefusesConfigurationsThatDoNotTurnTheTool) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    RowMatrixXd configurations = RowMatrixXd::Zero(8, 6);
    for (Index i = 0; i < 8; ++i) configurations(i, 0) = 0.1 * static_cast<double>(i);
    const auto measurements =
        simulate_measurements(campaign, campaign.nominal, configurations, 1, 3);
    EXPECT_THROW(register_base_and_targets(campaign, measurements), InputError);
}

}  // namespace
}  // namespace posewise
