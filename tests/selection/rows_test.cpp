#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../src/core/decompositions.hpp"
#include "../../src/selection/bound.hpp"
#include "posewise/selection/choice.hpp"
#include "support/ill_conditioned.hpp"
#include "support/svd_reference.hpp"
#include "support/sweep.hpp"

/// Choices against singular values of their rows, where information matrices have lost the digits.
namespace posewise {
namespace {

using namespace detail;

struct Problem {
    Blocks candidates;
    SelectOptions options;
    double condition = 1;
};

/// Condition numbers to 1e8, near duplicates, priors, groups and repeats, by the seed.
Problem make_problem(std::uint64_t seed) {
    RandomStream random(seed, 7);
    const Index L = 3 + random.index(4);
    const Index rows = 1 + random.index(3);
    const Index count = 8 + random.index(3);
    Problem problem;
    problem.condition = std::pow(10.0, random.uniform(0, 8));
    problem.candidates = test::ill_conditioned_blocks(count, rows, L, problem.condition, seed);
    RowMatrixXd& matrix = problem.candidates.matrix;
    if (random.index(2) == 0) {  // near duplicates
        const double apart = std::pow(10.0, random.uniform(-12, -3));
        matrix.bottomRows(3 * rows) = (1 + apart * random.normal()) * matrix.topRows(3 * rows);
        matrix.bottomRows(3 * rows)(0, 0) += apart;
    }
    SelectOptions& options = problem.options;
    options.pose_count = std::max<Index>(2, (L + rows - 1) / rows + random.index(2));
    options.starts = 2;
    if (random.index(3) == 0) {
        options.held_rows = random.uniform(0.01, 1) * RowMatrixXd::Identity(L, L);
        if (random.index(2) == 0) options.held_rows.conservativeResize(L - 1, L);
    }
    if (random.index(3) == 0) options.repeat_limit = 2;
    if (random.index(3) == 0) {
        for (Index i = 0; i < count; ++i) options.groups.push_back(i % 4);
        options.group_limit = 2;
    }
    return problem;
}

test::RowReference reference_of(const Problem& problem, const std::vector<Index>& poses) {
    return test::reference_value(
        problem.options.criterion,
        stack(problem.options.held_rows, take(problem.candidates, poses).matrix),
        problem.options.pose_count, problem.candidates);
}

/// The largest value of all choices.
test::RowReference best_of_all(const Problem& problem) {
    test::RowReference best;
    test::for_each_choice(problem.candidates.count(), problem.options,
                          [&](const std::vector<Index>& poses) {
                              const auto one = reference_of(problem, poses);
                              if (one.value > best.value) best = one;
                          });
    return best;
}

void expect_true(const Problem& problem) {
    const Choice choice = select_poses(problem.candidates, problem.options);
    const test::RowReference best = best_of_all(problem);
    if (choice.ending == Ending::NotIdentifiable) {
        EXPECT_GT(best.condition, 1e8) << choice.undetermined;
        return;
    }
    const test::RowReference chosen = reference_of(problem, choice.poses);
    // Choices that differ by less than 1e-12 of their values are the same to a search.
    const double rounding = test::reference_tolerance(best) + 2e-12 * std::abs(best.value);
    EXPECT_NEAR(choice.value, chosen.value, test::reference_tolerance(chosen));
    EXPECT_GE(choice.bound, best.value - rounding);
    if (choice.ending == Ending::Optimal) {
        EXPECT_GE(chosen.value, best.value - rounding - 1e-9 * std::abs(best.value));
    }
    const double certified = upper_bound(problem.candidates, problem.options, choice.certificate);
    EXPECT_GE(certified, best.value - rounding);
}

TEST(SelectByRows, WhatIsOptimalAndEveryBoundAreTrueBySingularValuesOfTheRows) {
    const Index problems = std::max<Index>(5, testing::sweep_count() / 100);
    for (Index k = 0; k < problems; ++k) {
        Problem problem = make_problem(static_cast<std::uint64_t>(k));
        for (const Criterion criterion : all_criteria) {
            problem.options.criterion = criterion;
            SCOPED_TRACE(::testing::Message()
                         << "problem " << k << ", criterion " << criterion_name(criterion)
                         << ", condition " << problem.condition);
            expect_true(problem);
        }
    }
}

/// 39 x 7 standard normals, three rows each: two blocks have six rows, whose rounding a search over
/// all pairs makes look like a seventh.
TEST(SelectByRows, TakesNothingBelowTheCountOfRows) {
    for (Index k = 0; k < testing::sweep_count(); ++k) {
        const auto seed = static_cast<std::uint64_t>(k);
        const Blocks candidates = test::random_blocks(13, 3, 7, seed);
        SelectOptions options;
        options.criterion = all_criteria[static_cast<std::size_t>(k) % all_criteria.size()];
        options.pose_count = 1 + k % 2;
        options.repeat_limit = 1 + k % 3;
        const Choice choice = select_poses(candidates, options);
        EXPECT_EQ(choice.ending, Ending::NotIdentifiable);
        EXPECT_TRUE(choice.poses.empty());
        EXPECT_NE(choice.undetermined.find("must be at least 3: "), std::string::npos)
            << choice.undetermined;
    }
}

TEST(SelectByRows, SaysHowManyRowsThereAreAndWhatIsHeld) {
    const Blocks candidates = test::random_blocks(13, 3, 7, 1);
    SelectOptions options;
    options.pose_count = 1;
    options.held_rows = RowMatrixXd::Identity(2, 7);
    EXPECT_EQ(
        select_poses(candidates, options).undetermined,
        "pose count is 1, must be at least 2: 1 pose has 3 rows beside 2 held, fewer than the "
        "7 parameters");
    options.held_rows = RowMatrixXd::Identity(4, 7);
    EXPECT_EQ(select_poses(candidates, options).poses.size(), 1U);
    options.held_rows.resize(0, 0);
    options.repeat_limit = 5;  // a candidate taken again tells nothing new
    EXPECT_EQ(
        select_poses(candidates, options).undetermined,
        "pose count is 1, must be at least 3: 1 pose has 3 rows, fewer than the 7 parameters; "
        "or state a prior");
}

/// Enough rows, but each block's three are of one direction: only seven different blocks identify.
TEST(SelectByRows, TakesNoRowsThatAreDependent) {
    for (Index k = 0; k < std::max<Index>(20, testing::sweep_count() / 20); ++k) {
        const auto seed = static_cast<std::uint64_t>(k);
        const Blocks directions = test::random_blocks(12, 1, 7, seed);
        RowMatrixXd rows(36, 7);
        for (Index i = 0; i < 36; ++i) {
            rows.row(i) = (1 + static_cast<double>(i % 3)) / 3 * directions.matrix.row(i / 3);
        }
        SelectOptions options;
        options.criterion = all_criteria[static_cast<std::size_t>(k) % all_criteria.size()];
        options.repeat_limit = 3;
        options.pose_count = 6;
        options.starts = 2;
        const Blocks candidates = make_equal_blocks(rows, 3);
        EXPECT_EQ(select_poses(candidates, options).ending, Ending::NotIdentifiable);
        options.pose_count = 7;
        EXPECT_EQ(select_poses(candidates, options).poses.size(), 7U);
    }
}

}  // namespace
}  // namespace posewise
