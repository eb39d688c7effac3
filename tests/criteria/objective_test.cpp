#include "../../src/criteria/objective.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "posewise/core/errors.hpp"
#include "support/derivative_check.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr double limit = std::numeric_limits<double>::infinity();

/// The objective over M + sum_k x_k direction_k, checked against its gradient there.
void expect_gradient(const Objective& objective, std::uint64_t seed) {
    const MatrixXd M = information(test::random_blocks(7, 3, 6, seed));
    std::vector<MatrixXd> directions;
    MatrixXd J(1, 8);
    const MatrixXd Z = gradient(objective, M);
    for (Index k = 0; k < J.cols(); ++k) {
        const auto item = 1000 * (seed + 1) + static_cast<std::uint64_t>(k);
        const RowMatrixXd noise = test::random_blocks(6, 1, 6, item).matrix;
        directions.push_back(0.05 * (noise + noise.transpose()));
        J(0, k) = Z.cwiseProduct(directions.back()).sum();
    }
    const auto value = [&](const VectorXd& x) -> VectorXd {
        MatrixXd moved = M;
        for (Index k = 0; k < x.size(); ++k)
            moved += x[k] * directions[static_cast<std::size_t>(k)];
        return VectorXd::Constant(1, evaluate(objective, moved));
    };
    testing::expect_is_jacobian(J, value, VectorXd::Zero(J.cols()));
    EXPECT_TRUE(Z.isApprox(Z.transpose(), 1e-12));
}

TEST(Objective, GradientOfEveryCriterionAgreesWithDifferences) {
    const Blocks test_poses = test::random_blocks(5, 2, 6, 100);
    for (const Criterion criterion : all_criteria) {
        for (const double sharpness : {limit, 6.0, 30.0}) {
            for (const std::vector<Index>& nuisance : {std::vector<Index>{}, {1, 4}}) {
                if (!nuisance.empty() && needs_test_poses(criterion)) continue;
                Objective objective = make_objective(criterion, 7, &test_poses);
                objective.sharpness = sharpness;
                objective.nuisance = nuisance;
                for (std::uint64_t seed = 0; seed < 5; ++seed) {
                    SCOPED_TRACE(std::string(criterion_name(criterion)) + ", sharpness " +
                                 std::to_string(sharpness) +
                                 (nuisance.empty() ? "" : ", nuisance"));
                    expect_gradient(objective, seed);
                }
            }
        }
    }
}

TEST(Objective, TheGradientGivesTheValueAsEvaluateDoes) {
    const Blocks test_poses = test::random_blocks(5, 2, 6, 100);
    const MatrixXd M = information(test::random_blocks(7, 3, 6, 1));
    for (const Criterion criterion : all_criteria) {
        const Objective objective = make_objective(criterion, 7, &test_poses);
        double value = 0;
        gradient(objective, M, &value);
        EXPECT_NEAR(value, evaluate(objective, M), 1e-12 * std::abs(value));
    }
}

TEST(Objective, SmoothingApproachesTheCriterionItself) {
    const Blocks test_poses = test::random_blocks(5, 2, 6, 100);
    const MatrixXd M = information(test::random_blocks(7, 3, 6, 2));
    for (const Criterion criterion : all_criteria) {
        Objective objective = make_objective(criterion, 7, &test_poses);
        const double exact = evaluate(objective, M);
        double last = limit;
        for (const double sharpness : {4.0, 64.0, 1024.0}) {
            objective.sharpness = sharpness;
            const double error = std::abs(evaluate(objective, M) - exact);
            if (is_smooth(criterion)) {
                EXPECT_EQ(error, 0) << criterion_name(criterion);
            } else {
                EXPECT_LE(error, 0.5 * last) << criterion_name(criterion);
                EXPECT_LE(error, 4 / sharpness * exact) << criterion_name(criterion);
            }
            last = error;
        }
    }
}

TEST(Objective, GradientIsZeroWhereTheMatrixIsSingular) {
    const Blocks test_poses = test::random_blocks(5, 2, 3, 100);
    for (const Criterion criterion : all_criteria) {
        const Objective objective = make_objective(criterion, 1, &test_poses);
        EXPECT_EQ(gradient(objective, MatrixXd::Zero(3, 3)), MatrixXd::Zero(3, 3));
    }
}

TEST(Objective, SensitivitiesOfTheDeterminantAddUpToTheParameterCount) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Blocks plan = test::random_blocks(6, 3, 8, seed);
        const MatrixXd Z = gradient(make_objective(Criterion::D, 6), information(plan));
        double sum = 0;
        for (Index i = 0; i < plan.count(); ++i) sum += (plan[i] * Z * plan[i].transpose()).trace();
        EXPECT_NEAR(sum, 8, 1e-10);
    }
}

TEST(Objective, OfInterestIsSingularWhereTheNuisanceExplainsAllButRounding) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const Blocks one_row = test::random_blocks(1, 1, 3, seed);
        Objective objective = make_objective(Criterion::D, 1);
        objective.nuisance = {1};
        EXPECT_EQ(evaluate(objective, information(one_row, {0, 0})), -limit);
    }
}

TEST(Objective, RefusesUnusableInput) {
    const Blocks none;
    EXPECT_THROW(make_objective(Criterion::D, 0), InputError);
    EXPECT_THROW(make_objective(Criterion::V, 1), InputError);
    EXPECT_THROW(make_objective(Criterion::G, 1, &none), InputError);
}

}  // namespace
}  // namespace posewise
