#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "../../src/task/choice/robot_blocks.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/planning.hpp"
#include "support/held_robot.hpp"

namespace posewise {
namespace {

/// The FANUC with a model error of 0.1 mm, in a cell of its own.
Campaign known_fanuc() {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.known_within = {1, 1};
    return campaign;
}

/// Any poses, as if they were planned: the search for good ones takes long.
Planning plan_of(const Campaign& campaign, Index count = 12, double repeats = 1) {
    Planning planning;
    planning.campaign = campaign;
    Plan& plan = planning.plan;
    plan.request.seed = 1;
    plan.request.pose_count = count;
    plan.request.repeats = repeats;
    const RowMatrixXd poses = detail::random_configurations(campaign.robot, count, 7);
    for (Index i = 0; i < count; ++i) {
        PlannedPose& pose = plan.poses.emplace_back();
        pose.configuration = poses.row(i).transpose();
        pose.targets = {0, 1, 2};
    }
    planning.workspace_count = 60;
    planning.errors =
        make_position_errors(campaign, detail::random_configurations(campaign.robot, 60, 8));
    const RowMatrixXd times = times_seen(all_seen(count, campaign.sensor->target_count()), repeats);
    const Blocks blocks = make_blocks(campaign, campaign.nominal, poses, times);
    planning.by_noise = information_by_noise(campaign, campaign.nominal, poses, times);
    planning.information = prior_information(campaign) + information(blocks);
    MatrixXd left = planning.information;
    planning.drop_outs = drop_worst(planning.errors.by_parameters, blocks, 2, left);
    return planning;
}

SimulatedPlanOptions few_robots(Index most = 150) {
    SimulatedPlanOptions options;
    options.most_robots = most;
    return options;
}

/// The closed form is met by 5 %, or by thrice the uncertainty where that is more.
void expect_near(const SimulatedNumber& number, const char* name) {
    EXPECT_NEAR(number.found, number.predicted,
                std::max(0.05 * number.predicted, 3 * number.uncertainty))
        << name;
    EXPECT_LT(number.uncertainty, 0.05 * number.predicted) << name;
}

void expect_near(const SimulatedPlan& simulated) {
    EXPECT_EQ(simulated.uncalibrated_count, 0);
    expect_near(simulated.expected, "expected");
    expect_near(simulated.lower, "lower");
    expect_near(simulated.upper, "upper");
    expect_near(simulated.assured, "assured");
}

TEST(SimulatedPlan, FindsWhatIsPredictedForAnyQuantity) {
    const Planning planning = plan_of(known_fanuc());
    SimulatedPlanOptions options = few_robots();
    for (const auto quantity :
         {ErrorQuantity::Rms, ErrorQuantity::Percentile95, ErrorQuantity::Max}) {
        options.quantity = quantity;
        options.assurance = 0.8;
        const SimulatedPlan simulated = simulate_plan(planning, options);
        EXPECT_EQ(simulated.robot_count, 150);
        EXPECT_EQ(simulated.expected_count, 0);  // all are
        expect_near(simulated);
        EXPECT_LT(simulated.assured.found, simulated.upper.found);
    }
}

/// Three targets are hardly more than one witness then.
TEST(SimulatedPlan, FindsWhatIsPredictedWhereTheModelErrorMovesTheFlange) {
    Campaign campaign = known_fanuc();
    campaign.model_error_common = 0;
    const Planning apart = plan_of(campaign);
    campaign.model_error_common = 0.9;
    const Planning planning = plan_of(campaign);
    for (const auto quantity : {ErrorQuantity::Rms, ErrorQuantity::Percentile95}) {
        SimulatedPlanOptions options = few_robots();
        options.quantity = quantity;
        expect_near(simulate_plan(planning, options));
    }
    const SimulatedPlan before = simulate_plan(apart, few_robots());
    const SimulatedPlan now = simulate_plan(planning, few_robots());
    EXPECT_GT(now.expected.found, 1.04 * before.expected.found);
}

TEST(SimulatedPlan, DrawsModelErrorsAndSizesThatNobodyKnows) {
    Campaign campaign = known_fanuc();
    campaign.known_within = {};
    campaign.spread.is_prior = true;
    const SimulatedPlan simulated = simulate_plan(plan_of(campaign), few_robots(250));
    EXPECT_EQ(simulated.robot_count, 250);
    EXPECT_EQ(simulated.expected_count, 60);
    expect_near(simulated.expected, "expected");
    expect_near(simulated.assured, "assured");
    EXPECT_GT(simulated.assured.found, 3 * simulated.expected.found);
}

TEST(SimulatedPlan, IsTheSameForAnyThreads) {
    const Planning planning = plan_of(known_fanuc());
    const SimulatedPlanOptions options = few_robots(100);
    const Index threads = thread_count();
    set_thread_count(1);
    const SimulatedPlan one = simulate_plan(planning, options);
    set_thread_count(2);
    const SimulatedPlan two = simulate_plan(planning, options);
    set_thread_count(threads);
    EXPECT_EQ(one.robot_count, two.robot_count);
    EXPECT_EQ(one.ending, two.ending);
    for (const auto number : {&SimulatedPlan::expected, &SimulatedPlan::lower,
                              &SimulatedPlan::upper, &SimulatedPlan::assured}) {
        EXPECT_EQ((one.*number).found, (two.*number).found);
        EXPECT_EQ((one.*number).uncertainty, (two.*number).uncertainty);
    }
}

TEST(SimulatedPlan, EndsWhenDigitsAreSureOrRobotsAreTooMany) {
    const Planning planning = plan_of(known_fanuc());
    SimulatedPlanOptions options = few_robots(100);
    const SimulatedPlan limited = simulate_plan(planning, options);
    EXPECT_EQ(limited.ending, Ending::IterationLimit);
    EXPECT_FALSE(limited.is_sure());
    EXPECT_GT(2 * limited.assured.uncertainty, limited.tolerance);
    EXPECT_EQ(limited.block_count, 10);
    EXPECT_EQ(judge_limit(limited, 1.5 * limited.assured.found), LimitVerdict::Kept);
    EXPECT_EQ(judge_limit(limited, limited.assured.found), LimitVerdict::Open);
    EXPECT_EQ(judge_limit(limited, 0.5 * limited.assured.found), LimitVerdict::NotKept);

    options.digits = 1;
    options.most_robots = 100000;
    const SimulatedPlan sure = simulate_plan(planning, options);
    EXPECT_TRUE(sure.is_sure());
    EXPECT_LT(sure.robot_count, 2000);
    for (const SimulatedNumber& number : {sure.expected, sure.lower, sure.upper, sure.assured}) {
        EXPECT_LE(2 * number.uncertainty, sure.tolerance);
    }
    EXPECT_NEAR(sure.assured.found, limited.assured.found, 4 * limited.assured.uncertainty);
}

TEST(SimulatedPlan, KeepsCompleteBlocksOfWhatIsStopped) {
    const Planning planning = plan_of(known_fanuc());
    SimulatedPlanOptions options = few_robots(100);
    std::atomic<bool> interrupted{true};
    options.stop.interrupted = &interrupted;
    SimulatedPlan simulated = simulate_plan(planning, options);
    EXPECT_EQ(simulated.ending, Ending::Interrupted);
    EXPECT_EQ(simulated.robot_count, 0);
    EXPECT_GT(simulated.assured.predicted, 0);
    EXPECT_EQ(judge_limit(simulated, 1), LimitVerdict::Open);

    interrupted = false;
    const Index threads = thread_count();
    set_thread_count(1);
    options.progress = [&](const Progress& state) { interrupted = state.done >= 45; };
    simulated = simulate_plan(planning, options);
    set_thread_count(threads);
    EXPECT_EQ(simulated.ending, Ending::Interrupted);
    EXPECT_EQ(simulated.robot_count, 40);  // blocks of 10
    EXPECT_GT(simulated.assured.found, 0);
}

/// The poses that hurt most are left out, of the closed form too.
TEST(SimulatedPlan, LeavesOutPosesThatAreMissing) {
    const Planning planning = plan_of(known_fanuc());
    SimulatedPlanOptions options = few_robots();
    const double whole = simulate_plan(planning, options).expected.predicted;
    options.missing = 2;
    const SimulatedPlan simulated = simulate_plan(planning, options);
    EXPECT_GT(simulated.expected.predicted, 1.02 * whole);
    expect_near(simulated.expected, "expected");
    expect_near(simulated.assured, "assured");
    options.missing = 3;
    EXPECT_THROW(simulate_plan(planning, options), InputError);
}

/// What an earlier estimate left open, and drift, is what robots are drawn from.
TEST(SimulatedPlan, DrawsFromWhatAnEarlierEstimateTells) {
    const Campaign campaign = testing::held_campaign();
    Campaign assumed = campaign;
    assumed.spread.is_prior = true;
    const Parameters truth = draw_truth(campaign, 4);
    const Measurements measured = testing::measure_at_random(campaign, truth, 30, 5);
    const Estimate estimate = calibrate(assumed, measured, testing::without_folds()).estimate;
    Earlier earlier{estimate};
    earlier.use.is_prior = true;
    Campaign expected = with_earlier(assumed, earlier);
    expected.known_within = {1, 1};
    const SimulatedPlan simulated = simulate_plan(plan_of(expected, 4), few_robots(100));
    expect_near(simulated.expected, "expected");
    expect_near(simulated.assured, "assured");
}

TEST(SimulatedPlan, RefusesWhatCannotBeDrawn) {
    const Campaign campaign = known_fanuc();
    PlanningOptions options(12);
    options.repeats = 2.5;
    EXPECT_THROW(check_simulable(campaign, options), InputError);
    options.repeats = 2;
    EXPECT_NO_THROW(check_simulable(campaign, options));
    options.held = testing::measure_at_random(campaign, campaign.nominal, 5, 1);
    EXPECT_THROW(check_simulable(campaign, options), InputError);
    Planning planning = plan_of(campaign);
    planning.measured_count = 5;
    EXPECT_THROW(simulate_plan(planning, few_robots()), InputError);
    planning.measured_count = 0;
    EXPECT_THROW(simulate_plan(planning, few_robots(99)), InputError);
    planning.plan.request.sources.workspace = "work.csv";
    EXPECT_THROW(simulate_plan(planning, few_robots()), InputError);
}

TEST(RobotBlocks, TakeEachTenthOfWhatSizesMayBe) {
    SimulatedPlanOptions options;
    const detail::RobotBlocks blocks({}, options);
    EXPECT_EQ(blocks.robots_a_block(), 125);
    int below[2][10] = {};
    for (Index k = 0; k < 100; ++k) {
        const detail::RobotSizes sizes = blocks.sizes(3, k);
        const auto tenth = [](double z) {
            return static_cast<int>(5 * std::erfc(-z / std::sqrt(2.0)));
        };
        ++below[0][tenth(sizes.model_error)];
        ++below[1][tenth(sizes.errors)];
    }
    for (const auto& factor : below) {
        for (const int count : factor) EXPECT_NEAR(count, 10, 2);
    }
    EXPECT_EQ(blocks.sizes(3, 100).model_error, 0);  // of expected size
    EXPECT_NE(blocks.sizes(3, 7).errors, blocks.sizes(4, 7).errors);
}

TEST(RobotBlocks, CountWhatIsNotCalibratedAsTheWorst) {
    SimulatedPlanOptions options;
    options.most_robots = 100;
    detail::RobotBlocks blocks({1, 1}, options);
    constexpr double unlimited = std::numeric_limits<double>::infinity();
    for (int b = 0; b < 10; ++b) {
        VectorXd values = VectorXd::LinSpaced(10, 1, 2);
        values[b] = unlimited;
        blocks.add(values);
    }
    EXPECT_EQ(blocks.uncalibrated_count(), 10);
    EXPECT_EQ(blocks.found().upper, unlimited);  // 10 of 100
    EXPECT_LT(blocks.found().lower, 1.5);
    EXPECT_EQ(blocks.uncertainty(&detail::FoundRange::upper), unlimited);
    EXPECT_LT(blocks.deviation(), 0.4);
    EXPECT_EQ(blocks.needed(0.05), blocks.most());
}

TEST(RobotBlocks, ToleranceIsHalfOfTheLastDigit) {
    EXPECT_DOUBLE_EQ(detail::numerical_tolerance(0.0312, 2), 0.0005);
    EXPECT_DOUBLE_EQ(detail::numerical_tolerance(0.0312, 1), 0.005);
    EXPECT_DOUBLE_EQ(detail::numerical_tolerance(99, 2), 0.5);
    EXPECT_EQ(detail::numerical_tolerance(0, 2), 0);
}

}  // namespace
}  // namespace posewise
