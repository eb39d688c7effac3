#include "posewise/criteria/objective.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "prediction.hpp"
#include "regular.hpp"
#include "spectral.hpp"

namespace posewise {
namespace {

constexpr double minus_infinity = -std::numeric_limits<double>::infinity();

double log_determinant(const Eigen::LLT<MatrixXd>& cholesky) {
    return 2 * cholesky.matrixLLT().diagonal().array().log().sum();
}

/// The same objective on a matrix without nuisance.
Objective without_nuisance(Objective objective) {
    objective.nuisance.clear();
    return objective;
}

}  // namespace

Objective make_objective(Criterion criterion, Index pose_count, const Blocks* test_poses) {
    if (pose_count < 1) {
        throw InputError("pose count is " + std::to_string(pose_count) + ", must be at least 1");
    }
    Objective objective;
    objective.criterion = criterion;
    objective.pose_count = pose_count;
    if (criterion != Criterion::G && criterion != Criterion::V) return objective;
    if (test_poses == nullptr || test_poses->count() == 0) {
        throw InputError("criterion " + std::string(criterion_name(criterion)) +
                         " needs at least one test pose");
    }
    objective.test_poses = test_poses;
    if (criterion == Criterion::V) {
        objective.mean_test_information =
            information(*test_poses) / static_cast<double>(test_poses->count());
    }
    return objective;
}

double evaluate(const Objective& objective, const MatrixXd& M) {
    if (!objective.nuisance.empty()) {
        return evaluate(without_nuisance(objective), eliminate(M, objective.nuisance).M);
    }
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
            return 1 / worst_variance(objective, cholesky).value;
        default: {
            const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M, Eigen::EigenvaluesOnly);
            if (!(eigen.eigenvalues()[0] > 0)) return minus_infinity;
            return spectral_criterion(objective, eigen.eigenvalues()).value;
        }
    }
}

MatrixXd gradient(const Objective& objective, const MatrixXd& M, double* value) {
    const MatrixXd none = MatrixXd::Zero(M.rows(), M.cols());
    double ignored = 0;
    double& result = value != nullptr ? *value : ignored;
    result = minus_infinity;
    if (!objective.nuisance.empty()) {
        const Reduction reduced = eliminate(M, objective.nuisance);
        if (reduced.M.size() == 0) return none;
        return reduced.N * gradient(without_nuisance(objective), reduced.M, &result) *
               reduced.N.transpose();
    }
    const Eigen::LLT<MatrixXd> cholesky(M);
    if (!is_regular(cholesky, M)) return none;
    const auto by_trace = [&](const MatrixXd& C) -> MatrixXd {
        const MatrixXd W = inverse(cholesky);
        result = 1 / C.cwiseProduct(W).sum();
        return result * result * W * C * W;
    };
    switch (objective.criterion) {
        case Criterion::D:
            result = log_determinant(cholesky);
            return inverse(cholesky);
        case Criterion::O1:
            result = evaluate(objective, M);
            return result / (2.0 * static_cast<double>(M.rows())) * inverse(cholesky);
        case Criterion::A:
            return by_trace(MatrixXd::Identity(M.rows(), M.cols()));
        case Criterion::V:
            return by_trace(objective.mean_test_information);
        case Criterion::G: {
            const Sloped worst = worst_variance(objective, cholesky);
            const MatrixXd W = inverse(cholesky);
            result = 1 / worst.value;
            return result * result * W * weighted_information(*objective.test_poses, worst.slope) *
                   W;
        }
        default: {
            const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
            if (!(eigen.eigenvalues()[0] > 0)) return none;
            const Sloped spectral = spectral_criterion(objective, eigen.eigenvalues());
            result = spectral.value;
            return eigen.eigenvectors() * spectral.slope.asDiagonal() *
                   eigen.eigenvectors().transpose();
        }
    }
}

}  // namespace posewise
