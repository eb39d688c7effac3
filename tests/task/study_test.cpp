#include "posewise/task/study.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <atomic>
#include <set>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/selection/choice.hpp"
#include "support/campaigns.hpp"
#include "support/sensors.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

struct Example {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    Measurements measurements;

    explicit Example(Index poses = 14) {
        SimulateOptions options;
        options.pose_count = poses;
        options.repeats = 2;
        measurements = simulate(campaign, options).measurements;
    }
};

StudyOptions small_options() {
    StudyOptions options;
    options.criteria = {Criterion::D, Criterion::A};
    options.pose_counts = {6, 9};
    options.random_subsets = 8;
    options.starts = 4;
    return options;
}

StudyCase case_with_error(double rms) {
    StudyCase result;
    result.identified = true;
    result.held_out.point_count = 1;
    result.held_out.rms = rms;
    return result;
}

TEST(StudyPoseCounts, JudgesEachSubsetOnWhatItLeftOut) {
    const Example example;
    const auto rows = study(example.campaign, example.measurements, small_options()).rows;
    ASSERT_EQ(rows.size(), 2u);
    for (const StudyRow& row : rows) {
        ASSERT_EQ(row.optimal.size(), 2u);
        ASSERT_EQ(row.random.size(), 8u);
        for (const StudyCase& optimal : row.optimal) {
            EXPECT_TRUE(optimal.identified);
            EXPECT_EQ(optimal.poses.size(), static_cast<std::size_t>(row.pose_count));
            EXPECT_EQ(optimal.held_out.point_count, (14 - row.pose_count) * 3);
        }
    }
    // By hand: calibrate with the chosen ones, predict the others.
    const StudyCase& chosen = rows[1].optimal[0];
    const auto part = take(example.measurements, chosen.poses);
    const auto estimate = identify(example.campaign, part,
                                   register_base_and_targets(example.campaign, part).parameters);
    const auto held_out =
        make_metrics(mean_residuals(example.campaign, estimate.parameters,
                                    take(example.measurements, all_but(14, chosen.poses))));
    EXPECT_DOUBLE_EQ(chosen.held_out.rms, held_out.distance_rms);
    EXPECT_DOUBLE_EQ(chosen.held_out.max, held_out.distance_max);
}

TEST(StudyPoseCounts, JudgesViewsOfACameraByPlacesInTheImage) {
    Campaign campaign = testing::before_camera(testing::tracked_campaign(testing::fanuc()),
                                               testing::fixed_camera());
    campaign.spread = population_spread(campaign.robot);
    const Measurements measured = simulate(campaign, {.pose_count = 40}).measurements;
    StudyOptions options = small_options();
    options.criteria = {Criterion::V};
    options.pose_counts = {12};
    options.splits = 4;
    const Study found = study(campaign, measured, options);
    EXPECT_EQ(found.units, &pixel_units);
    ASSERT_EQ(found.rows.size(), 1u);
    double squares = 0, expected = 0;
    for (const StudyCase& one : found.rows[0].optimal) {
        ASSERT_TRUE(one.identified);
        EXPECT_GT(one.held_out.point_count, 100);
        EXPECT_GT(one.held_out.max, one.held_out.p95);
        EXPECT_GT(one.held_out.p95, one.held_out.rms);
        squares += one.held_out.rms * one.held_out.rms;
        expected += one.expected * one.expected;
    }
    EXPECT_NEAR(std::sqrt(squares / expected), 1, 0.35);
    // By hand, of the first split.
    const StudyCase& chosen = found.rows[0].optimal[0];
    const auto part = take(measured, chosen.poses);
    const auto estimate =
        identify(campaign, part, register_base_and_targets(campaign, part).parameters);
    const auto others =
        RandomStream(campaign.seed, 0).subset(measured.configuration_count(), found.test_count);
    const double rms =
        make_metrics(mean_residuals(campaign, estimate.parameters, take(measured, others)),
                     *campaign.sensor)
            .orientation_rms;
    EXPECT_NEAR(chosen.held_out.rms, rms, 1e-9);
}

