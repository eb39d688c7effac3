#include <gtest/gtest.h>

#include <new>

#include "../../src/model/complete_model.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

using testing::fanuc;
using testing::tracked_campaign;

Campaign precise_campaign(double sigma) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.model_error = 0;
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), sigma);
    return campaign;
}

/// Parameters under priors, more than the poses determine.
Campaign rich_campaign() {
    const Chain robot = without_parameters(fanuc());
    Campaign campaign = with_robot(tracked_campaign(fanuc()), detail::full_model(robot));
    campaign.spread = population_spread(robot);
    campaign.model_error = 1e-4;
    return campaign;
}

/// Noise that depends on the pose.
Campaign shaky_campaign() {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.joint_repeatability = VectorXd::Constant(6, 1e-4);
    return campaign;
}

/// Of every fold, identified by itself from `start`, and further than anyone needs.
RowMatrixXd squares_by_hand(const Campaign& campaign, const Measurements& measured,
                            const Parameters& start, Index folds) {
    LevenbergMarquardtOptions to_the_end;
    to_the_end.finds_model_error = false;
    to_the_end.relative_tolerance = 1e-18;
    const Index count = measured.configuration_count();
    RowMatrixXd squares(count, measured.is_seen.cols());
    for (Index fold = 0; fold < folds; ++fold) {
        std::vector<Index> held_out;
        for (Index i = fold; i < count; i += folds) held_out.push_back(i);
        const Estimate others =
            identify(campaign, take(measured, all_but(count, held_out)), start, to_the_end);
        squares(held_out, Eigen::all) =
            squared_distances(campaign, others.parameters, take(measured, held_out));
    }
    return squares;
}

TEST(CrossValidate, IsAnIdentificationOfEveryFoldWhereverItStarts) {
    LevenbergMarquardtOptions options;
    options.finds_model_error = false;
    for (const Campaign& campaign : {precise_campaign(5e-5), rich_campaign(), shaky_campaign()}) {
        const auto measured = simulate(campaign, {16, 2, 7, 8}).measurements;
        const Parameters start = register_base_and_targets(campaign, measured).parameters;
        const Parameters estimate = identify(campaign, measured, start, options).parameters;
        for (const Index folds : {4, 16}) {
            const RowMatrixXd expected = squares_by_hand(campaign, measured, start, folds);
            for (const Parameters& from : {start, estimate}) {
                const CrossValidation found =
                    cross_validate(campaign, measured, from, folds, options);
                EXPECT_TRUE(found.failures.empty());
                // A sum of squares tells its minimum to half of its digits.
                EXPECT_LT((found.squared_distances - expected).norm(), 1e-6 * expected.norm());
            }
        }
    }
}

TEST(CrossValidate, LeavesOutEachConfigurationOnce) {
    const Campaign campaign = precise_campaign(5e-5);
    const auto measurements = simulate(campaign, {20, 2, 7, 8}).measurements;
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const CrossValidation result = cross_validate(campaign, measurements, start, 20);
    EXPECT_TRUE(result.failures.empty());
    EXPECT_EQ(result.samples.point_count, 20 * 2 * 3);
    EXPECT_EQ(result.means.point_count, 20 * 3);
    // By hand for one fold, and worse than the fit.
    const auto seen = take(measurements, all_but(20, {4}));
    const Estimate without = identify(campaign, seen, start);
    const double left_out =
        make_metrics(residuals(campaign, without.parameters, take(measurements, {4}))).distance_max;
    EXPECT_LE(left_out, result.samples.distance_max);
    EXPECT_GT(result.samples.distance_rms,
              identify(campaign, measurements, start).fit.distance_rms);
}

