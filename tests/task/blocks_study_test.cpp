#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/core/random.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/study.hpp"
#include "support/temporary_folder.hpp"

/// Value and efficiency of plain blocks against the number of poses.
namespace posewise {
namespace {

using testing::input_error_of;

Blocks random_blocks(Index count, Index rows, Index parameters) {
    RowMatrixXd matrix(count * rows, parameters);
    RandomStream random(7);
    for (Index row = 0; row < matrix.rows(); ++row) {
        for (Index k = 0; k < parameters; ++k) matrix(row, k) = random.normal();
    }
    return make_equal_blocks(matrix, rows);
}

BlocksStudyOptions options_of(std::vector<Criterion> criteria, std::vector<Index> counts) {
    BlocksStudyOptions options;
    options.criteria = std::move(criteria);
    options.pose_counts = std::move(counts);
    options.random_subsets = 40;
    return options;
}

/// The best value of any k of the candidates.
double enumerate(const Blocks& blocks, Criterion criterion, Index k) {
    double best = -std::numeric_limits<double>::infinity();
    std::vector<bool> is_chosen(static_cast<std::size_t>(blocks.count()));
    std::fill(is_chosen.begin(), is_chosen.begin() + k, true);
    do {
        std::vector<Index> poses;
        for (Index i = 0; i < blocks.count(); ++i) {
            if (is_chosen[static_cast<std::size_t>(i)]) poses.push_back(i);
        }
        best = std::max(best, evaluate_rows(criterion, take(blocks, poses).matrix, k, &blocks));
    } while (std::prev_permutation(is_chosen.begin(), is_chosen.end()));
    return best;
}

TEST(BlocksStudy, FindsTheBestOfAllSubsetsOfASmallSet) {
    const Blocks blocks = random_blocks(10, 2, 4);
    const std::vector<Criterion> criteria(all_criteria.begin(), all_criteria.end());
    const BlocksStudy found = study(blocks, options_of(criteria, {5, 3}));
    ASSERT_EQ(found.rows.size(), 2 * criteria.size());
    EXPECT_EQ(found.rows.front().pose_count, 3);
    for (const BlocksStudyRow& row : found.rows) {
        SCOPED_TRACE(criterion_name(row.criterion));
        const double best = enumerate(blocks, row.criterion, row.pose_count);
        EXPECT_NEAR(row.chosen.value, best, 1e-9 * std::abs(best));
        EXPECT_GE(row.chosen.bound, best);
        EXPECT_LE(row.random.p5.value, row.random.p50.value);
        EXPECT_LE(row.random.p95.value, row.chosen.value);
        EXPECT_LE(row.random.p95.efficiency, row.chosen.efficiency);
    }
}

TEST(BlocksStudy, ChoosesAsChooseDoes) {
    const Blocks blocks = random_blocks(40, 3, 8);
    BlocksStudyOptions options = options_of({Criterion::D, Criterion::V}, {4, 5, 9});
    options.excluded = {"3", "17"};
    options.has_prior = true;
    options.held_blocks = take(blocks, {0, 1});
    for (const BlocksStudyRow& row : study(blocks, options).rows) {
        ChoiceOptions one = options;
        one.criterion = row.criterion;
        one.pose_count = row.pose_count;
        const Plan plan = choose(blocks, one);
        EXPECT_EQ(row.chosen.value, plan.value);
        EXPECT_EQ(row.chosen.bound, plan.bound);
        EXPECT_EQ(row.chosen.efficiency, plan.efficiency);
    }
}

TEST(BlocksStudy, RatesOwnSubsetsAsIndicesAndChoiceDo) {
    const Blocks blocks = random_blocks(30, 3, 6);
    BlocksStudyOptions options = options_of({all_criteria.begin(), all_criteria.end()}, {4});
    options.subsets = {{"mine", {5, 2, 11, 7, 29}}, {"few", {1}}, {"again", {4, 8, 9, 13}}};
    const std::vector<Index> best =
        study(blocks, options).rows[2 * all_criteria.size() / 2].chosen.poses;
    options.subsets.push_back({"best", best});
    const BlocksStudy found = study(blocks, options);
    EXPECT_EQ(found.rows.front().pose_count, 1);  // the sizes of subsets are looked at, too
    std::size_t seen = 0;
    for (const BlocksStudyRow& row : found.rows) {
        for (const auto& [number, own] : row.own) {
            ++seen;
            const OwnSubset& subset = found.subsets[number];
            const Rating rating = rate(blocks, subset.poses);
            const auto place = std::ranges::find(all_criteria, row.criterion);
            const auto i = static_cast<std::size_t>(place - all_criteria.begin());
            EXPECT_EQ(own.value, rating.plain.values[i]) << subset.name;
            EXPECT_LE(own.value, row.chosen.bound);
            if (subset.name == "few") {
                EXPECT_EQ(own.value, -std::numeric_limits<double>::infinity());
                EXPECT_EQ(own.efficiency, 0);
            }
            if (subset.poses == row.chosen.poses) {
                EXPECT_EQ(own.value, row.chosen.value);
                EXPECT_EQ(own.efficiency, row.chosen.efficiency);
            }
        }
    }
    EXPECT_EQ(seen, 4 * all_criteria.size());
}

TEST(BlocksStudy, IsTheSameForAnyThreadsAndOtherCounts) {
    const Blocks blocks = random_blocks(60, 3, 9);
    const auto run = [&](Index threads, std::vector<Index> counts) {
        const Index before = thread_count();
        set_thread_count(threads);
        BlocksStudy found = study(blocks, options_of({Criterion::D}, std::move(counts)));
        set_thread_count(before);
        return found;
    };
    const BlocksStudy one = run(1, {6});
    for (const BlocksStudy& other : {run(3, {6}), run(2, {6, 8})}) {
        EXPECT_EQ(other.rows[0].chosen.poses, one.rows[0].chosen.poses);
        EXPECT_EQ(other.rows[0].random.p5.value, one.rows[0].random.p5.value);
        EXPECT_EQ(other.rows[0].random.p50.value, one.rows[0].random.p50.value);
        EXPECT_EQ(other.rows[0].random.p95.efficiency, one.rows[0].random.p95.efficiency);
    }
}

TEST(BlocksStudy, CountsRandomSubsetsThatDoNotIdentify) {
    RowMatrixXd matrix = RowMatrixXd::Zero(12, 3);  // each candidate tells one parameter
    for (Index row = 0; row < 12; ++row) matrix(row, row % 3) = 1;
    const BlocksStudy found =
        study(make_equal_blocks(matrix, 1), options_of({Criterion::D, Criterion::A}, {2, 3}));
    EXPECT_TRUE(found.rows[0].chosen.poses.empty());
    EXPECT_EQ(found.rows[0].random.unidentified, 40);
    EXPECT_EQ(found.rows[2].chosen.poses.size(), 3U);
    EXPECT_GT(found.rows[2].random.unidentified, 10);
    EXPECT_LT(found.rows[2].random.unidentified, 40);
    EXPECT_EQ(found.rows[2].random.p5.value, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(found.rows[2].random.p5.efficiency, 0);
    EXPECT_EQ(found.rows[2].random.p95.value, 0);  // log det of the identity
}

TEST(BlocksStudy, RefusesWhatIsNoChoice) {
    const Blocks blocks = random_blocks(10, 2, 4);
    const auto error = [&](std::vector<Index> poses, std::vector<Index> counts = {}) {
        BlocksStudyOptions options = options_of({Criterion::D}, std::move(counts));
        options.excluded = {"3"};
        if (!poses.empty()) options.subsets = {{"mine", std::move(poses)}};
        return input_error_of([&] { study(blocks, options); });
    };
    EXPECT_EQ(error({1, 10}), "subset 'mine' has candidate 10; must be from 0 to 9");
    EXPECT_EQ(error({1, 3}), "subset 'mine' has candidate 3, which is excluded");
    EXPECT_EQ(error({1, 2, 1}), "subset 'mine' has candidate 1 2 times; the repeat limit is 1");
    EXPECT_EQ(error({}), "pose counts are none; must be at least one");
    EXPECT_NE(error({}, {10}).find("pose count is 10, must be from 1 to 9"), std::string::npos);
    EXPECT_NE(error({}, {1}).find("fewer than the 4 parameters"), std::string::npos);
    BlocksStudyOptions options = options_of({}, {4});
    EXPECT_EQ(input_error_of([&] { study(blocks, options); }),
              "criteria are none; must be at least one");
}

TEST(BlocksStudy, EndsWithTheCountsThatAreFinished) {
    const Blocks blocks = random_blocks(30, 3, 6);
    BlocksStudyOptions options = options_of({Criterion::D}, {3, 4, 5});
    std::atomic<bool> stop = false;
    options.stop.interrupted = &stop;
    options.progress = [&](const Progress& state) {
        EXPECT_EQ(state.total, 3);
        stop = state.done == 2;
    };
    const BlocksStudy found = study(blocks, options);
    EXPECT_EQ(found.ending, Ending::Interrupted);
    EXPECT_EQ(found.rows.size(), 1U);
}

/// With a prior its information counts, without it is `plain`.
TEST(RateBlocks, CountsThePriorOnce) {
    const Blocks blocks = random_blocks(3, 2, 4);
    const Rating rating = rate(blocks, {}, true, 2);
    const MatrixXd M = information(blocks);
    const auto D = static_cast<std::size_t>(std::ranges::find(all_criteria, Criterion::D) -
                                            all_criteria.begin());
    EXPECT_NEAR(rating.plain.values[D], std::log(M.determinant()), 1e-10);
    EXPECT_NEAR(rating.scaled.values[D], std::log((M + MatrixXd::Identity(4, 4)).determinant()),
                1e-10);
    EXPECT_EQ(rating.weakest.size(), 2U);
    EXPECT_EQ(rating.configurations, 3);
    EXPECT_EQ(input_error_of([&] { rate(blocks, {3}); }),
              "a pose is candidate 3; must be from 0 to 2");
}

}  // namespace
}  // namespace posewise
