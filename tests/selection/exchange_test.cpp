#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <atomic>
#include <cmath>

#include "../../src/core/decompositions.hpp"
#include "../../src/selection/bound.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/selection/choice.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

SelectOptions make_options(Criterion criterion, Index pose_count) {
    SelectOptions options;
    options.criterion = criterion;
    options.pose_count = pose_count;
    options.proof = 0;  // so that it is the search that finds
    options.starts = 20;
    return options;
}

std::string message_of(const Blocks& candidates, const SelectOptions& options) {
    try {
        return select_poses(candidates, options).undetermined;
    } catch (const InputError& error) {
        return error.what();
    }
}

void expect_refusal(const Blocks& candidates, const SelectOptions& options,
                    const std::string& part) {
    const std::string message = message_of(candidates, options);
    EXPECT_NE(message.find(part), std::string::npos) << "message: " << message;
}

/// The plan has the value of the best choice there is, and a bound that is not below it.
void expect_best(const Blocks& candidates, const SelectOptions& options) {
    double best = -std::numeric_limits<double>::infinity();
    test::for_each_choice(candidates.count(), options, [&](const std::vector<Index>& poses) {
        best = std::max(best, choice_value(candidates, options, poses));
    });
    const Choice plan = select_poses(candidates, options);
    EXPECT_NEAR(plan.value, best, 1e-11 * std::abs(best)) << criterion_name(options.criterion);
    EXPECT_EQ(plan.value, choice_value(candidates, options, plan.poses));
    EXPECT_GE(plan.bound, plan.value);
    const double certified = upper_bound(candidates, options, plan.certificate);
    EXPECT_GE(certified, plan.value - 1e-10 * std::abs(plan.value));
    EXPECT_GE(certified, plan.bound - 1e-10 * std::abs(plan.bound));
    EXPECT_GT(plan.efficiency, 0);
    EXPECT_LE(plan.efficiency, 1);
    EXPECT_GE(plan.starts_at_best, 1);
}

/// Rows of the reduced incidence matrix of random edges: K = parameters rows identify them if and
/// only if they are a spanning tree.
Blocks random_edges(Index nodes, Index count, std::uint64_t seed) {
    RandomStream random(seed);
    RowMatrixXd rows = RowMatrixXd::Zero(count, nodes - 1);
    for (Index i = 0; i < count; ++i) {
        const Index from = random.index(nodes);
        const Index to = (from + 1 + random.index(nodes - 1)) % nodes;
        if (from < nodes - 1) rows(i, from) = 1;
        if (to < nodes - 1) rows(i, to) = -1;
    }
    return make_equal_blocks(rows, 1);
}

TEST(SelectPoses, RefusesTestPosesOfOtherParameters) {
    const Blocks candidates = test::random_blocks(10, 3, 5, 1);
    const Blocks other = test::random_blocks(4, 3, 2, 2);
    for (const Criterion criterion : {Criterion::G, Criterion::V}) {
        SelectOptions options = make_options(criterion, 4);
        options.test_poses = &other;
        expect_refusal(candidates, options, "test poses have 2 columns, must have 5");
    }
}

TEST(SelectPoses, FindsAnIdentifyingChoiceWhereFewAreWhateverTheCriterion) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const Blocks edges = random_edges(8, 40, seed);
        for (const Criterion criterion : all_criteria) {
            SelectOptions options = make_options(criterion, 7);
            options.starts = 1;
            options.kicks = 0;
            for (Index i = 0; i < edges.count(); ++i) options.groups.push_back(i % 6);
            options.group_limit = 2;
            EXPECT_EQ(message_of(edges, options), "") << criterion_name(criterion) << ' ' << seed;
        }
    }
}

TEST(SelectByExchange, FindsTheBestSubsetOfASmallSet) {
    const std::array<std::array<Index, 2>, 6> shapes = {
        {{1, 4}, {2, 5}, {3, 7}, {6, 9}, {9, 20}, {13, 20}}};
    for (std::uint64_t seed = 0; seed < shapes.size(); ++seed) {
        const auto [rows, parameters] = shapes[seed];
        const Blocks candidates = test::random_blocks(12, rows, parameters, seed);
        for (const Criterion criterion : all_criteria) {
            expect_best(candidates, make_options(criterion, 5));
        }
    }
}

