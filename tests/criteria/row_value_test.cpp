#include "../../src/criteria/row_value.hpp"

#include <gtest/gtest.h>

#include "support/designs.hpp"
#include "support/ill_conditioned.hpp"
#include "support/svd_reference.hpp"

namespace posewise {
namespace {

TEST(EvaluateRows, HasTheDigitsThatTheSingularValuesOfTheRowsHave) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        for (const double condition : {1.0, 1e3, 1e5, 1e8}) {
            const Blocks blocks = test::ill_conditioned_blocks(8, 3, 7, condition, seed);
            for (const Criterion criterion : all_criteria) {
                const auto reference = test::reference_value(criterion, blocks.matrix, 8, blocks);
                const double value = evaluate_rows(criterion, blocks.matrix, 8, &blocks);
                EXPECT_NEAR(value, reference.value, test::reference_tolerance(reference))
                    << criterion_name(criterion) << ' ' << condition;
            }
        }
    }
}

TEST(EvaluateRows, LeavesNuisanceOutAsTheInformationMatrixDoes) {
    const Blocks blocks = test::random_blocks(8, 3, 7, 1);
    for (const Criterion criterion :
         {Criterion::D, Criterion::A, Criterion::E, Criterion::O1, Criterion::O3, Criterion::O5}) {
        detail::Objective objective = detail::make_objective(criterion, 8);
        objective.nuisance = {1, 4};
        const double expected = evaluate(objective, information(blocks));
        EXPECT_NEAR(evaluate_rows(objective, blocks.matrix), expected, 1e-12 * std::abs(expected))
            << criterion_name(criterion);
    }
}

TEST(EvaluateRows, IsMinusInfinityForFewerRowsThanParametersHoweverTheyAreDrawn) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Blocks few = test::random_blocks(2, 3, 7, seed);
        const Blocks dependent = take(few, {0, 1, 0, 1});
        for (const Criterion criterion : all_criteria) {
            EXPECT_EQ(evaluate_rows(criterion, few.matrix, 2, &few), detail::value_if_singular);
            EXPECT_EQ(evaluate_rows(criterion, dependent.matrix, 4, &few),
                      detail::value_if_singular);
        }
    }
}

TEST(EvaluateRows, DoesNotDependOnTheUnitsOfParametersByDAndV) {
    const Blocks blocks = test::random_blocks(8, 3, 5, 3);
    Blocks scaled = blocks;
    VectorXd unit(5);
    unit << 1, 1e-9, 1e9, 1e-6, 1e12;
    scaled.matrix *= unit.asDiagonal();
    EXPECT_NEAR(evaluate_rows(Criterion::V, scaled.matrix, 8, &scaled),
                evaluate_rows(Criterion::V, blocks.matrix, 8, &blocks), 1e-12);
    EXPECT_NEAR(evaluate_rows(Criterion::D, scaled.matrix, 8),
                evaluate_rows(Criterion::D, blocks.matrix, 8) + 2 * unit.array().log().sum(),
                1e-10);
}

TEST(EvaluateRows, IsMinusInfinityForWhatIsNoNumber) {
    RowMatrixXd rows = RowMatrixXd::Identity(3, 3);
    rows(1, 1) = std::nan("");
    EXPECT_EQ(evaluate_rows(Criterion::D, rows, 1), detail::value_if_singular);
    rows(1, 1) = 0;
    EXPECT_EQ(evaluate_rows(Criterion::D, rows, 1), detail::value_if_singular);
}

}  // namespace
}  // namespace posewise
