#include "../../src/calibrator/global_identification.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::degree;
using testing::tracked_campaign;

/// Measurements of a robot whose errors are anywhere within the bounds.
Measurements measure_far_off(const Campaign& campaign, const VectorXd& bounds, std::uint64_t item) {
    RandomStream stream(1234, item);
    Parameters truth = campaign.nominal;
    for (Index k = 0; k < bounds.size(); ++k) {
        truth.robot[k] = stream.uniform(-bounds[k], bounds[k]);
    }
    return simulate_measurements(campaign, truth, random_configurations(campaign.robot, 24, item),
                                 1, item);
}

bool is_found(const Estimate& estimate) { return estimate.fit_means.distance_rms < 4e-4; }

TEST(GlobalIdentification, FindsRobotsThatOneStartDoesNot) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const GlobalOptions options{.angle = 90 * degree};
    const VectorXd bounds = error_bounds(campaign.robot, options);
    Index by_one = 0;
    Index by_many = 0;
    constexpr Index count = 20;
    for (std::uint64_t item = 0; item < count; ++item) {
        const Measurements measurements = measure_far_off(campaign, bounds, item);
        const Parameters start = register_base_and_targets(campaign, measurements).parameters;
        by_one += is_found(identify(campaign, measurements, start)) ? 1 : 0;
        const GlobalEstimate found = identify_globally(campaign, measurements, options);
        by_many += is_found(found.estimate) ? 1 : 0;
        EXPECT_LE(found.starts, options.start_limit);
    }
    EXPECT_LT(by_one, by_many);
    EXPECT_GE(by_many, count - 1);
}

TEST(GlobalIdentification, FindsRobotsByCovarianceAdaptation) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    GlobalOptions options{.angle = 45 * degree, .start_limit = 3, .agreeing_starts = 2};
    const VectorXd bounds = error_bounds(campaign.robot, options);
    options.search = StartSearch::CmaEs;
    options.evaluation_limit = 1000;
    Index found = 0;
    for (std::uint64_t item = 0; item < 4; ++item) {
        const Measurements measurements = measure_far_off(campaign, bounds, item);
        found += is_found(identify_globally(campaign, measurements, options).estimate) ? 1 : 0;
    }
    EXPECT_EQ(found, 4);
}

TEST(GlobalIdentification, ComesNearByCovarianceAdaptationAlone) {
    // Without Levenberg-Marquardt: one start whose iterations are spent on next to nothing.
    const Campaign campaign = tracked_campaign(testing::fanuc());
    GlobalOptions options{.angle = 20 * degree, .search = StartSearch::CmaEs};
    const VectorXd bounds = error_bounds(campaign.robot, options);
    const Measurements measurements = measure_far_off(campaign, bounds, 3);
    const auto misfit_after = [&](Index evaluations) {
        options.evaluation_limit = evaluations;
        options.start_limit = 2;
        options.start_options.iteration_limit = 1;
        return identify_globally(campaign, measurements, options).estimate.fit_means.distance_rms;
    };
    const double far = misfit_after(1);
    EXPECT_LT(misfit_after(4000), far / 3);
    EXPECT_EQ(misfit_after(500), misfit_after(500));
}

TEST(GlobalIdentification, OfARobotNearNominalIsThatFromNominal) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate(campaign, {.pose_count = 24}).measurements;
    const GlobalEstimate found = identify_globally(campaign, measurements);
    const Estimate near = identify(campaign, measurements,
                                   register_base_and_targets(campaign, measurements).parameters);
    EXPECT_LT((found.estimate.parameters.robot - near.parameters.robot).norm(), 1e-9);
    EXPECT_GE(found.starts_at_best, 3);
}

TEST(GlobalIdentification, BoundsAreAShareOfTheLength) {
    const Chain robot = with_harmonics(testing::fanuc(), {1}, {0});
    const VectorXd bounds = error_bounds(robot, {.length_share = 0.3, .least_length = 0.05});
    const auto names = robot.parameter_names();
    const auto bound_of = [&](const std::string& name) {
        return bounds[std::find(names.begin(), names.end(), name) - names.begin()];
    };
    EXPECT_DOUBLE_EQ(bound_of("Tx3"), 0.3 * 1.28);
    EXPECT_DOUBLE_EQ(bound_of("Ty1"), 0.05);
    EXPECT_DOUBLE_EQ(bound_of("dq2"), 20 * degree);
    for (Index k = 0; k < bounds.size(); ++k) {
        EXPECT_EQ(bounds[k] == 0, robot.parameter_term(k) != nullptr) << k;
    }
}

TEST(GlobalIdentification, RegistersARobotWithErrorsExactly) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.model_error = 0;
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-12);
    RandomStream stream(3);
    Parameters truth = campaign.nominal;
    truth.robot = testing::random_vector(stream, 18, 0.3);
    const Measurements measurements =
        simulate_measurements(campaign, truth, random_configurations(campaign.robot, 12, 5), 1, 5);
    const Parameters found =
        register_roughly_with_errors(campaign, measurements, truth.robot).parameters;
    EXPECT_EQ(found.robot, truth.robot);
    EXPECT_LT((found.sensor - truth.sensor).norm(), 1e-9);
    EXPECT_TRUE(found.world_from_base.isApprox(truth.world_from_base, 1e-9));
}

TEST(GlobalIdentification, TellsItsProgressAndPassesOnWhatTheCallbackThrows) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate(campaign, {.pose_count = 24}).measurements;
    GlobalOptions options;
    Index told = 0;
    options.progress = [&](const Progress& progress) {
        EXPECT_EQ(progress.done, ++told);
        EXPECT_EQ(progress.total, options.start_limit);
    };
    EXPECT_EQ(identify_globally(campaign, measurements, options).starts, told);
    options.progress = [](const Progress&) { throw std::domain_error("enough"); };
    EXPECT_THROW(identify_globally(campaign, measurements, options), std::domain_error);
}

TEST(GlobalIdentification, RefusesWhatItCannotUse) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate(campaign, {.pose_count = 24}).measurements;
    EXPECT_THROW(identify_globally(campaign, measurements, {.length_share = -1}), InputError);
    EXPECT_THROW(identify_globally(campaign, measurements, {.angle = NAN}), InputError);
    EXPECT_THROW(identify_globally(campaign, measurements, {.start_limit = 0}), InputError);
    const Measurements few = simulate(campaign, {.pose_count = 3}).measurements;
    EXPECT_EQ(identify_globally(campaign, few).estimate.ending, Ending::NotIdentifiable);
    campaign.spread.is_prior = true;
    EXPECT_THROW(identify_globally(campaign, measurements), InputError);
}

}  // namespace
}  // namespace posewise
