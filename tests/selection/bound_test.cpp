#include "../../src/selection/bound.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "posewise/core/errors.hpp"
#include "support/designs.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr double infinity = std::numeric_limits<double>::infinity();

double best_value(const Blocks& candidates, const SelectOptions& options) {
    double best = -infinity;
    test::for_each_choice(candidates.count(), options, [&](const std::vector<Index>& poses) {
        best = std::max(best, choice_value(candidates, options, poses));
    });
    return best;
}

/// A random problem: block height, prior, repeats, groups and nuisance vary with the seed.
SelectOptions random_options(const Blocks& candidates, std::uint64_t seed) {
    RandomStream random(seed, 1);
    const Index L = candidates.parameter_count();
    SelectOptions options;
    options.pose_count = 2 + random.index(3);
    if (random.index(2) == 0) options.held_rows = random.uniform(0, 1.4) * MatrixXd::Identity(L, L);
    options.repeat_limit = 1 + random.index(3);
    if (random.index(3) == 0) {
        for (Index i = 0; i < candidates.count(); ++i) options.groups.push_back(i % 3);
        options.group_limit = 2;
    }
    if (random.index(3) == 0) options.excluded = {0, 3};
    return options;
}

TEST(UpperBound, IsNeverBelowTheBestChoice) {
    for (Index problem = 0; problem < testing::sweep_count(); ++problem) {
        const auto seed = static_cast<std::uint64_t>(problem);
        const Blocks candidates = test::random_blocks(7, 1 + problem % 3, 3, seed);
        SelectOptions options = random_options(candidates, seed);
        options.criterion = all_criteria[static_cast<std::size_t>(problem) % all_criteria.size()];
        const bool may_have_nuisance = options.criterion == Criterion::D ||
                                       options.criterion == Criterion::A ||
                                       options.criterion == Criterion::E;
        if (may_have_nuisance && problem % 4 == 0) options.nuisance = {1};
        const double best = best_value(candidates, options);
        if (!std::isfinite(best)) continue;
        SCOPED_TRACE(problem);
        options.starts = 1;
        const MatrixXd M = information(test::random_blocks(7, 1, 3, 1000 + seed));
        for (const Certificate& certificate :
             {Certificate{M, 2.0}, Certificate{M, 30.0}, Certificate{M, infinity},
              select_poses(candidates, options).certificate}) {
            EXPECT_GE(upper_bound(candidates, options, certificate), best - 1e-10 * std::abs(best))
                << criterion_name(options.criterion) << ", problem " << problem;
        }
    }
}

TEST(UpperBound, IsTheValueItselfAtTheOptimumOfThePlanarArm) {
    const Blocks plan =
        test::planar_arm_blocks(Eigen::Vector2d(1, 0.8), test::optimal_planar_angles(2, 6));
    for (const Criterion criterion : {Criterion::D, Criterion::O1}) {
        SelectOptions options;
        options.criterion = criterion;
        options.pose_count = 6;
        const double value = choice_value(plan, options, {0, 1, 2, 3, 4, 5});
        EXPECT_NEAR(upper_bound(plan, options, {information(plan)}), value, 1e-12);
    }
}

TEST(UpperBound, IsInfiniteWhereTheMatrixIsSingular) {
    const Blocks candidates = test::random_blocks(9, 1, 4, 1);
    for (const Criterion criterion : all_criteria) {
        SelectOptions options;
        options.criterion = criterion;
        options.pose_count = 4;
        EXPECT_EQ(upper_bound(candidates, options, {MatrixXd::Zero(4, 4)}), infinity);
    }
}

TEST(Objective, RefusesNuisanceThatMakesNoSense) {
    const Blocks candidates = test::random_blocks(9, 1, 3, 1);
    SelectOptions options;
    options.pose_count = 4;
    for (const std::vector<Index>& nuisance :
         {std::vector<Index>{3}, {-1}, {1, 0}, {1, 1}, {0, 1, 2}}) {
        options.nuisance = nuisance;
        EXPECT_THROW(make_objective(candidates, options), InputError);
    }
    options.nuisance = {0};
    for (const Criterion criterion : {Criterion::G, Criterion::V, Criterion::O2, Criterion::O4}) {
        options.criterion = criterion;
        EXPECT_THROW(make_objective(candidates, options), InputError);
    }
}

TEST(Efficiency, IsAFractionForEveryCriterion) {
    EXPECT_DOUBLE_EQ(efficiency(Criterion::D, std::log(8.0), std::log(64.0), 3), 0.5);
    EXPECT_DOUBLE_EQ(efficiency(Criterion::A, 1, 4, 3), 0.25);
    EXPECT_EQ(efficiency(Criterion::D, 1, infinity, 3), 0);
    EXPECT_EQ(efficiency(Criterion::D, -infinity, 1, 3), 0);
}

}  // namespace
}  // namespace posewise