TEST(CrossValidate, KeepsResidualsInTheMeasurementsOrder) {
    const Campaign campaign = tracked_campaign(fanuc());
    Measurements measured = simulate(campaign, {.pose_count = 13, .repeats = 2}).measurements;
    testing::hide_at_random(measured, 0.2, 3);
    const Parameters start = identify(campaign, measured, campaign.nominal).parameters;
    const CrossValidation held_out = cross_validate(campaign, measured, start, 3);
    ASSERT_EQ(held_out.residuals.rows(), measured.is_seen.count());
    EXPECT_NEAR(make_metrics(held_out.residuals).distance_rms, held_out.samples.distance_rms,
                1e-15);
    Index row = 0;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        std::vector<Index> fold;
        for (Index k = i % 3; k < 13; k += 3) fold.push_back(k);
        const Estimate others = identify(campaign, take(measured, all_but(13, fold)), start);
        const RowMatrixXd expected = residuals(campaign, others.parameters, take(measured, {i}));
        EXPECT_LT(
            (held_out.residuals.middleRows(row, expected.rows()) - expected).cwiseAbs().maxCoeff(),
            1e-8);
        row += expected.rows();
    }
    EXPECT_EQ(row, held_out.residuals.rows());
}

TEST(CrossValidate, TellsItsProgressAndPassesOnWhatTheCallbackThrows) {
    const Campaign campaign = precise_campaign(5e-5);
    const auto measurements = simulate(campaign, {12, 1, 7, 8}).measurements;
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    Index told = 0;
    cross_validate(campaign, measurements, start, 4, {}, [&](const Progress& progress) {
        EXPECT_EQ(progress.done, ++told);
        EXPECT_EQ(progress.total, 4);
    });
    EXPECT_EQ(told, 4);
    const auto fail = [](const Progress&) { throw std::bad_alloc(); };
    EXPECT_THROW(cross_validate(campaign, measurements, start, 4, {}, fail), std::bad_alloc);
}

TEST(CrossValidate, CountsFoldsThatCannotBeIdentified) {
    const Campaign campaign = precise_campaign(5e-5);
    const auto measurements = simulate(campaign, {6, 1, 7, 8}).measurements;
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const Parameters estimate = identify(campaign, measurements, start).parameters;
    for (const Parameters& from : {start, estimate}) {
        const CrossValidation halves = cross_validate(campaign, measurements, from, 2);
        EXPECT_EQ(halves.failures.size(), 2U);
        EXPECT_EQ(halves.samples.point_count, 0);
    }
    EXPECT_THROW(cross_validate(campaign, measurements, start, 1), InputError);
    EXPECT_THROW(cross_validate(campaign, measurements, start, 7), InputError);
}

/// The robot came back to each of 16 poses: held out one by one each would be judged by its twin.
TEST(CrossValidate, HoldsOutEqualPosesTogether) {
    const Campaign campaign = tracked_campaign(fanuc());
    const Measurements once = simulate(campaign, {16, 1, 7, 8}).measurements;
    const Measurements again =
        simulate_measurements(campaign, campaign.nominal, once.configurations, 1, 9);
    Measurements both = once;
    both.configurations.conservativeResize(32, Eigen::NoChange);
    both.configurations.bottomRows(16) = once.configurations;
    both.observations.conservativeResize(32, Eigen::NoChange);
    both.observations.bottomRows(16) = again.observations;
    both.is_seen.setConstant(32, once.is_seen.cols(), true);
    for (Index i = 16; i < 32; ++i) {
        both.ids.push_back('r' + std::to_string(i));
        both.first_sample.push_back(i + 1);
    }
    const Parameters start = register_base_and_targets(campaign, both).parameters;
    LevenbergMarquardtOptions options;
    options.finds_model_error = false;
    const CrossValidation found = cross_validate(campaign, both, start, 32, options);
    EXPECT_EQ(found.folds, 16);
    ASSERT_EQ(found.residuals.rows(), 32 * 3);
    EXPECT_TRUE(found.residuals.allFinite());
    const Index last = 15;
    const Measurements others = take(both, all_but(32, {last, 16 + last}));
    const Parameters without = identify(campaign, others, start, options).parameters;
    const RowMatrixXd expected = residuals(campaign, without, take(both, {16 + last}));
    EXPECT_LT((found.residuals.bottomRows(3) - expected).norm(), 1e-6 * expected.norm());
    const Measurements still = take(both, {3, 19});
    EXPECT_THROW(cross_validate(campaign, still, start, 2, options), InputError);
}

}  // namespace
}  // namespace posewise
