#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <cmath>
#include <map>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/task/study.hpp"
#include "support/campaigns.hpp"
#include "support/robots.hpp"

namespace posewise {
namespace {

Campaign tracked_fanuc() {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.known_within = {1, 1};
    return campaign;
}

SimulatedStudyOptions few_trials() {
    SimulatedStudyOptions options;
    options.pose_counts = {8, 12};
    options.trials = 6;
    options.pool_count = 100;
    options.test_count = 40;
    return options;
}

/// Everything that was found, in order.
std::vector<double> numbers_of(const std::vector<Study>& studies) {
    std::vector<double> numbers;
    for (const Study& study : studies) {
        for (const StudyRow& row : study.rows) {
            for (const auto* cases : {&row.optimal, &row.random}) {
                for (const StudyCase& one : *cases) {
                    numbers.insert(numbers.end(),
                                   {static_cast<double>(one.split), one.held_out.rms,
                                    one.held_out.p95, one.held_out.max, one.expected});
                }
            }
        }
    }
    return numbers;
}

/// Keeps trials in memory and counts those that were run.
struct Memory {
    std::map<std::string, std::map<Index, std::vector<double>>> kept;
    Index run_count = 0;

    TrialStore store() {
        return {[this](const TrialSeries& series, const VisitTrial& visitor) {
                    for (const auto& [number, values] : kept[series.variation + series.checksum]) {
                        visitor({number, values});
                    }
                },
                [this](const TrialSeries& series, const Trial& trial) {
                    kept[series.variation + series.checksum][trial.number] = trial.values;
                    ++run_count;
                }};
    }
};

TEST(SimulatedStudy, HasASplitForEachRobotAndACaseForEachChoice) {
    SimulatedStudyOptions options = few_trials();
    options.criteria = {Criterion::V, Criterion::D};
    options.random_subsets = 3;
    const auto studies = simulate_study({{"", tracked_fanuc(), {}}}, options);
    ASSERT_EQ(studies.size(), 1u);
    const Study& study = studies.front();
    EXPECT_TRUE(study.is_simulated);
    EXPECT_EQ(study.splits, 6);
    EXPECT_EQ(study.test_count, 40);
    ASSERT_EQ(study.rows.size(), 2u);
    for (const StudyRow& row : study.rows) {
        EXPECT_EQ(row.optimal.size(), 2u * 6);
        EXPECT_EQ(row.random.size(), 3u * 6);
        for (const StudyCase& random : row.random) {
            EXPECT_TRUE(random.identified);
            EXPECT_EQ(random.held_out.point_count, 40 * 3);
        }
    }
    EXPECT_LT(planned_advantage(study, study.rows[0], 0)->ratio, 1);
}

TEST(SimulatedStudy, IsTheSameForAnyThreadsShardsAndOrder) {
    const std::vector<SimulatedCampaign> campaigns{{"", tracked_fanuc(), {}}};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const auto whole = numbers_of(simulate_study(campaigns, few_trials()));
    omp_set_num_threads(threads);
    SimulatedStudyOptions options = few_trials();
    EXPECT_EQ(numbers_of(simulate_study(campaigns, options)), whole);

    Memory memory;
    options.store = memory.store();
    for (const Index number : {3, 1, 2, 4}) {
        options.shard = {number, 4};
        simulate_study(campaigns, options);
    }
    EXPECT_EQ(memory.run_count, 6);
    options.shard = {};
    EXPECT_EQ(numbers_of(simulate_study(campaigns, options)), whole);
    EXPECT_EQ(memory.run_count, 6) << "finished trials ran again";

    options.trials = 9;  // more of the same
    const auto more = numbers_of(simulate_study(campaigns, options));
    EXPECT_EQ(memory.run_count, 9);
    options.store = {};
    EXPECT_EQ(numbers_of(simulate_study(campaigns, options)), more);
}

TEST(SimulatedStudy, TellsSeriesApartByWhatTrialsDependOn) {
    Memory memory;
    const auto count_run = [&](Campaign campaign, SimulatedStudyOptions options) {
        options.store = memory.store();
        options.trials = 1;
        memory.run_count = 0;
        simulate_study({{"", std::move(campaign), {}}}, options);
        return memory.run_count;
    };
    EXPECT_EQ(count_run(tracked_fanuc(), few_trials()), 1);
    EXPECT_EQ(count_run(tracked_fanuc(), few_trials()), 0);
    Campaign other = tracked_fanuc();
    other.model_error *= 2;
    EXPECT_EQ(count_run(other, few_trials()), 1);
    other = tracked_fanuc();
    other.known_within.model_error = 2;
    EXPECT_EQ(count_run(other, few_trials()), 1);
    other = tracked_fanuc();
    other.joint_repeatability = VectorXd::Constant(6, 1e-5);
    EXPECT_EQ(count_run(other, few_trials()), 1);
    SimulatedStudyOptions options = few_trials();
    options.repeats = 2;
    EXPECT_EQ(count_run(tracked_fanuc(), options), 1);
    options = few_trials();
    options.test_count = 41;
    EXPECT_EQ(count_run(tracked_fanuc(), options), 1);
}

TEST(SimulatedStudy, FindsTheModelErrorWhereNothingElseIsWrong) {
    Campaign campaign = tracked_fanuc();
    campaign.spread.is_prior = true;  // so that few poses do no harm
    campaign.spread.length = campaign.spread.angle = 1e-9;
    campaign.spread.by_name.clear();
    campaign.model_error = 0.2e-3;
    SimulatedStudyOptions options = few_trials();
    options.pose_counts = {60};
    options.trials = 20;
    options.test_count = 200;
    const Study study = simulate_study({{"", campaign, {}}}, options).front();
    double square = 0;
    for (const StudyCase& one : study.rows[0].optimal) {
        square += one.held_out.rms * one.held_out.rms / 20;
    }
    // Base and targets, 15 unknowns, are found from 540 numbers.
    EXPECT_NEAR(std::sqrt(square), std::sqrt(3 * (1 + 15.0 / 540)) * 0.2e-3, 0.01e-3);
}

/// Root of the mean of found^2 against that of expected^2.
double found_by_expected(const StudyCases& cases) {
    double found = 0, expected = 0;
    for (const StudyCase& one : cases) {
        found += one.held_out.rms * one.held_out.rms;
        expected += one.expected * one.expected;
    }
    return std::sqrt(found / expected);
}

TEST(SimulatedStudy, FindsWhatCalibrationsExpectUnlessTheTruthHasOtherErrors) {
    Campaign campaign = tracked_fanuc();
    SimulatedStudyOptions options = few_trials();
    options.trials = 150;
    options.pose_counts = {20};
    const StudyRow right = simulate_study({{"", campaign, {}}}, options).front().rows[0];
    EXPECT_NEAR(found_by_expected(right.optimal), 1, 0.05);
    EXPECT_NEAR(found_by_expected(right.random), 1, 0.08);

    Campaign bending = with_robot(campaign, with_harmonics(campaign.robot, {{1, 2}, {}}));
    bending.spread.harmonic = 1e-3;
    options.trials = 30;
    const StudyRow wrong = simulate_study({{"", campaign, bending}}, options).front().rows[0];
    EXPECT_GT(wrong.optimal[0].held_out.rms, 2 * right.optimal[0].held_out.rms);
}

TEST(SimulatedStudy, DrawsTheSameRobotsForEveryVariation) {
    Campaign noisy = tracked_fanuc();
    noisy.model_error *= 1.000001;
    SimulatedStudyOptions options = few_trials();
    options.criteria.emplace();  // random poses are the same, too
    const auto studies = simulate_study({{"a", tracked_fanuc(), {}}, {"b", noisy, {}}}, options);
    for (std::size_t i = 0; i < 6; ++i) {
        const double a = studies[0].rows[0].random[i].held_out.rms;
        const double b = studies[1].rows[0].random[i].held_out.rms;
        EXPECT_NE(a, b);
        EXPECT_NEAR(a, b, 1e-4 * a);
    }
    EXPECT_EQ(studies[1].model, "b");
}

TEST(SimulatedStudy, LeavesOutWhatWasStoppedBeforeItsFirstRobot) {
    SimulatedStudyOptions options = few_trials();
    options.trials = 40;
    Campaign noisy = tracked_fanuc();
    noisy.model_error = 1e-3;
    std::atomic<bool> interrupted = false;
    options.stop.interrupted = &interrupted;
    options.progress = [&](const Progress& progress) {
        if (progress.done >= 4) interrupted = true;
    };
    const auto studies = simulate_study({{"a", tracked_fanuc(), {}}, {"b", noisy, {}}}, options);
    ASSERT_EQ(studies.size(), 1u);
    EXPECT_EQ(studies[0].model, "a");
    EXPECT_EQ(studies[0].rows.size(), 2u);
    EXPECT_GE(studies[0].splits, 4);
    EXPECT_LT(studies[0].splits, 40);
    interrupted = true;
    EXPECT_THROW(simulate_study({{"a", noisy, {}}, {"b", tracked_fanuc(), {}}}, options),
                 InputError);
}

TEST(SimulatedStudy, EndsWhenItIsAsPreciseAsAskedFor) {
    SimulatedStudyOptions options = few_trials();
    options.pose_counts = {9};
    options.trials = 2000;
    options.precision = 0.04;
    const std::vector<SimulatedCampaign> campaigns{{"", tracked_fanuc(), {}}};
    const Study study = simulate_study(campaigns, options).front();
    EXPECT_GT(study.splits, 50);
    EXPECT_LT(study.splits, 2000);
    const auto advantage = planned_advantage(study, study.rows[0], 0);
    EXPECT_LE((advantage->upper - advantage->lower) / 2 / advantage->ratio, 0.04);
    EXPECT_EQ(study.ending, Ending::Converged);
    options.precision = 0.2;
    EXPECT_LT(simulate_study(campaigns, options).front().splits, study.splits);
    options.precision = 0.001;
    options.trials = 60;
    EXPECT_EQ(simulate_study(campaigns, options).front().ending, Ending::IterationLimit);
}

TrialStore store_with(const Trial& trial) {
    return {[trial](const TrialSeries&, const VisitTrial& visitor) { visitor(trial); }, {}};
}

TEST(SimulatedStudy, RefusesWhatItCannotDo) {
    const auto refuses = [](const SimulatedCampaign& campaign, const SimulatedStudyOptions& options,
                            const std::string& words) {
        try {
            simulate_study({campaign}, options);
            ADD_FAILURE() << "took " << words;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    const SimulatedCampaign fanuc{"", tracked_fanuc(), {}};
    SimulatedStudyOptions options = few_trials();
    options.shard = {5, 4};
    refuses(fanuc, options, "shard 5 of 4");
    options.shard = {1, 2};
    options.precision = 0.1;
    refuses(fanuc, options, "a precision needs all trials");
    options = few_trials();
    options.trials = 0;
    refuses(fanuc, options, "trials are 0");
    options = few_trials();
    options.pose_counts = {101};
    refuses(fanuc, options, "100");
    options = few_trials();
    options.criteria.emplace();
    options.random_subsets = 0;
    refuses(fanuc, options, "neither planned nor random");
    const Campaign arm = testing::tracked_campaign(testing::planar_arm({1, 0.8}));
    refuses({"", tracked_fanuc(), arm}, few_trials(), "has 2 joints, must have 6");
    Campaign other = tracked_fanuc();
    std::vector<Joint> joints = other.robot.joints();
    joints[3].name = "wrist";
    other.robot = Chain(joints, other.robot.elements());
    refuses({"", tracked_fanuc(), other}, few_trials(), "joint 4 of the truth is 'wrist', must be");
    const std::atomic<bool> interrupted = true;
    options = few_trials();
    options.stop.interrupted = &interrupted;
    refuses(fanuc, options, "interrupted while");

    TrialSeries series;
    series.is_simulated = true;
    series.criteria = {Criterion::V};
    series.pose_counts = {8};
    EXPECT_THROW(study_of_trials(series, store_with({0, {1, 2, 3}})), InputError);
    EXPECT_THROW(study_of_trials(series, store_with({-1, std::vector<double>(6)})), InputError);
    series.is_simulated = false;
    EXPECT_THROW(study_of_trials(series, store_with({7, std::vector<double>(6)})), InputError);
    EXPECT_THROW(study_of_trials(series, store_with({0, std::vector<double>(5)})), InputError);
    EXPECT_THROW(study_of_trials(series, store_with({0, std::vector<double>(15)})), InputError);
}

TEST(DrawnRobots, AreAsLargeAsSurelyAsTheCampaignSays) {
    Campaign campaign = tracked_fanuc();
    campaign.known_within = {2.5, 2};
    double sizes = 0, models = 0, size_squares = 0, model_squares = 0;
    constexpr int count = 2000;
    for (int i = 0; i < count; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const DrawnRobot robot = draw_robot(campaign, seed);
        const double size =
            std::log(robot.truth.robot.norm() / draw_truth(campaign, seed).robot.norm());
        const double model = std::log(robot.model_error / campaign.model_error);
        sizes += size / count;
        models += model / count;
        size_squares += size * size / count;
        model_squares += model * model / count;
    }
    EXPECT_NEAR(sizes, 0, 0.06);
    EXPECT_NEAR(models, 0, 0.08);
    EXPECT_NEAR(std::sqrt(size_squares), std::log(2), 0.05);
    EXPECT_NEAR(std::sqrt(model_squares), std::log(2.5), 0.06);
}

}  // namespace
}  // namespace posewise