TEST(StudyPoseCounts, ChoosesAndJudgesByTheTargetsSeen) {
    Example example;
    testing::hide_at_random(example.measurements, 0.3, 6);
    const auto rows = study(example.campaign, example.measurements, small_options()).rows;
    const StudyCase& chosen = rows[1].optimal[0];
    const auto part = take(example.measurements, chosen.poses);
    const auto start = register_base_and_targets(example.campaign, example.measurements).parameters;
    SelectOptions options;
    options.criterion = Criterion::D;
    options.pose_count = 9;
    options.starts = 4;
    const RowMatrixXd repeats = 2 * share_seen(example.measurements);  // of two samples
    EXPECT_EQ(repeats, times_seen(example.measurements));
    EXPECT_EQ(chosen.poses, select_poses(make_blocks(example.campaign, start,
                                                     example.measurements.configurations, repeats),
                                         options)
                                .poses);
    const auto estimate = identify(example.campaign, part,
                                   register_base_and_targets(example.campaign, part).parameters);
    const auto left_out = take(example.measurements, all_but(14, chosen.poses));
    const auto held_out =
        make_metrics(mean_residuals(example.campaign, estimate.parameters, left_out));
    EXPECT_EQ(held_out.point_count, (times_seen(left_out).array() > 0).count());
    EXPECT_EQ(chosen.held_out.point_count, held_out.point_count);
    EXPECT_DOUBLE_EQ(chosen.held_out.rms, held_out.distance_rms);
}

TEST(StudyPoseCounts, IsTheSameForAnyNumberOfThreads) {
    const Example example;
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const auto one = study(example.campaign, example.measurements, small_options()).rows;
    omp_set_num_threads(3);
    const auto three = study(example.campaign, example.measurements, small_options()).rows;
    omp_set_num_threads(threads);
    for (std::size_t i = 0; i < one.size(); ++i) {
        for (std::size_t k = 0; k < one[i].random.size(); ++k) {
            EXPECT_EQ(one[i].random[k].poses, three[i].random[k].poses);
            EXPECT_EQ(one[i].random[k].identified, three[i].random[k].identified);
            EXPECT_EQ(one[i].random[k].held_out.rms, three[i].random[k].held_out.rms);
        }
        for (std::size_t k = 0; k < one[i].optimal.size(); ++k) {
            EXPECT_EQ(one[i].optimal[k].poses, three[i].optimal[k].poses);
            EXPECT_EQ(one[i].optimal[k].held_out.rms, three[i].optimal[k].held_out.rms);
        }
    }
}

TEST(StudyPoseCounts, DrawsTheSameSubsetsWhenAskedForMoreOfThem) {
    const Example example;
    StudyOptions options = small_options();
    const auto few = study(example.campaign, example.measurements, options).rows;
    options.random_subsets = 12;
    options.pose_counts = {9};
    const auto more = study(example.campaign, example.measurements, options).rows;
    std::set<std::vector<Index>> different;
    for (std::size_t k = 0; k < 12; ++k) {
        different.insert(more[0].random[k].poses);
        if (k < 8) {
            EXPECT_EQ(few[1].random[k].poses, more[0].random[k].poses);
        }
    }
    EXPECT_GT(different.size(), 9u);
}

TEST(StudyPoseCounts, CountsSubsetsThatCannotIdentify) {
    const Example example;
    StudyOptions options = small_options();
    options.pose_counts = {4, 14};  // 36 equations but a 6R robot with three points needs five
    const auto rows = study(example.campaign, example.measurements, options).rows;
    for (const StudyCase& random : rows[0].random) {
        EXPECT_FALSE(random.identified);
        EXPECT_EQ(random.poses.size(), 4u);
    }
    EXPECT_FALSE(rows[0].optimal[0].identified);
    EXPECT_TRUE(rows[1].optimal[0].identified);
    EXPECT_EQ(rows[1].optimal[0].held_out.point_count, 0);
}

TEST(StudyPoseCounts, GoesFromTheLeastCountToAllButOne) {
    const Example example(8);
    StudyOptions options = small_options();
    options.pose_counts.clear();
    options.random_subsets = 0;
    const auto rows = study(example.campaign, example.measurements, options).rows;
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_EQ(rows.front().pose_count, 5);
    EXPECT_EQ(rows.back().pose_count, 7);
}

TEST(StudyPoseCounts, LeavesAFifthAndAtLeastFourToJudgeOn) {
    const Example example(10);
    StudyOptions options = small_options();
    options.pose_counts.clear();
    options.random_subsets = 0;
    EXPECT_EQ(study(example.campaign, example.measurements, options).rows.back().pose_count, 6);
}

TEST(StudyPoseCounts, ReportsProgressToTheEnd) {
    const Example example;
    Index last = 0;
    Index total = 0;
    StudyOptions options = small_options();
    options.progress = [&](const Progress& progress) {
        EXPECT_EQ(progress.done, last + 1);
        last = progress.done;
        total = progress.total;
    };
    study(example.campaign, example.measurements, options);
    EXPECT_EQ(last, 20);
    EXPECT_EQ(total, 20);
}

