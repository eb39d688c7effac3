#include "objective.hpp"

#include <cmath>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/products.hpp"
#include "posewise/core/errors.hpp"
#include "prediction.hpp"
#include "regular.hpp"
#include "spectral.hpp"

namespace posewise::detail {
namespace {

/// The same objective on a matrix without nuisance.
Objective without_nuisance(Objective objective) {
    objective.nuisance.clear();
    return objective;
}

/// 1 / trace(M^-1), W = M^-1.
double inverse_trace(const MatrixXd& W, MatrixXd* slope) {
    const double value = 1 / W.trace();
    if (slope != nullptr) *slope = value * value * symmetric_gram(W);
    return value;
}

/// 1 / trace(T^T M^-1 T), W = M^-1. Only as a square of W T does the slope keep the digits that W
/// has: they are lost in (W T T^T) W, where T sees little of what W is large in.
double mean_prediction(const MatrixXd& T, const MatrixXd& W, MatrixXd* slope) {
    const RowMatrixXd TW = transposed_product(T, W);
    const double value = 1 / TW.cwiseProduct(T.transpose()).sum();
    if (slope != nullptr) *slope = value * value * symmetric_gram(TW);
    return value;
}

double worst_prediction(const Objective& objective, const Eigen::LLT<MatrixXd>& cholesky,
                        MatrixXd* slope) {
    const Sloped worst = worst_variance(objective, cholesky);
    const double value = 1 / worst.value;
    if (slope == nullptr) return value;
    const MatrixXd W = inverse(cholesky);
    const RowMatrixXd weighted = weighted_rows(*objective.test_poses, worst.slope);
    *slope = value * value * symmetric_gram(weighted * W);  // see mean_prediction()
    return value;
}

/// Criteria of single eigenvalues. Minus infinity, and the slope as it was, where the least is not
/// positive.
double of_eigenvalues(const Objective& objective, const MatrixXd& M, MatrixXd* slope) {
    const auto eigen = eigen_decomposition(
        M, slope == nullptr ? Eigen::EigenvaluesOnly : Eigen::ComputeEigenvectors);
    if (!(eigen.eigenvalues()[0] > 0)) return value_if_singular;
    const Sloped spectral = spectral_criterion(objective, eigen.eigenvalues());
    if (slope != nullptr) {
        *slope =
            eigen.eigenvectors() * spectral.slope.asDiagonal() * eigen.eigenvectors().transpose();
    }
    return spectral.value;
}

/// The criterion of a regular M without nuisance and, unless null, its slope.
double evaluate_regular(const Objective& objective, const MatrixXd& M,
                        const Eigen::LLT<MatrixXd>& cholesky, MatrixXd* slope) {
    switch (objective.criterion) {
        case Criterion::D:
        case Criterion::O1: {
            const Index L = M.rows();
            const double value = value_of_log_determinant(objective, log_determinant(cholesky), L);
            const double rate =
                is_logarithm(objective.criterion) ? 1 : value / (2.0 * static_cast<double>(L));
            if (slope != nullptr) *slope = rate * inverse(cholesky);
            return value;
        }
        case Criterion::A:
            return inverse_trace(inverse(cholesky), slope);
        case Criterion::V:
            return mean_prediction(objective.mean_test_root, inverse(cholesky), slope);
        case Criterion::G:
            return worst_prediction(objective, cholesky, slope);
        default:
            return of_eigenvalues(objective, M, slope);
    }
}

}  // namespace

Objective make_objective(Criterion criterion, Index pose_count, const Blocks* test_poses) {
    if (pose_count < 1) {
        throw InputError("pose count is " + std::to_string(pose_count) + ", must be at least 1");
    }
    Objective objective;
    objective.criterion = criterion;
    objective.pose_count = pose_count;
    if (!needs_test_poses(criterion)) return objective;
    if (test_poses == nullptr || test_poses->count() == 0) {
        throw InputError("criterion " + std::string(criterion_name(criterion)) +
                         " needs at least one test pose");
    }
    objective.test_poses = test_poses;
    if (criterion == Criterion::V) {
        objective.mean_test_root = lower_root_of_gram(test_poses->matrix) /
                                   std::sqrt(static_cast<double>(test_poses->count()));
    }
    return objective;
}

double evaluate(const Objective& objective, const MatrixXd& M) {
    if (!objective.nuisance.empty()) {
        return evaluate(without_nuisance(objective), eliminate(M, objective.nuisance).M);
    }
    const Eigen::LLT<MatrixXd> cholesky(M);
    if (!is_regular(cholesky, M)) return value_if_singular;
    return evaluate_regular(objective, M, cholesky, nullptr);
}

MatrixXd gradient(const Objective& objective, const MatrixXd& M, double* value) {
    MatrixXd slope = MatrixXd::Zero(M.rows(), M.cols());
    double result = value_if_singular;
    if (!objective.nuisance.empty()) {
        const Reduction reduced = eliminate(M, objective.nuisance);
        if (reduced.M.size() > 0) {
            slope = reduced.N * gradient(without_nuisance(objective), reduced.M, &result) *
                    reduced.N.transpose();
        }
    } else if (const Eigen::LLT<MatrixXd> cholesky(M); is_regular(cholesky, M)) {
        result = evaluate_regular(objective, M, cholesky, &slope);
    }
    if (value != nullptr) *value = result;
    return slope;
}

}  // namespace posewise::detail
