#include "posewise/task/judgement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../src/model/sampling.hpp"
#include "../../src/task/calibration/judgement.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

struct Example {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    Simulation simulated;

    explicit Example(Index poses = 24) {
        simulated = simulate(campaign, {.pose_count = poses, .repeats = 2});
    }
    Measurements measure(const RowMatrixXd& configurations, std::uint64_t seed) const {
        return simulate_measurements(campaign, simulated.truth, configurations, 1, seed);
    }
    Judgement judge(const Measurements& others,
                    const std::vector<std::string>& refitted = {}) const {
        CalibrationOptions options;
        options.folds = 0;
        options.validation = &others;
        options.refitted = refitted;
        return calibrate(campaign, simulated.measurements, options).validation.value();
    }
};

RowMatrixXd stack(const RowMatrixXd& a, const RowMatrixXd& b) {
    RowMatrixXd both(a.rows() + b.rows(), a.cols());
    both << a, b;
    return both;
}

TEST(Judgement, TellsNewPosesFromRepeatedOnesAndFromThoseBeyondTheRanges) {
    const Example example;
    const RowMatrixXd& known = example.simulated.measurements.configurations;
    RowMatrixXd repeated = known.topRows(5);
    repeated.array() += 1e-3;  // as read back
    RowMatrixXd others = known.middleRows(5, 4);
    others.leftCols(3) *= 0.9;
    others(3, 4) = known.col(4).maxCoeff() + 0.5;
    const Judgement judged = example.judge(example.measure(stack(repeated, others), 5));
    ASSERT_EQ(judged.groups.size(), 3U);
    const std::vector<std::vector<Index>> expected{{5, 6, 7}, {8}, {0, 1, 2, 3, 4}};
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(judged.groups[k].group, static_cast<PoseGroup>(k));
        EXPECT_EQ(judged.groups[k].configurations, expected[k]);
    }
    EXPECT_EQ(judged.groups[1].joints, std::vector<std::string>{"q5"});
    EXPECT_EQ(judged.found.point_count, 9 * 3);
    EXPECT_EQ(judged.groups[0].found.point_count, 3 * 3);
}

TEST(Judgement, SaysNothingOfPosesCalibratedWithButWhereTheyAreWorseThanChance) {
    const Example example;
    const RowMatrixXd& known = example.simulated.measurements.configurations;
    Measurements again = example.measure(known, 5);
    Judgement judged = example.judge(again);
    ASSERT_EQ(judged.groups.size(), 1U);
    EXPECT_EQ(judged.groups[0].group, PoseGroup::Repeated);
    EXPECT_EQ(judged.groups[0].verdict, ChanceVerdict::NotJudged);
    EXPECT_FALSE(judge_limit(judged.groups[0], 1).has_value());
    again.observations.array() += 0.001;  // the base has moved
    judged = example.judge(again);
    EXPECT_EQ(judged.groups[0].verdict, ChanceVerdict::Beyond);
    EXPECT_FALSE(judge_limit(judged.groups[0], 1).has_value());
}

TEST(Judgement, OfALimitTakesTheWholeInterval) {
    JudgedGroup group;
    group.configurations.assign(15, 0);
    group.found.distance_rms = 2e-4;
    group.interval = RmsInterval{1.6e-4, 2.6e-4, 45};
    EXPECT_EQ(judge_limit(group, 2.6e-4), LimitVerdict::Kept);
    EXPECT_EQ(judge_limit(group, 1.59e-4), LimitVerdict::NotKept);
    EXPECT_EQ(judge_limit(group, 2.5e-4), LimitVerdict::Open);
    // The more poses the narrower, if the RMS stays.
    const Index count = poses_to_decide(group, 2.3e-4).value();
    EXPECT_GT(count, 15);
    EXPECT_GT(poses_to_decide(group, 2.2e-4).value(), count);
    EXPECT_FALSE(poses_to_decide(group, 2e-4).has_value());
    group.interval.reset();
    EXPECT_FALSE(judge_limit(group, 1).has_value());
}

TEST(Judgement, CountsConfigurationsNotSamples) {
    const Example example;
    const RowMatrixXd places = detail::random_configurations(example.campaign.robot, 15, 77);
    const auto judge = [&](Index repeats) {
        return example.judge(
            simulate_measurements(example.campaign, example.simulated.truth, places, repeats, 5));
    };
    const RmsInterval once = judge(1).groups.front().interval.value();
    const RmsInterval often = judge(20).groups.front().interval.value();
    EXPECT_NEAR(often.degrees_of_freedom, once.degrees_of_freedom, 0.15 * once.degrees_of_freedom);
    EXPECT_GT(once.degrees_of_freedom, 20);
    EXPECT_LT(once.degrees_of_freedom, 15 * 9);
}

TEST(ErrorFreedom, OfEqualErrorsInAllDirectionsIsThreeAConfiguration) {
    Example example;
    example.campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 5e-5);
    example.campaign.nominal.sensor.conservativeResize(3);
    example.campaign.model_error = 1e-4;
    Estimate estimate;
    estimate.parameters = example.campaign.nominal;
    estimate.variance_factor = 1;
    estimate.model_error = 1e-4;
    const Index count = parameter_count(example.campaign);
    estimate.covariance = MatrixXd::Zero(count, count);
    const Measurements measured =
        simulate_measurements(example.campaign, example.campaign.nominal,
                              detail::random_configurations(example.campaign.robot, 10, 3), 1, 3);
    ErrorFreedom freedom = error_freedom(example.campaign, estimate, measured);
    EXPECT_NEAR(freedom.of_poses, 30, 1e-9);
    EXPECT_NEAR(freedom.of_robots, 30, 1e-9);
    // Errors of the base are the same everywhere.
    estimate.covariance.topLeftCorner(3, 3) = 1e-6 * MatrixXd::Identity(3, 3);
    freedom = error_freedom(example.campaign, estimate, measured);
    EXPECT_LE(freedom.of_poses, 30 + 1e-9);
    EXPECT_LT(freedom.of_robots, 4);
}