TEST(StudyPoseCounts, PassesOnWhatTheProgressCallbackThrows) {
    const Example example;
    StudyOptions options = small_options();
    options.progress = [](const Progress&) { throw std::domain_error("enough"); };
    EXPECT_THROW(study(example.campaign, example.measurements, options), std::domain_error);
}

TEST(StudyPoseCounts, RefusesWhatCannotBeStudied) {
    const Example example;
    StudyOptions options = small_options();
    options.pose_counts = {15};
    EXPECT_THROW(study(example.campaign, example.measurements, options), InputError);
    options.pose_counts = {14};  // none would be left to judge on
    EXPECT_THROW(study(example.campaign, example.measurements, options), InputError);
    options.pose_counts = {0};
    EXPECT_THROW(study(example.campaign, example.measurements, options), InputError);
    options = small_options();
    options.starts = -1;
    EXPECT_THROW(study(example.campaign, example.measurements, options), InputError);
    const Example too_few(4);
    options = small_options();
    options.pose_counts = {4};
    const Study nothing = study(too_few.campaign, too_few.measurements, options);
    EXPECT_EQ(nothing.ending, Ending::NotIdentifiable);
    EXPECT_EQ(nothing.undetermined.find("these 4 configurations cannot tell apart"), 0U);
    EXPECT_TRUE(nothing.rows.empty());
    options.pose_counts.clear();
    EXPECT_THROW(study(too_few.campaign, too_few.measurements, options), InputError);
}

TEST(StudyPoseCounts, JudgesAllSubsetsOfASplitOnTheSameConfigurations) {
    const Example example(30);
    StudyOptions options = small_options();
    options.pose_counts = {6};
    options.splits = 3;
    const Study result = study(example.campaign, example.measurements, options);
    EXPECT_EQ(result.splits, 3);
    EXPECT_EQ(result.test_count, 9);
    ASSERT_EQ(result.rows.size(), 1u);
    const StudyRow& row = result.rows.front();
    ASSERT_EQ(row.optimal.size(), 6u);  // two criteria, three splits
    std::vector<StudyCase> all(row.random.begin(), row.random.end());
    all.insert(all.end(), row.optimal.begin(), row.optimal.end());
    std::vector<std::set<Index>> taken(3);
    for (const StudyCase& subset : all) {
        EXPECT_EQ(subset.held_out.point_count, 9 * 3);
        taken[static_cast<std::size_t>(subset.split)].insert(subset.poses.begin(),
                                                             subset.poses.end());
    }
    for (const std::set<Index>& poses : taken) EXPECT_LE(poses.size(), 21u);
    EXPECT_NE(taken[0], taken[1]);
    const auto planned = planned_cases(row, 1, 2);
    ASSERT_EQ(planned.size(), 3u);
    EXPECT_EQ(planned[2].poses, row.optimal[5].poses);
    EXPECT_EQ(planned[2].split, 2);
}

TEST(StudyPoseCounts, WithSplitsGoesUpToAThirdOfWhatThereIsToChooseFrom) {
    StudyOptions options;
    options.criteria = {Criterion::D};
    options.random_subsets = 0;
    options.starts = 1;
    options.splits = 1;
    const Example example(54);  // 38 to choose from
    std::vector<Index> counts;
    for (const StudyRow& row : study(example.campaign, example.measurements, options).rows) {
        counts.push_back(row.pose_count);
    }
    EXPECT_EQ(counts, (std::vector<Index>{8, 12}));
    options.holdout = 1;
    EXPECT_THROW(study(example.campaign, example.measurements, options), InputError);
}

TEST(StudyPoseCounts, PlansOnlyWhatKeepsTheLeastDistance) {
    const Example example(30);
    StudyOptions options = small_options();
    options.splits = 2;
    const auto free = study(example.campaign, example.measurements, options).rows;
    const auto nearest = [&](const std::vector<StudyRow>& rows) {
        double least = std::numeric_limits<double>::infinity();
        for (const StudyRow& row : rows) {
            for (const StudyCase& planned : row.optimal) {
                const RowMatrixXd taken =
                    example.measurements.configurations(planned.poses, Eigen::all);
                for (Index i = 1; i < taken.rows(); ++i) {
                    least = std::min(
                        least,
                        (taken.topRows(i).rowwise() - taken.row(i)).rowwise().norm().minCoeff());
                }
            }
        }
        return least;
    };
    options.least_distance = nearest(free) + 0.5;  // rad
    const auto apart = study(example.campaign, example.measurements, options).rows;
    EXPECT_GE(nearest(apart), options.least_distance);
    for (std::size_t i = 0; i < apart.size(); ++i) {
        for (std::size_t k = 0; k < apart[i].random.size(); ++k) {
            EXPECT_EQ(apart[i].random[k].poses, free[i].random[k].poses);
        }
    }
    options.least_distance = 100;  // no two are that far apart
    EXPECT_THROW(study(example.campaign, example.measurements, options), InputError);
}

