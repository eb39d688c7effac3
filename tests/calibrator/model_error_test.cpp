#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/simulation.hpp"
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

/// Coordinates of positions that were not measured: how many, and of how many the error is within
/// its 95 % interval.
struct Coverage {
    Index covered = 0;
    Index count = 0;
    double share() const { return static_cast<double>(covered) / static_cast<double>(count); }
};

void judge(const Campaign& campaign, const Parameters& truth, const Estimate& estimate,
           std::uint64_t seed, Coverage& coverage) {
    const RowMatrixXd fresh = detail::random_configurations(campaign.robot, 7, seed);
    const Blocks blocks = make_plain_blocks(campaign, estimate.parameters, fresh);
    for (Index i = 0; i < fresh.rows(); ++i) {
        const VectorXd q = fresh.row(i).transpose();
        const auto predict = [&](const Parameters& parameters) {
            return campaign.sensor->predict(world_from_flange(campaign, parameters, q),
                                            parameters.sensor);
        };
        const VectorXd error = predict(estimate.parameters) - predict(truth);
        const VectorXd deviations =
            (blocks[i] * estimate.covariance * blocks[i].transpose()).diagonal().cwiseSqrt();
        for (Index row = 0; row < 3; ++row) {  // of one target: the others are as far off
            coverage.covered += std::abs(error[row]) <= 1.96 * deviations[row] ? 1 : 0;
            ++coverage.count;
        }
    }
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

TEST(ModelError, MakesIntervalsHoldWhatTheySay) {
    const Campaign truth = full_campaign(2e-4);
    struct Case {
        double factor;  // of the true model error, stated
        Index poses;
        LossKind loss;
    };
    for (const auto& [factor, poses, loss] : {Case{0.5, 12, LossKind::Squares},
                                              {1, 12, LossKind::Squares},
                                              {2, 12, LossKind::Squares},
                                              {1, 5, LossKind::Squares},
                                              {1, 12, LossKind::Huber}}) {
        SCOPED_TRACE(::testing::Message()
                     << factor << " of the true, " << poses << " poses, " << loss_name(loss));
        LevenbergMarquardtOptions options;
        options.loss.kind = loss;
        const Campaign stated = stating(truth, factor * 2e-4);
        Coverage coverage;
        for (std::uint64_t run = 0; run < 60; ++run) {
            const Simulation simulated = simulate(truth, {poses, 1, 100 + run, 200 + run});
            const Parameters start =
                register_base_and_targets(stated, simulated.measurements).parameters;
            const Estimate estimate = identify(stated, simulated.measurements, start, options);
            judge(stated, simulated.truth, estimate, 300 + run, coverage);
        }
        EXPECT_GT(coverage.share(), 0.93);
        EXPECT_LT(coverage.share(), 0.97);
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
    EXPECT_NEAR(expected.total(), found.distance_rms, 0.2 * found.distance_rms);
    EXPECT_NEAR(expected.model, std::sqrt(3.0) * estimate.model_error, 1e-15);
    EXPECT_GT(expected.parameters, 0);
    EXPECT_NEAR(expected.noise, std::sqrt(3.0) * 5e-5, 1e-4);
}

}  // namespace
}  // namespace posewise