TEST(SelectByExchange, FindsTheBestOfBlocksOfDifferentHeights) {
    Blocks candidates = test::random_blocks(24, 1, 5, 3);
    candidates.first_row = {0, 1, 4, 6, 7, 10, 12, 15, 16, 20, 24};
    for (const Criterion criterion : {Criterion::D, Criterion::A, Criterion::E}) {
        expect_best(candidates, make_options(criterion, 4));
    }
}

TEST(SelectByExchange, HonoursEveryLimit) {
    const Blocks candidates = test::random_blocks(9, 2, 4, 7);
    for (const Criterion criterion : {Criterion::D, Criterion::V, Criterion::E, Criterion::O5}) {
        SelectOptions repeats = make_options(criterion, 5);
        repeats.repeat_limit = 3;
        expect_best(candidates, repeats);
        SelectOptions excluded = make_options(criterion, 4);
        excluded.excluded = {1, 4, 8};
        expect_best(candidates, excluded);
        SelectOptions groups = make_options(criterion, 4);
        groups.groups = {5, 5, 5, -1, -1, -1, 0, 0, 0};
        groups.group_limit = 2;
        expect_best(candidates, groups);
        SelectOptions apart = make_options(criterion, 4);
        apart.positions = VectorXd::LinSpaced(9, 0, 8);
        apart.least_distance = 1.5;
        expect_best(candidates, apart);
    }
}

/// Nine in three by three, a step apart: a pose in the middle leaves room for no other one.
TEST(SelectByExchange, KeepsApartWhatFitsOnlyInTheCorners) {
    Blocks candidates = test::random_blocks(9, 2, 3, 7);
    candidates.matrix.middleRows(8, 2) *= 100;  // the best pose by far
    SelectOptions apart = make_options(Criterion::D, 4);
    apart.positions.resize(9, 2);
    for (Index k = 0; k < 9; ++k) {
        apart.positions.row(k) << static_cast<double>(k % 3), static_cast<double>(k / 3);
    }
    apart.least_distance = 1.9;
    EXPECT_EQ(select_poses(candidates, apart).poses, (std::vector<Index>{0, 2, 6, 8}));
    apart.pose_count = 5;
    expect_refusal(candidates, apart, "only 4");
}

TEST(SelectByExchange, AddsToWhatIsHeld) {
    const Blocks candidates = test::random_blocks(12, 2, 9, 8);
    for (const Criterion criterion : all_criteria) {
        SelectOptions options = make_options(criterion, 3);  // six rows, nine parameters
        options.held_rows = stack(MatrixXd::Identity(9, 9), take(candidates, {0, 1}).matrix);
        options.held_pose_count = 2;
        options.excluded = {0, 1};
        expect_best(candidates, options);
    }
}

TEST(SelectByExchange, LeavesNuisanceOutOfTheValue) {
    const Blocks candidates = test::random_blocks(12, 2, 6, 9);
    for (const Criterion criterion : {Criterion::D, Criterion::A, Criterion::E, Criterion::O1}) {
        SelectOptions options = make_options(criterion, 5);
        options.nuisance = {0, 2, 3};
        expect_best(candidates, options);
    }
}

TEST(SelectByExchange, SaysWhenThePlanIsOptimal) {
    const Blocks candidates = test::random_blocks(10, 3, 4, 5);
    SelectOptions options = make_options(Criterion::D, 5);
    options.proof = 1;
    const Choice plan = select_poses(candidates, options);
    EXPECT_EQ(plan.ending, Ending::Optimal);
    EXPECT_EQ(plan.bound, plan.value);
    EXPECT_EQ(plan.efficiency, 1);
}