/// Part of the calibrations whose interval, by a few random poses, holds the RMS over very many;
/// of those whose limit is that RMS, part that is judged at all.
struct Coverage {
    double held = 0;
    double passed = 0;
    double failed = 0;
};

Coverage simulate_judging(const Campaign& campaign, Index poses, Index fresh, Index campaigns) {
    Coverage coverage;
    for (Index run = 0; run < campaigns; ++run) {
        const auto seed = 5 * static_cast<std::uint64_t>(run);
        const Simulation simulated =
            simulate(campaign, {.pose_count = poses, .truth_seed = seed, .seed = seed + 1});
        const auto measure = [&](Index count, std::uint64_t item) {
            return simulate_measurements(campaign, simulated.truth,
                                         detail::random_configurations(campaign.robot, count, item),
                                         1, item);
        };
        const Measurements validation = measure(fresh, seed + 2);
        const Estimate estimate =
            identify(campaign, simulated.measurements,
                     register_base_and_targets(campaign, simulated.measurements).parameters);
        const Campaign found = with_model_error(campaign, estimate);
        const Measurements all = measure(1000, seed + 3);
        const double truth = make_metrics(residuals(found, estimate.parameters, all)).rms();
        // In whose ranges all are.
        const Judgement judged = detail::judge({found, estimate, all.configurations}, validation);
        const JudgedGroup& group = judged.groups.at(0);
        const auto verdict = judge_limit(group, truth);
        const double share = 1.0 / static_cast<double>(campaigns);
        if (verdict == LimitVerdict::Open) coverage.held += share;
        if (verdict == LimitVerdict::Kept) coverage.passed += share;
        if (verdict == LimitVerdict::NotKept) coverage.failed += share;
    }
    return coverage;
}

/// Deviations of a share of so many where it is 95 %.
double tolerance(Index campaigns) {
    return 0.02 + 3 * std::sqrt(0.05 * 0.95 / static_cast<double>(campaigns));
}

TEST(Judgement, HasTheRmsOverTheWorkspaceInItsIntervalNineteenTimesInTwenty) {
    const Index campaigns = testing::sweep_count() / 5;
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 5e-5);
    campaign.nominal.sensor.conservativeResize(3);
    for (const bool is_prior : {false, true}) {
        campaign.spread.is_prior = is_prior;
        campaign.model_error = is_prior ? 1.5e-4 : 0;
        for (const Index fresh : {6, 15, 40}) {
            const Coverage found = simulate_judging(campaign, 16, fresh, campaigns);
            RecordProperty((is_prior ? "prior_" : "plain_") + std::to_string(fresh),
                           std::to_string(found.held));
            EXPECT_NEAR(found.held, 0.95, tolerance(campaigns)) << is_prior << ' ' << fresh;
            // At the limit itself it is wrong whenever it judges.
            EXPECT_LE(found.passed, 0.05 + tolerance(campaigns)) << is_prior << ' ' << fresh;
            EXPECT_LE(found.failed, 0.05 + tolerance(campaigns)) << is_prior << ' ' << fresh;
        }
    }
}

TEST(Judgement, ComparesWithTheNominalRobotThatIsFittedAlike) {
    const Example example;
    const RowMatrixXd fresh = 0.95 * example.simulated.measurements.configurations.topRows(10);
    const std::vector<std::string> refitted{"base", "targets"};
    for (const auto& parts : {std::vector<std::string>{}, refitted}) {
        const JudgedGroup judged = example.judge(example.measure(fresh, 5), parts).groups.front();
        EXPECT_GT(*judged.nominal, 2 * judged.found.rms());
        EXPECT_FALSE(judged.is_no_better());
    }
    // Measured of a robot that has no errors.
    const Campaign& campaign = example.campaign;
    const Measurements other = simulate_measurements(campaign, campaign.nominal, fresh, 1, 5);
    const JudgedGroup judged = example.judge(other, refitted).groups.front();
    EXPECT_LT(*judged.nominal, 2e-4);
    EXPECT_TRUE(judged.is_no_better());
}

TEST(Calibrate, JudgesPosesToVerifyByThemselves) {
    const Example example(30);
    CalibrationOptions options;
    options.folds = 0;
    options.limit = 1e-3;
    for (Index i = 0; i < 16; ++i) options.used.push_back(i);
    for (Index i = 16; i < 26; ++i) options.verification.push_back(i);
    const Measurements& measured = example.simulated.measurements;
    const Calibration result = calibrate(example.campaign, measured, options);
    EXPECT_EQ(result.measured.configurations, 16);
    EXPECT_EQ(result.verification->found.point_count, 10 * 2 * 3);
    EXPECT_EQ(result.left_out->found.point_count, 4 * 2 * 3);
    EXPECT_GT(result.verification->groups.front().nominal, result.verification->found.rms());
    EXPECT_EQ(result.limit, 1e-3);
    // They are not calibrated with.
    options.verification.clear();
    EXPECT_EQ(calibrate(example.campaign, measured, options).estimate.parameters.robot,
              result.estimate.parameters.robot);
    options.verification = {3};
    EXPECT_THROW(calibrate(example.campaign, measured, options), InputError);
    options.used.clear();
    options.verification = {20};
    EXPECT_THROW(calibrate(example.campaign, measured, options), InputError);
    options.verification.clear();
    options.limit = 0;
    EXPECT_THROW(calibrate(example.campaign, measured, options), InputError);
}

}  // namespace
}  // namespace posewise
