#include "posewise/criteria/objective.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

constexpr std::array all = {Criterion::O1, Criterion::O2, Criterion::O3, Criterion::O4,
                            Criterion::O5, Criterion::A,  Criterion::D,  Criterion::E,
                            Criterion::G,  Criterion::V};

TEST(Objective, GradientAgreesWithCentralDifferences) {
    const Blocks test_poses = test::random_blocks(5, 2, 6, 100);
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const MatrixXd M = information(test::random_blocks(7, 3, 6, seed));
        const RowMatrixXd noise = test::random_blocks(6, 1, 6, 1000 + seed).matrix;
        const MatrixXd direction = noise + noise.transpose();
        for (const Criterion criterion : all) {
            const Objective objective = make_objective(criterion, 7, &test_poses);
            const double step = 1e-5;
            const double difference = (evaluate(objective, M + step * direction) -
                                       evaluate(objective, M - step * direction)) /
                                      (2 * step);
            const double derivative = gradient(objective, M).cwiseProduct(direction).sum();
            EXPECT_NEAR(derivative, difference, 1e-6 * std::max(1e-2, std::abs(derivative)))
                << criterion_name(criterion);
        }
    }
}

TEST(Objective, GradientIsZeroWhereTheMatrixIsSingular) {
    const Blocks test_poses = test::random_blocks(5, 2, 3, 100);
    for (const Criterion criterion : all) {
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
        EXPECT_EQ(evaluate(objective, information(one_row, {0, 0})),
                  -std::numeric_limits<double>::infinity());
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