TEST(SelectByExchange, GivesTheSamePlanForAnyNumberOfThreads) {
    const Blocks candidates = test::random_blocks(300, 3, 9, 5);
    const int threads = omp_get_max_threads();
    for (const Criterion criterion : {Criterion::D, Criterion::O3, Criterion::V}) {
        SelectOptions options = make_options(criterion, 8);
        options.kicks = 5;
        omp_set_num_threads(1);
        const Choice serial = select_poses(candidates, options);
        omp_set_num_threads(2);
        const Choice parallel = select_poses(candidates, options);
        EXPECT_EQ(serial.poses, parallel.poses);
        EXPECT_EQ(serial.value, parallel.value);
        EXPECT_EQ(serial.bound, parallel.bound);
        EXPECT_EQ(serial.starts_at_best, parallel.starts_at_best);
    }
    omp_set_num_threads(threads);
}

TEST(SelectByExchange, CountsOnlyTheStartsThatEnded) {
    const Blocks candidates = test::random_blocks(300, 3, 9, 5);
    SelectOptions options = make_options(Criterion::D, 8);
    options.proof = 0;
    const Choice whole = select_poses(candidates, options);
    EXPECT_GT(whole.starts, 0);
    const std::atomic<bool> stop{true};
    options.stop.interrupted = &stop;
    const Choice stopped = select_poses(candidates, options);
    EXPECT_EQ(stopped.ending, Ending::Interrupted);
    EXPECT_EQ(stopped.poses.size(), 8U);
    EXPECT_EQ(stopped.starts, 0);
    EXPECT_EQ(stopped.starts_at_best, 0);
}

TEST(SelectByExchange, FindsThePosesThatJustIdentifyTheParameters) {
    // Only poses 3 and 7 see the last parameter.
    RowMatrixXd matrix = test::random_blocks(12, 1, 4, 9).matrix;
    for (const Index row : {0, 1, 2, 4, 5, 6, 8, 9, 10, 11}) matrix(row, 3) = 0;
    for (const Criterion criterion : {Criterion::D, Criterion::E, Criterion::A}) {
        expect_best(make_equal_blocks(matrix, 1), make_options(criterion, 4));
    }
}

TEST(SelectByExchange, StopsInTimeOrWhenAskedWithABound) {
    const Blocks candidates = test::random_blocks(2000, 3, 12, 5);
    SelectOptions options = make_options(Criterion::D, 20);
    options.kicks = 1'000'000;
    options.stop.deadline = deadline_after(0.05);
    const Choice timed = select_poses(candidates, options);
    EXPECT_EQ(timed.ending, Ending::TimeLimit);
    EXPECT_GE(timed.bound, timed.value);
    const std::atomic<bool> interrupted = true;
    options.stop.interrupted = &interrupted;
    const Choice stopped = select_poses(candidates, options);
    EXPECT_EQ(stopped.ending, Ending::Interrupted);
    EXPECT_TRUE(std::isfinite(stopped.bound));
    EXPECT_TRUE(std::isfinite(stopped.value));
}

TEST(SelectByExchange, TellsItsProgress) {
    const Blocks candidates = test::random_blocks(20, 1, 4, 5);
    SelectOptions options = make_options(Criterion::D, 6);
    std::vector<Progress> reports;
    options.progress = [&](const Progress& progress) { reports.push_back(progress); };
    const Choice plan = select_poses(candidates, options);
    ASSERT_EQ(static_cast<Index>(reports.size()), options.starts);
    EXPECT_EQ(reports.back().done, options.starts);
    EXPECT_NEAR(reports.back().value, plan.value, 1e-9);
}

TEST(SelectByExchange, PassesOnWhatTheProgressCallbackThrows) {
    SelectOptions options = make_options(Criterion::D, 6);
    options.proof = 0;
    options.progress = [](const Progress&) { throw std::domain_error("enough"); };
    EXPECT_THROW(select_poses(test::random_blocks(20, 1, 4, 5), options), std::domain_error);
}

TEST(SelectByExchange, EndsWhenTenStartsAgree) {
    SelectOptions options;
    options.pose_count = 10;
    options.proof = 0;
    const Blocks candidates = test::random_blocks(30, 3, 5, 1);
    const Choice agreed = select_poses(candidates, options);
    EXPECT_EQ(agreed.starts_at_best, 10);
    EXPECT_LT(agreed.starts, 20);
    options.starts = 20;
    const Choice stated = select_poses(candidates, options);
    EXPECT_EQ(stated.starts, 20);
    EXPECT_EQ(stated.poses, agreed.poses);
}