TEST(Study, RefusesAHoldoutWithoutSplits) {
    const Example example(12);
    StudyOptions options = small_options();
    options.pose_counts = {8};
    options.holdout = 0.5;
    options.splits.reset();  // none, since 8 is over a third
    EXPECT_NE(testing::input_error_of([&] {
                  study(example.campaign, example.measurements, options);
              }).find("`holdout` is of splits, and none are made"),
              std::string::npos);
    options.holdout.reset();
    EXPECT_EQ(study(example.campaign, example.measurements, options).splits, 0);
}

TEST(CompareModels, GivesEachTheSameSplitsCountsAndRandomSubsets) {
    const Example example(30);
    StudyOptions options = small_options();
    options.pose_counts.clear();
    options.random_subsets = 6;
    options.splits = 2;
    options.holdout = 0.7;  // 9 to choose from
    Progress last;
    options.progress = [&](const Progress& progress) {
        EXPECT_EQ(progress.done, last.done + 1);
        last = progress;
    };
    Campaign prior = example.campaign;
    prior.spread.is_prior = true;
    ASSERT_LT(least_pose_count(prior), 5);
    const auto studies = compare_models({{"prior", prior}, {"stated", example.campaign}},
                                        example.measurements, options);
    EXPECT_EQ(last.done, last.total);
    ASSERT_EQ(studies.size(), 2u);
    EXPECT_EQ(studies[0].model, "prior");
    EXPECT_EQ(studies[1].model, "stated");
    options.progress = nullptr;
    const auto alone = study(example.campaign, example.measurements, options).rows;
    ASSERT_EQ(studies[0].rows.size(), alone.size());
    ASSERT_EQ(studies[1].rows.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
        EXPECT_EQ(studies[0].rows[i].pose_count, alone[i].pose_count);  // from 5, not from fewer
        for (std::size_t k = 0; k < 6; ++k) {
            const StudyCase& random = studies[1].rows[i].random[k];
            EXPECT_EQ(studies[0].rows[i].random[k].poses, random.poses);
            EXPECT_EQ(studies[0].rows[i].random[k].split, random.split);
            EXPECT_EQ(alone[i].random[k].held_out.rms, random.held_out.rms);
            EXPECT_NE(studies[0].rows[i].random[k].held_out.rms, random.held_out.rms);
        }
        EXPECT_EQ(alone[i].optimal[0].poses, studies[1].rows[i].optimal[0].poses);
    }
}

TEST(CompareModels, KeepsThePoseCountsThatAreCompleteInAll) {
    const Example example;
    std::atomic<bool> stop = false;
    StudyOptions options = small_options();
    options.stop.interrupted = &stop;
    options.progress = [&](const Progress& progress) { stop = 2 * progress.done > progress.total; };
    for (const Study& study : compare_models({{"a", example.campaign}, {"b", example.campaign}},
                                             example.measurements, options)) {
        EXPECT_TRUE(study.rows.empty());  // the first is complete, the second has just begun
    }
}

TEST(CompareModels, GivesTheSplitsThatAreFinishedInAllWhereItIsStopped) {
    const Example example(30);
    StudyOptions options = small_options();
    options.pose_counts = {6, 7};
    options.splits = 4;
    const std::vector<RobotModel> models{{"a", example.campaign}, {"b", example.campaign}};
    const auto whole = compare_models(models, example.measurements, options);
    std::atomic<bool> stop = false;
    options.stop.interrupted = &stop;
    options.progress = [&](const Progress& progress) {
        stop = 5 * progress.done > 3 * progress.total;
    };
    const auto part = compare_models(models, example.measurements, options);
    ASSERT_EQ(part.size(), 2u);
    for (std::size_t s = 0; s < 2; ++s) {
        EXPECT_EQ(part[s].ending, Ending::Interrupted);
        EXPECT_EQ(part[s].splits, 4);
        ASSERT_EQ(part[s].rows.size(), 2u);
        for (std::size_t i = 0; i < 2; ++i) {
            const StudyRow& row = part[s].rows[i];
            const StudyRow& all = whole[s].rows[i];
            const auto splits = static_cast<std::size_t>(split_count(row, 2));
            EXPECT_TRUE(splits == 2 || splits == 3) << splits;
            EXPECT_EQ(row.random.size(), 2 * splits);
            for (std::size_t k = 0; k < splits; ++k) {
                EXPECT_EQ(planned_cases(row, 1, 2)[k].poses, planned_cases(all, 1, 2)[k].poses);
                EXPECT_EQ(row.random[k].poses, all.random[k].poses);
                EXPECT_EQ(row.random[splits + k].poses, all.random[4 + k].poses);
            }
            EXPECT_TRUE(planned_advantage(part[s], row, 0, part[0].rows[i]).has_value());
        }
    }
}

