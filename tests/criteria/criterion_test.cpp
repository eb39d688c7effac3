#include "posewise/criteria/criterion.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>

#include "../../src/criteria/objective.hpp"
#include "posewise/core/errors.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

/// All that need no test poses.
constexpr std::array spectral = {Criterion::O1, Criterion::O2, Criterion::O3, Criterion::O4,
                                 Criterion::O5, Criterion::A,  Criterion::D,  Criterion::E};

TEST(Criterion, HasItsTextbookValuesForSingularValues421) {
    const VectorXd s = Vector3d(4, 2, 1);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::O1, s, 4), 1);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::O2, s, 4), 0.25);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::O3, s, 4), 1);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::O4, s, 4), 0.25);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::O5, s, 4), 4.0 / 7);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::A, s, 4), 16.0 / 21);
    EXPECT_DOUBLE_EQ(evaluate(Criterion::D, s, 4), std::log(64.0));
    EXPECT_DOUBLE_EQ(evaluate(Criterion::E, s, 4), 1);
}

TEST(Criterion, AgreesBetweenSingularValuesAndInformationMatrix) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const Blocks blocks = test::random_blocks(8, 3, 7, seed);
        const VectorXd s = singular_values(blocks.matrix);
        const MatrixXd M = information(blocks);
        for (const Criterion criterion : spectral) {
            const double expected = evaluate(criterion, s, 8);
            EXPECT_NEAR(evaluate(criterion, M, 8), expected, 1e-10 * std::abs(expected))
                << criterion_name(criterion);
        }
    }
}

TEST(Criterion, OfPredictionMatchesItsDefinition) {
    const Blocks blocks = test::random_blocks(8, 3, 5, 1);
    const Blocks test_poses = test::random_blocks(4, 2, 5, 2);
    const MatrixXd M = information(blocks);
    VectorXd variances(4);
    for (Index i = 0; i < 4; ++i) {
        variances[i] = (test_poses[i] * M.inverse() * test_poses[i].transpose()).trace();
    }
    EXPECT_NEAR(evaluate(Criterion::G, M, 8, &test_poses), 1 / variances.maxCoeff(), 1e-12);
    EXPECT_NEAR(evaluate(Criterion::V, M, 8, &test_poses), 1 / variances.mean(), 1e-12);
}

TEST(Criterion, ObeysTheInequalitiesOfTheObservabilityIndices) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const VectorXd s = singular_values(test::random_blocks(5, 3, 6, seed).matrix);
        const double L = 6;
        const double slack = 1 + 1e-12;
        const double o1 = evaluate(Criterion::O1, s, 5);
        const double o2 = evaluate(Criterion::O2, s, 5);
        const double o3 = evaluate(Criterion::O3, s, 5);
        const double o4 = evaluate(Criterion::O4, s, 5);
        const double o5 = evaluate(Criterion::O5, s, 5);
        const double trace = 1 / evaluate(Criterion::A, s, 5);
        EXPECT_NEAR(o4, o2 * o3, 1e-12 * o4);
        EXPECT_LE(o4, o3 * slack);
        EXPECT_LE(o3 / L, o5 * slack);
        EXPECT_LE(o5, o3 * slack);
        EXPECT_LE(o3, L * o5 * slack);
        EXPECT_LE(L * o5, std::sqrt(5.0) * o1 * slack);
        EXPECT_LE(std::sqrt(5.0) * o1, s[0] * slack);
        EXPECT_LE(1 / (L * o5 * o5), trace * slack);
        EXPECT_LE(trace, slack / (o5 * o5));
    }
}

TEST(Criterion, ScalesWithRepeatsAsItShould) {
    const Blocks once = test::random_blocks(6, 3, 7, 3);
    const Blocks thrice = take(once, {0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5});
    const auto ratio = [&](Criterion criterion) {
        return evaluate(criterion, information(thrice), 18) /
               evaluate(criterion, information(once), 6);
    };
    EXPECT_NEAR(ratio(Criterion::O1), 1, 1e-10);
    EXPECT_NEAR(ratio(Criterion::O2), 1, 1e-10);
    EXPECT_NEAR(ratio(Criterion::O3), std::sqrt(3.0), 1e-10);
    EXPECT_NEAR(ratio(Criterion::O4), std::sqrt(3.0), 1e-10);
    EXPECT_NEAR(ratio(Criterion::O5), std::sqrt(3.0), 1e-10);
    EXPECT_NEAR(ratio(Criterion::A), 3, 1e-10);
}

TEST(Criterion, O1RanksPlansTheSameInAnyUnits) {
    const VectorXd scale = VectorXd::LinSpaced(6, 0.001, 1000);
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        const MatrixXd M1 = information(test::random_blocks(5, 3, 6, 2 * seed));
        const MatrixXd M2 = information(test::random_blocks(5, 3, 6, 2 * seed + 1));
        const auto scaled = [&](const MatrixXd& M) -> MatrixXd {
            return scale.asDiagonal() * M * scale.asDiagonal();
        };
        const bool first_is_better =
            evaluate(Criterion::O1, M1, 5) > evaluate(Criterion::O1, M2, 5);
        EXPECT_EQ(evaluate(Criterion::O1, scaled(M1), 5) > evaluate(Criterion::O1, scaled(M2), 5),
                  first_is_better);
    }
}

