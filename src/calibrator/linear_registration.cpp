#include "linear_registration.hpp"

#include <limits>
#include <numeric>

#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "posewise/core/random.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

constexpr Index of_rotation = 9;  // columns of A
constexpr double least_told = 1e-9;

using RowsOfRotation = Eigen::Matrix<double, of_rotation, 1>;

RowsOfRotation rows_of(const Matrix3d& X) { return X.transpose().reshaped(); }

/// |S rows_of(X) - d| is what remains of the equations with the best c and t for X.
struct RotationMisfit {
    MatrixXd S;
    VectorXd d;

    VectorXd residual(const Matrix3d& X) const { return S * rows_of(X) - d; }
    double operator()(const Matrix3d& X) const { return residual(X).squaredNorm(); }
};

RotationMisfit eliminate_the_rest(const RegistrationEquations& equations) {
    const auto& [A, b] = equations;
    const PivotedReflections rest(A.rightCols(A.cols() - of_rotation), least_told);
    MatrixXd of_both(A.rows(), of_rotation + 1);
    of_both << A.leftCols(of_rotation), b;
    const MatrixXd left = rest.outside(of_both);
    return {left.leftCols(of_rotation), left.col(of_rotation)};
}

/// The 24 rotations of a cube into itself: any rotation is within 63 deg of one.
std::vector<Matrix3d> rotations_of_a_cube() {
    std::vector<Matrix3d> rotations;
    const auto direction = [](int i) { return Vector3d((i < 3 ? 1 : -1) * Vector3d::Unit(i % 3)); };
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            if (i % 3 == j % 3) continue;
            Matrix3d R;
            R << direction(i), direction(j), direction(i).cross(direction(j));
            rotations.push_back(R);
        }
    }
    return rotations;
}

/// From X down to the nearest minimum, by steps X exp([phi]x) [Marquardt 1963].
Matrix3d descend(const RotationMisfit& misfit, Matrix3d X) {
    constexpr int most_steps = 100;
    double damping = 1e-3;
    double value = misfit(X);
    for (int step = 0; step < most_steps && damping < 1e9; ++step) {
        MatrixXd J(misfit.S.rows(), 3);
        for (Index axis = 0; axis < 3; ++axis) {
            J.col(axis) = misfit.S * rows_of(X * cross_matrix(Vector3d::Unit(axis)));
        }
        Matrix3d N = J.transpose() * J;
        N += damping * N.trace() * Matrix3d::Identity();
        const Vector3d phi = -N.ldlt().solve(J.transpose() * misfit.residual(X));
        const Matrix3d moved = X * rotation_from_vector(phi);
        const double moved_value = misfit(moved);
        const bool is_better = moved_value < value;
        damping *= is_better ? 0.1 : 10;
        if (!is_better) continue;
        X = moved;
        value = moved_value;
        if (phi.norm() < 1e-12) break;
    }
    return nearest_rotation(X);
}

VectorXd misses(const RegistrationEquations& equations, const RegistrationSolution& at) {
    VectorXd x(equations.A.cols());
    x << rows_of(at.X), at.c, at.t;
    return equations.A * x - equations.b;
}

RegistrationEquations part(const RegistrationEquations& equations, const std::vector<Index>& views,
                           Index of_each) {
    RegistrationEquations some{MatrixXd(of_each * std::ssize(views), equations.A.cols()),
                               VectorXd(of_each * std::ssize(views))};
    Index row = 0;
    for (const Index i : views) {
        some.A.middleRows(row, of_each) = equations.A.middleRows(of_each * i, of_each);
        some.b.segment(row, of_each) = equations.b.segment(of_each * i, of_each);
        row += of_each;
    }
    return some;
}

}  // namespace

std::optional<RegistrationSolution> solve_freely(const RegistrationEquations& equations) {
    const auto& [A, b] = equations;
    // Below it a millimetre in metres, as of noise and of errors of the robot, is not told from 0.
    const PivotedReflections factors(A, 1e-3);
    if (factors.rank() < A.cols()) return std::nullopt;
    const VectorXd solution = factors.solve(b);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> X(solution.data());
    return RegistrationSolution{nearest_rotation(X), solution.segment<3>(of_rotation),
                                solution.tail(A.cols() - of_rotation - 3)};
}

std::vector<Index> find_consistent(const RegistrationEquations& equations, Index of_each) {
    constexpr std::uint64_t seed = 8724;  // any: it only has to be the same every time
    constexpr std::uint64_t start_count = 60;
    constexpr Index few = 5;
    constexpr double far = 2.5;
    const Index count = equations.A.rows() / of_each;
    std::vector<Index> kept(static_cast<std::size_t>(count));
    std::iota(kept.begin(), kept.end(), Index{0});
    if (count < 2 * few) return kept;
    VectorXd best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](const std::vector<Index>& views) {
        const auto solution = solve_freely(part(equations, views, of_each));
        if (!solution) return;
        const VectorXd all = misses(equations, *solution).reshaped(of_each, count).colwise().norm();
        const double median = quantile(all, 0.5, QuantileRule::Upper);
        if (!(median < least)) return;
        least = median;
        best = all;
    };
    for (std::uint64_t start = 0; start < start_count; ++start) {
        consider(RandomStream(seed, start).subset(count, few));
    }
    for (int again = 0; again < 3 && best.size() > 0; ++again) {
        kept.clear();
        for (Index i = 0; i < count; ++i) {
            if (best[i] <= far * least) kept.push_back(i);
        }
        consider(kept);
    }
    return kept;
}

RegistrationSolution solve_for_rotation(const RegistrationEquations& equations) {
    const auto& [A, b] = equations;
    const RotationMisfit misfit = eliminate_the_rest(equations);
    Matrix3d best;
    double least = std::numeric_limits<double>::infinity();
    for (const Matrix3d& start : rotations_of_a_cube()) {
        const Matrix3d X = descend(misfit, start);
        if (misfit(X) >= least) continue;
        best = X;
        least = misfit(X);
    }
    const VectorXd solution =
        solve_with_least_norm(A.rightCols(A.cols() - of_rotation),
                              b - A.leftCols(of_rotation) * rows_of(best), least_told);
    return {best, solution.head<3>(), solution.tail(solution.size() - 3)};
}

}  // namespace posewise::detail
