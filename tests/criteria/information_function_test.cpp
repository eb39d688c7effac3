#include "../../src/criteria/information_function.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Index L = 5;

MatrixXd random_information(std::uint64_t seed) {
    return information(test::random_blocks(8, 2, L, seed));
}

/// The criterion's information function.
double phi(Objective objective, const MatrixXd& M) {
    objective.sharpness = infinity;
    return information_of_value(objective, evaluate(objective, M), L);
}

/// Every objective with an information function: with and without nuisance, sharp and smoothed.
template <typename Check>
void for_each_objective(const Check& check) {
    const Blocks test_poses = test::random_blocks(4, 2, L, 50);
    for (const Criterion criterion : all_criteria) {
        if (!has_information_function(criterion)) continue;
        for (const double sharpness : {infinity, 8.0}) {
            for (const std::vector<Index>& nuisance : {std::vector<Index>{}, {0, 3}}) {
                if (!nuisance.empty() && needs_test_poses(criterion)) continue;
                SCOPED_TRACE(std::string(criterion_name(criterion)) + ", sharpness " +
                             std::to_string(sharpness) + (nuisance.empty() ? "" : ", nuisance"));
                Objective objective = make_objective(criterion, 6, &test_poses);
                objective.sharpness = sharpness;
                objective.nuisance = nuisance;
                check(objective);
            }
        }
    }
}

TEST(InformationOfValue, IsOfDegreeOneAndHasAnInverse) {
    for_each_objective([](const Objective& objective) {
        const MatrixXd M = random_information(1);
        const double once = phi(objective, M);
        EXPECT_NEAR(phi(objective, 3 * M), 3 * once, 1e-11 * once);
        Objective exact = objective;
        exact.sharpness = infinity;
        const double value = evaluate(exact, M);
        EXPECT_NEAR(value_of_information(objective, once, L), value, 1e-12 * std::abs(value));
    });
}

TEST(SupportingMatrix, BoundsTheInformationFunctionEverywhere) {
    for_each_objective([](const Objective& objective) {
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const MatrixXd Z = supporting_matrix(objective, random_information(seed));
            EXPECT_TRUE(Z.isApprox(Z.transpose(), 1e-12));
            const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(Z, Eigen::EigenvaluesOnly);
            EXPECT_GE(eigen.eigenvalues()[0], -1e-12 * eigen.eigenvalues()[L - 1]);
            for (std::uint64_t other = 100; other < 120; ++other) {
                const MatrixXd M = random_information(other);
                EXPECT_LE(phi(objective, M), Z.cwiseProduct(M).sum() * (1 + 1e-12));
            }
        }
    });
}

TEST(SupportingMatrix, TouchesTheInformationFunctionWhereItIsMade) {
    for_each_objective([](const Objective& objective) {
        if (!is_smooth(objective.criterion) && std::isfinite(objective.sharpness)) return;
        const MatrixXd M = random_information(7);
        const double expected = phi(objective, M);
        EXPECT_NEAR(supporting_matrix(objective, M).cwiseProduct(M).sum(), expected,
                    1e-10 * expected);
    });
}

TEST(SupportingMatrix, HasItsKnownForms) {
    const MatrixXd M = random_information(3);
    const MatrixXd W = M.inverse();
    const auto matrix_of = [&](Criterion criterion) {
        return supporting_matrix(make_objective(criterion, 6), M);
    };
    const double root = std::pow(M.determinant(), 1.0 / L);
    EXPECT_TRUE(matrix_of(Criterion::D).isApprox(root / L * W, 1e-10));
    EXPECT_TRUE(matrix_of(Criterion::O1).isApprox(root / L * W, 1e-10));
    EXPECT_TRUE(matrix_of(Criterion::A).isApprox(W * W / (W.trace() * W.trace()), 1e-10));
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
    const VectorXd weakest = eigen.eigenvectors().col(0);
    EXPECT_TRUE(matrix_of(Criterion::E).isApprox(weakest * weakest.transpose(), 1e-10));
    EXPECT_TRUE(matrix_of(Criterion::O3).isApprox(weakest * weakest.transpose(), 1e-10));
}

TEST(SupportingMatrix, OfGIsThatOfTheWorstTestPose) {
    const Blocks test_poses = test::random_blocks(4, 2, L, 50);
    const MatrixXd M = random_information(3);
    const MatrixXd W = M.inverse();
    Index worst = 0;
    VectorXd variances(4);
    for (Index i = 0; i < 4; ++i) {
        variances[i] = (test_poses[i] * W * test_poses[i].transpose()).trace();
    }
    const double largest = variances.maxCoeff(&worst);
    const MatrixXd expected = W * test_poses[worst].transpose() * test_poses[worst] * W;
    EXPECT_TRUE(supporting_matrix(make_objective(Criterion::G, 6, &test_poses), M)
                    .isApprox(expected / (largest * largest), 1e-10));
}

}  // namespace
}  // namespace posewise