TEST(Criterion, KnowsTheOptimalPlansOfThePlanarArm) {
    const Eigen::Vector2d two(1, 0.8);
    const Blocks pair = test::planar_arm_blocks(two, test::optimal_planar_angles(2, 2));
    EXPECT_NEAR(std::exp(evaluate(Criterion::D, information(pair), 2)), 10.24, 1e-12);
    EXPECT_NEAR(evaluate(Criterion::O1, information(pair), 2), 0.945742, 5e-7);
    const Vector3d three(1, 0.8, 0.5);
    for (const auto& [poses, determinant] : {std::pair{3, 116.64}, std::pair{4, 655.36}}) {
        const Blocks plan = test::planar_arm_blocks(three, test::optimal_planar_angles(3, poses));
        const MatrixXd M = information(plan);
        EXPECT_NEAR(std::exp(evaluate(Criterion::D, M, poses)), determinant, 1e-10);
        const MatrixXd covariance = M.inverse();
        EXPECT_TRUE(covariance.topLeftCorner(3, 3).isApprox(MatrixXd::Identity(3, 3) / poses));
        EXPECT_NEAR(covariance(4, 4), (1 / 0.64 + 1) / poses, 1e-12);
        EXPECT_NEAR(covariance(5, 5), (1 / 0.25 + 1 / 0.64) / poses, 1e-12);
    }
}

TEST(Criterion, IsMinusInfinityForEverySingularMatrix) {
    const Blocks test_poses = test::random_blocks(2, 1, 4, 1);
    const RowMatrixXd few = test::random_blocks(3, 1, 4, 2).matrix;
    MatrixXd not_a_number = MatrixXd::Identity(4, 4);
    not_a_number(2, 1) = not_a_number(1, 2) = std::numeric_limits<double>::quiet_NaN();
    MatrixXd indefinite = MatrixXd::Identity(4, 4);
    indefinite(3, 3) = -1;
    for (const MatrixXd& M : {MatrixXd(few.transpose() * few), MatrixXd(MatrixXd::Zero(4, 4)),
                              not_a_number, indefinite}) {
        for (const Criterion criterion : spectral) {
            EXPECT_EQ(evaluate(criterion, M, 3), detail::value_if_singular)
                << criterion_name(criterion);
        }
        EXPECT_EQ(evaluate(Criterion::G, M, 3, &test_poses), detail::value_if_singular);
        EXPECT_EQ(evaluate(Criterion::V, M, 3, &test_poses), detail::value_if_singular);
    }
    for (const Criterion criterion : spectral) {
        EXPECT_EQ(evaluate(criterion, singular_values(few), 3), detail::value_if_singular);
    }
}

TEST(Criterion, NamesRoundTrip) {
    for (const Criterion criterion : all_criteria) {
        EXPECT_EQ(parse_criterion(criterion_name(criterion)), criterion);
    }
    EXPECT_EQ(parse_criterion("O5"), Criterion::O5);
    EXPECT_EQ(parse_criterion("i"), Criterion::V);
    EXPECT_THROW(parse_criterion("o6"), InputError);
    EXPECT_THROW(parse_criterion(""), InputError);
}

TEST(Criterion, HasItsTraits) {
    Index smooth = 0;
    for (const Criterion criterion : all_criteria) {
        smooth += is_smooth(criterion);
        EXPECT_EQ(needs_test_poses(criterion),
                  criterion == Criterion::G || criterion == Criterion::V);
        EXPECT_EQ(is_logarithm(criterion), criterion == Criterion::D);
    }
    EXPECT_EQ(smooth, 5);  // all but E, G, O2, O3 and O4
}

TEST(Criterion, RefusesUnusableInput) {
    EXPECT_THROW(evaluate(Criterion::G, MatrixXd(MatrixXd::Identity(2, 2)), 1), InputError);
    EXPECT_THROW(evaluate(Criterion::V, VectorXd(VectorXd::Ones(2)), 1), InputError);
    EXPECT_THROW(evaluate(Criterion::O1, VectorXd(VectorXd::Ones(2)), 0), InputError);
    RowMatrixXd stacked = RowMatrixXd::Ones(3, 2);
    stacked(1, 1) = std::numeric_limits<double>::infinity();
    EXPECT_THROW(singular_values(stacked), InputError);
}

TEST(SingularValues, KeepTheirDigitsWhenSmallAndArePaddedWithZeros) {
    const MatrixXd U =
        Eigen::HouseholderQR<MatrixXd>(test::random_blocks(9, 1, 9, 1).matrix).householderQ();
    const VectorXd s = Vector3d(1, 1e-6, 1e-10);
    const RowMatrixXd tall = U.leftCols(3) * s.asDiagonal();
    EXPECT_TRUE(singular_values(tall).isApprox(s, 1e-14));
    EXPECT_NEAR(singular_values(tall)[2], 1e-10, 1e-16 * 10);
    const VectorXd wide = singular_values(RowMatrixXd::Ones(1, 4));
    EXPECT_TRUE(wide.isApprox(Eigen::Vector4d(2, 0, 0, 0)));
    EXPECT_EQ(singular_values(RowMatrixXd(0, 3)), VectorXd::Zero(3));
}

}  // namespace
}  // namespace posewise
