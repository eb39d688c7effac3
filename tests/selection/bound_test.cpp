#include "posewise/selection/bound.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "support/designs.hpp"

namespace posewise {
namespace {

constexpr std::array all = {Criterion::O1, Criterion::O2, Criterion::O3, Criterion::O4,
                            Criterion::O5, Criterion::A,  Criterion::D,  Criterion::E,
                            Criterion::G,  Criterion::V};

double best_value(const Objective& objective, const Blocks& candidates, Index k) {
    double best = -std::numeric_limits<double>::infinity();
    test::for_each_subset(candidates.count(), k, [&](const std::vector<Index>& subset) {
        best = std::max(best, evaluate(objective, information(candidates, subset)));
    });
    return best;
}

TEST(UpperBound, IsNeverBelowTheBestSubset) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const Blocks candidates = test::random_blocks(9, 1 + static_cast<Index>(seed % 3), 4, seed);
        const Index k = 4 + static_cast<Index>(seed % 2);
        const MatrixXd chosen = information(take(candidates, {0, 2, 4, 6, 8}));
        const MatrixXd other = information(test::random_blocks(9, 1, 4, 1000 + seed));
        for (const Criterion criterion : all) {
            const Objective objective = make_objective(criterion, k, &candidates);
            const double best = best_value(objective, candidates, k);
            for (const MatrixXd& M : {chosen, other, information(candidates)}) {
                const double bound = upper_bound(objective, candidates, k, M);
                EXPECT_GE(bound, best - 1e-10 * std::abs(best)) << criterion_name(criterion);
            }
            const double tightened = tightened_bound(objective, candidates, k, chosen, 30);
            EXPECT_GE(tightened, best - 1e-10 * std::abs(best)) << criterion_name(criterion);
            EXPECT_LE(tightened, upper_bound(objective, candidates, k, chosen));
        }
    }
}

TEST(UpperBound, IsTheValueItselfAtTheOptimumOfThePlanarArm) {
    const Blocks plan =
        test::planar_arm_blocks(Eigen::Vector2d(1, 0.8), test::optimal_planar_angles(2, 6));
    for (const Criterion criterion : {Criterion::D, Criterion::O1}) {
        const Objective objective = make_objective(criterion, 6);
        const double value = evaluate(objective, information(plan));
        EXPECT_NEAR(upper_bound(objective, plan, 6, information(plan)), value, 1e-12);
    }
}

TEST(UpperBound, IsInfiniteWhereTheMatrixIsSingular) {
    const Blocks candidates = test::random_blocks(9, 1, 4, 1);
    for (const Criterion criterion : all) {
        const Objective objective = make_objective(criterion, 4, &candidates);
        EXPECT_EQ(upper_bound(objective, candidates, 4, MatrixXd::Zero(4, 4)),
                  std::numeric_limits<double>::infinity());
    }
}

TEST(Efficiency, IsAFractionForEveryCriterion) {
    EXPECT_DOUBLE_EQ(efficiency(Criterion::D, std::log(8.0), std::log(64.0), 3), 0.5);
    EXPECT_DOUBLE_EQ(efficiency(Criterion::A, 1, 4, 3), 0.25);
    EXPECT_EQ(efficiency(Criterion::D, 1, std::numeric_limits<double>::infinity(), 3), 0);
    EXPECT_EQ(efficiency(Criterion::D, -std::numeric_limits<double>::infinity(), 1, 3), 0);
}

}  // namespace
}  // namespace posewise
