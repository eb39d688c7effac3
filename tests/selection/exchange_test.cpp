#include "posewise/selection/exchange.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "posewise/core/errors.hpp"
#include "posewise/criteria/objective.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

constexpr std::array all = {Criterion::O1, Criterion::O2, Criterion::O3, Criterion::O4,
                            Criterion::O5, Criterion::A,  Criterion::D,  Criterion::E,
                            Criterion::G,  Criterion::V};

SelectOptions make_options(Criterion criterion, Index pose_count) {
    SelectOptions options;
    options.criterion = criterion;
    options.pose_count = pose_count;
    return options;
}

std::string message_of(const Blocks& candidates, const SelectOptions& options) {
    try {
        select_poses(candidates, options);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(SelectByExchange, FindsTheBestSubsetOfASmallSet) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        const Index rows = 1 + static_cast<Index>(seed % 3);
        const Blocks candidates = test::random_blocks(12, rows, 4, seed);
        for (const Criterion criterion : all) {
            const Objective objective = make_objective(criterion, 5, &candidates);
            double best = -std::numeric_limits<double>::infinity();
            std::vector<Index> best_subset;
            test::for_each_subset(12, 5, [&](const std::vector<Index>& subset) {
                const double value = evaluate(objective, information(candidates, subset));
                if (value > best) {
                    best = value;
                    best_subset = subset;
                }
            });
            const Plan plan = select_poses(candidates, make_options(criterion, 5));
            EXPECT_NEAR(plan.value, best, 1e-12 * std::abs(best)) << criterion_name(criterion);
            EXPECT_EQ(plan.poses, best_subset) << criterion_name(criterion);
            EXPECT_GE(plan.bound, plan.value);
            EXPECT_GT(plan.efficiency, 0);
            EXPECT_LE(plan.efficiency, 1);
            EXPECT_GE(plan.starts_at_best, 1);
            EXPECT_EQ(plan.stop_reason, StopReason::Converged);
        }
    }
}

TEST(SelectByExchange, FindsTheOptimalPlanOfThePlanarArm) {
    RowMatrixXd angles = RowMatrixXd::Zero(24, 2);
    angles.col(1).setLinSpaced(0, 2 * std::numbers::pi * 23 / 24);
    const Blocks candidates = test::planar_arm_blocks(Eigen::Vector2d(1, 0.8), angles);
    const Plan plan = select_poses(candidates, make_options(Criterion::D, 2));
    EXPECT_NEAR(std::exp(plan.value), 10.24, 1e-12);
    EXPECT_EQ(plan.poses[1] - plan.poses[0], 12);
    EXPECT_NEAR(plan.efficiency, 1, 1e-9);
}

TEST(SelectByExchange, GivesTheSamePlanForAnyNumberOfThreads) {
    const Blocks candidates = test::random_blocks(60, 3, 9, 5);
    const int threads = omp_get_max_threads();
    for (const Criterion criterion : {Criterion::D, Criterion::O3, Criterion::V}) {
        omp_set_num_threads(1);
        const Plan serial = select_poses(candidates, make_options(criterion, 8));
        omp_set_num_threads(2);
        const Plan parallel = select_poses(candidates, make_options(criterion, 8));
        EXPECT_EQ(serial.poses, parallel.poses);
        EXPECT_EQ(serial.value, parallel.value);
        EXPECT_EQ(serial.bound, parallel.bound);
        EXPECT_EQ(serial.starts_at_best, parallel.starts_at_best);
    }
    omp_set_num_threads(threads);
}

TEST(SelectByExchange, FindsThePosesThatJustIdentifyTheParameters) {
    // Only poses 3 and 7 see the last parameter: two of twelve rows.
    RowMatrixXd matrix = test::random_blocks(12, 1, 4, 9).matrix;
    for (const Index row : {0, 1, 2, 4, 5, 6, 8, 9, 10, 11}) matrix(row, 3) = 0;
    const Blocks candidates = make_equal_blocks(matrix, 1);
    const Plan plan = select_poses(candidates, make_options(Criterion::E, 4));
    EXPECT_TRUE(std::isfinite(plan.value));
}

TEST(SelectByExchange, RefusesUnusableInput) {
    const Blocks candidates = test::random_blocks(6, 1, 4, 1);
    EXPECT_NE(message_of(candidates, make_options(Criterion::D, 7)).find("pose count is 7"),
              std::string::npos);
    EXPECT_NE(message_of(candidates, make_options(Criterion::D, 0)), "");
    EXPECT_NE(message_of(candidates, make_options(Criterion::D, 3)).find("more poses"),
              std::string::npos);
    SelectOptions options = make_options(Criterion::D, 5);
    options.starts = 0;
    EXPECT_NE(message_of(candidates, options), "");
    Blocks blind = candidates;
    blind.matrix.col(2) = blind.matrix.col(1);
    blind.matrix.col(3).setZero();
    EXPECT_NE(message_of(blind, make_options(Criterion::D, 5)).find("2 of 4"), std::string::npos);
    Blocks not_finite = candidates;
    not_finite.matrix(1, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(message_of(not_finite, make_options(Criterion::D, 5)), "");
}

}  // namespace
}  // namespace posewise