TEST(PlannedAdvantage, IsTheGeometricMeanOverSplits) {
    Study study;
    study.criteria = {Criterion::V};
    study.splits = 2;
    StudyRow row{
        8, {case_with_error(1), case_with_error(4)}, {case_with_error(2), case_with_error(2)}};
    const auto advantage = planned_advantage(study, row, 0);
    ASSERT_TRUE(advantage);
    EXPECT_NEAR(advantage->ratio, 1, 1e-15);
    // Logarithms -ln 2 and ln 2: their mean has the deviation ln 2, Student's t is 12.706.
    EXPECT_NEAR(std::log(advantage->upper), 12.7062047 * std::log(2.0), 1e-6);
    EXPECT_NEAR(std::log(advantage->lower), -std::log(advantage->upper), 1e-12);
    StudyRow other = row;  // of another model, half as accurate
    other.random = {case_with_error(4), case_with_error(4)};
    EXPECT_NEAR(planned_advantage(study, row, 0, other)->ratio, 0.5, 1e-15);
    // Of more robots, or fewer: those that both have.
    other = {8,
             {case_with_error(1), case_with_error(1), case_with_error(1)},
             {case_with_error(4), case_with_error(1), case_with_error(9)}};
    EXPECT_NEAR(planned_advantage(study, row, 0, other)->ratio, 1, 1e-15);
    other = {8, {case_with_error(1)}, {case_with_error(4), case_with_error(9), case_with_error(3)}};
    EXPECT_NEAR(planned_advantage(study, row, 0, other)->ratio, 0.25, 1e-15);
    EXPECT_EQ(advantage->left_out, 0);
    row.random = {case_with_error(2), StudyCase{}};  // none is comparable in the second split
    ASSERT_TRUE(planned_advantage(study, row, 0));
    EXPECT_NEAR(planned_advantage(study, row, 0)->ratio, 0.5, 1e-15);
    EXPECT_EQ(planned_advantage(study, row, 0)->left_out, 1);
    row.random = {StudyCase{}, StudyCase{}};
    EXPECT_FALSE(planned_advantage(study, row, 0));
    row.random = {case_with_error(2), case_with_error(2)};
    row.optimal = {case_with_error(1), StudyCase{}};
    EXPECT_FALSE(planned_advantage(study, row, 0));
    study.splits = 0;
    EXPECT_FALSE(planned_advantage(study, row, 0));
}

TEST(HeldOutQuantile, IsLinearBetweenOrderStatistics) {
    const std::vector<StudyCase> cases{case_with_error(4), case_with_error(1), case_with_error(2),
                                       case_with_error(8)};
    EXPECT_DOUBLE_EQ(*held_out_quantile(cases, 0), 1);
    EXPECT_DOUBLE_EQ(*held_out_quantile(cases, 0.5), 3);
    EXPECT_DOUBLE_EQ(*held_out_quantile(cases, 0.9), 4 + 0.7 * 4);
    EXPECT_DOUBLE_EQ(*held_out_quantile(cases, 1), 8);
}

TEST(HeldOutQuantile, CountsTheUnidentifiedAsWorst) {
    const std::vector<StudyCase> cases{case_with_error(4), StudyCase{}, case_with_error(1)};
    EXPECT_DOUBLE_EQ(*held_out_quantile(cases, 0.5), 4);
    EXPECT_FALSE(held_out_quantile(cases, 0.51));
    EXPECT_FALSE(held_out_quantile(cases, 1));
}

TEST(HeldOutQuantile, IsAbsentWithoutAnErrorToCount) {
    StudyCase nothing_left;
    nothing_left.identified = true;
    EXPECT_FALSE(held_out_quantile({}, 0.5));
    EXPECT_FALSE(held_out_quantile({StudyCase{}}, 0.5));
    EXPECT_FALSE(held_out_quantile({nothing_left}, 0.5));
}

}  // namespace
}  // namespace posewise
