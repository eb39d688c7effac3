#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"

// The model error that is found beside priors, and what follows from it.

namespace posewise {
namespace {

using testing::fanuc;
using testing::tracked_campaign;

Campaign full_campaign(double model_error) {
    const Chain robot = without_parameters(fanuc());
    Campaign campaign = with_robot(tracked_campaign(fanuc()), detail::full_model(robot));
    campaign.spread = population_spread(robot);
    campaign.model_error = model_error;
    return campaign;
}

Campaign stating(Campaign campaign, double model_error) {
    campaign.model_error = model_error;
    return campaign;
}

TEST(ModelError, IsFoundWhateverIsStated) {
    const Campaign truth = full_campaign(3e-4);
    const Measurements measured = simulate(truth, {80, 1, 3, 4}).measurements;
    const Parameters start = register_base_and_targets(truth, measured).parameters;
    for (const double stated : {1e-4, 3e-4, 9e-4}) {
        const Estimate estimate = identify(stating(truth, stated), measured, start);
        EXPECT_NEAR(estimate.model_error, 3e-4, 0.15 * 3e-4) << stated;
        EXPECT_NEAR(estimate.variance_factor, 1, 0.15) << stated;
    }
    EXPECT_EQ(identify(stating(truth, 0), measured, start).model_error, 0);
    LevenbergMarquardtOptions as_stated;
    as_stated.finds_model_error = false;
    EXPECT_EQ(identify(stating(truth, 1e-4), measured, start, as_stated).model_error, 1e-4);
}

TEST(ModelError, IsFoundAsAMotionOfTheFlange) {
    const Campaign truth = full_campaign(2e-4);
    ASSERT_GT(truth.sensor->target_count(), 1);
    for (const double common : {0.0, 0.5, 0.9}) {
        Campaign moved = truth;
        moved.model_error_common = common;
        const Measurements measured = simulate(moved, {120, 1, 3, 4}).measurements;
        const Parameters start = register_base_and_targets(truth, measured).parameters;
        // Whatever part is expected to be common, how much there is is found.
        const Estimate estimate = identify(stating(truth, 1e-4), measured, start);
        EXPECT_NEAR(estimate.model_error, 2e-4, 0.15 * 2e-4) << common;
        EXPECT_TRUE(common < 0.9 || std::abs(estimate.variance_factor - 1) < 0.15);
    }
}

TEST(ModelError, TellsWhatToExpectAtPosesNotMeasured) {
    const Campaign truth = full_campaign(2e-4);
    const Simulation simulated = simulate(truth, {300, 1, 5, 6});
    std::vector<Index> used, others;
    for (Index i = 0; i < 300; ++i) (i < 20 ? used : others).push_back(i);
    const Measurements measured = take(simulated.measurements, used);
    const Measurements judged = take(simulated.measurements, others);
    const Parameters start = register_base_and_targets(truth, measured).parameters;
    const Estimate estimate = identify(stating(truth, 1e-4), measured, start);
    const ExpectedError expected = expected_error(truth, estimate, judged);
    const Metrics found = make_metrics(mean_residuals(truth, estimate.parameters, judged));
    EXPECT_NEAR(expected.total(), found.distance_rms, 0.25 * found.distance_rms);
    EXPECT_NEAR(expected.model, std::sqrt(3.0) * estimate.model_error, 1e-15);
    EXPECT_GT(expected.parameters, 0);
    EXPECT_NEAR(expected.noise, std::sqrt(3.0) * 5e-5, 1e-4);

    EXPECT_DOUBLE_EQ(expected_sample_error(truth, estimate, judged).total(), expected.total());
    const Measurements repeated = simulate(truth, {30, 4, 5, 6}).measurements;
    const ExpectedError mean = expected_error(truth, estimate, repeated);
    const ExpectedError sample = expected_sample_error(truth, estimate, repeated);
    EXPECT_NEAR(sample.noise, 2 * mean.noise, 1e-12);
    EXPECT_NEAR(sample.parameters, mean.parameters, 1e-12);
    EXPECT_NEAR(sample.model, mean.model, 1e-12);
}

}  // namespace
}  // namespace posewise
