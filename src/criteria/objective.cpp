#include "posewise/criteria/objective.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr double minus_infinity = -std::numeric_limits<double>::infinity();

/// What is left of a column beyond those before it, relative to the column: below this it is
/// rounding. Free of the columns' scales.
constexpr double least_pivot = 1e-13;

bool is_regular(const Eigen::LLT<MatrixXd>& cholesky, const MatrixXd& M) {
    if (M.rows() == 0 || cholesky.info() != Eigen::Success) return false;
    const auto pivots = cholesky.matrixLLT().diagonal().array().square();
    return ((pivots > least_pivot * M.diagonal().array()) && pivots.isFinite()).all();
}

/// trace(B0 M^-1 B0^T) of every test pose.
VectorXd prediction_variances(const Blocks& test_poses, const Eigen::LLT<MatrixXd>& cholesky) {
    const MatrixXd whitened = cholesky.matrixL().solve(test_poses.matrix.transpose());
    VectorXd variances(test_poses.count());
    for (Index i = 0; i < test_poses.count(); ++i) {
        const Index first = test_poses.first_row[static_cast<std::size_t>(i)];
        variances[i] = whitened.middleCols(first, test_poses[i].rows()).squaredNorm();
    }
    return variances;
}

double log_determinant(const Eigen::LLT<MatrixXd>& cholesky) {
    return 2 * cholesky.matrixLLT().diagonal().array().log().sum();
}

MatrixXd inverse(const Eigen::LLT<MatrixXd>& cholesky) {
    return cholesky.solve(MatrixXd::Identity(cholesky.rows(), cholesky.cols()));
}

/// d/dM of 1 / trace(C M^-1).
MatrixXd weighted_trace_gradient(const MatrixXd& C, const MatrixXd& M_inverse) {
    const double trace = C.cwiseProduct(M_inverse).sum();
    return M_inverse * C * M_inverse / (trace * trace);
}

/// Gradients of criteria of the eigenvalues: sum of v f'(lambda) v^T.
MatrixXd spectral_gradient(Criterion criterion, const MatrixXd& M) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
    const VectorXd& lambda = eigen.eigenvalues();
    const Index last = lambda.size() - 1;
    const double least = lambda[0];
    const double largest = lambda[last];
    VectorXd slope = VectorXd::Zero(lambda.size());
    switch (criterion) {
        case Criterion::O2:  // sqrt(least / largest)
            slope[0] = 0.5 / std::sqrt(least * largest);
            slope[last] -= 0.5 * std::sqrt(least / largest) / largest;
            break;
        case Criterion::O3:  // sqrt(least)
            slope[0] = 0.5 / std::sqrt(least);
            break;
        case Criterion::O4:  // least / sqrt(largest)
            slope[0] = 1 / std::sqrt(largest);
            slope[last] -= 0.5 * least / (largest * std::sqrt(largest));
            break;
        case Criterion::O5: {  // 1 / sum lambda^(-1/2)
            const double sum = lambda.array().rsqrt().sum();
            slope = 0.5 * lambda.array().pow(-1.5) / (sum * sum);
            break;
        }
        default:  // E
            slope[0] = 1;
    }
    return eigen.eigenvectors() * slope.asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

Objective make_objective(Criterion criterion, Index pose_count, const Blocks* test_poses) {
    if (pose_count < 1) {
        throw InputError("pose count is " + std::to_string(pose_count) + ", must be at least 1");
    }
    Objective objective{criterion, pose_count, test_poses, {}};
    if (criterion != Criterion::G && criterion != Criterion::V) return objective;
    if (test_poses == nullptr || test_poses->count() == 0) {
        throw InputError("criterion " + std::string(criterion_name(criterion)) +
                         " needs at least one test pose");
    }
    if (criterion == Criterion::V) {
        objective.mean_test_information =
            information(*test_poses) / static_cast<double>(test_poses->count());
    }
    return objective;
}

double evaluate(const Objective& objective, const MatrixXd& M) {
    const Eigen::LLT<MatrixXd> cholesky(M);
    if (!is_regular(cholesky, M)) return minus_infinity;
    switch (objective.criterion) {
        case Criterion::D:
            return log_determinant(cholesky);
        case Criterion::O1:
            return std::exp(log_determinant(cholesky) / (2.0 * static_cast<double>(M.rows()))) /
                   std::sqrt(static_cast<double>(objective.pose_count));
        case Criterion::A:
            return 1 / inverse(cholesky).trace();
        case Criterion::V:
            return 1 / objective.mean_test_information.cwiseProduct(inverse(cholesky)).sum();
        case Criterion::G:
            return 1 / prediction_variances(*objective.test_poses, cholesky).maxCoeff();
        default: {
            const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M, Eigen::EigenvaluesOnly);
            const VectorXd singular = eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt();
            return evaluate(objective.criterion, singular, objective.pose_count);
        }
    }
}

MatrixXd gradient(const Objective& objective, const MatrixXd& M) {
    const double value = evaluate(objective, M);
    if (!std::isfinite(value)) return MatrixXd::Zero(M.rows(), M.cols());
    const Eigen::LLT<MatrixXd> cholesky(M);
    switch (objective.criterion) {
        case Criterion::D:
            return inverse(cholesky);
        case Criterion::O1:
            return value / (2.0 * static_cast<double>(M.rows())) * inverse(cholesky);
        case Criterion::A:
            return weighted_trace_gradient(MatrixXd::Identity(M.rows(), M.cols()),
                                           inverse(cholesky));
        case Criterion::V:
            return weighted_trace_gradient(objective.mean_test_information, inverse(cholesky));
        case Criterion::G: {
            Index worst = 0;
            prediction_variances(*objective.test_poses, cholesky).maxCoeff(&worst);
            return weighted_trace_gradient(information(*objective.test_poses, {worst}),
                                           inverse(cholesky));
        }
        default:
            return spectral_gradient(objective.criterion, M);
    }
}

}  // namespace posewise