/// On so many threads.
Choice select_on(int threads, const Blocks& candidates, const SelectOptions& options) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    Choice choice = select_poses(candidates, options);
    omp_set_num_threads(before);
    return choice;
}

TEST(SelectByExchange, NeedsTheSameStartsForAnyNumberOfThreads) {
    const Blocks candidates = test::random_blocks(200, 1, 12, 3);
    SelectOptions options;
    options.pose_count = 14;
    options.kicks = 0;
    options.proof = 0;
    const Choice serial = select_on(1, candidates, options);
    const Choice parallel = select_on(4, candidates, options);
    EXPECT_GT(serial.starts, 5);
    EXPECT_EQ(serial.starts, parallel.starts);
    EXPECT_EQ(serial.starts_at_best, parallel.starts_at_best);
    EXPECT_EQ(serial.poses, parallel.poses);
}

TEST(SelectByExchange, TakesFewerStartsWhereEachTakesLong) {
    SelectOptions options;
    options.pose_count = 10;
    options.kicks = 0;
    options.proof = 0;
    const Blocks candidates = test::random_blocks(300, 12, 90, 1);
    const Choice parallel = select_poses(candidates, options);
    const Choice serial = select_on(1, candidates, options);
    EXPECT_EQ(parallel.starts, 6);
    EXPECT_EQ(serial.poses, parallel.poses);
    EXPECT_EQ(serial.starts_at_best, parallel.starts_at_best);
    EXPECT_EQ(serial.bound, parallel.bound);
}

TEST(SelectByExchange, RefusesUnusableInput) {
    const Blocks candidates = test::random_blocks(6, 1, 4, 1);
    expect_refusal(candidates, make_options(Criterion::D, 7), "pose count is 7");
    expect_refusal(candidates, make_options(Criterion::D, 0), "pose count is 0");
    expect_refusal(candidates, make_options(Criterion::D, 3), "must be at least 4: ");
    SelectOptions options = make_options(Criterion::D, 5);
    options.starts = -1;
    expect_refusal(candidates, options, "starts is -1");
    options = make_options(Criterion::D, 5);
    options.excluded = {2, 4};
    expect_refusal(candidates, options, "from 1 to 4");
    options.excluded = {6};
    expect_refusal(candidates, options, "excluded candidate is 6");
    options = make_options(Criterion::D, 5);
    options.groups = {1, 2};
    expect_refusal(candidates, options, "one for each of 6");
    options.groups = {0, 0, 0, 0, 1, 1};
    options.group_limit = 2;
    expect_refusal(candidates, options, "only 4");
    options = make_options(Criterion::D, 5);
    options.held_rows = MatrixXd::Identity(3, 3);
    expect_refusal(candidates, options, "held rows have 3 columns, must have 4");
    options.held_rows = MatrixXd::Constant(1, 4, std::nan(""));
    expect_refusal(candidates, options, "held rows have a value that is not a finite number");
    options = make_options(Criterion::D, 5);
    options.least_distance = 1;
    expect_refusal(candidates, options, "positions has 0 rows");
    Blocks blind = candidates;
    blind.matrix.col(2) = blind.matrix.col(1);
    expect_refusal(blind, make_options(Criterion::D, 5), "unseen (0.71 column 2 - 0.71 column 3)");
    blind.matrix.col(3).setZero();
    for (const char* const part :
         {"2 of 4 parameter directions unseen (", "0.71 column 2 - 0.71 column 3", "1 column 4"}) {
        expect_refusal(blind, make_options(Criterion::D, 5), part);
    }
    Blocks not_finite = candidates;
    not_finite.matrix(1, 1) = std::numeric_limits<double>::quiet_NaN();
    expect_refusal(not_finite, make_options(Criterion::D, 5), "finite");
}

}  // namespace
}  // namespace posewise
