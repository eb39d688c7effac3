#include "row_value.hpp"

#include <algorithm>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/products.hpp"
#include "core/sensitivities.hpp"
#include "spectral.hpp"

namespace posewise::detail {
namespace {

/// Columns in the order of elimination: nuisance first, those of interest from the last to the
/// first.
std::vector<Index> elimination_order(Index parameter_count, const std::vector<Index>& nuisance) {
    std::vector<Index> order = nuisance;
    for (Index i = parameter_count - 1; i >= 0; --i) {
        if (!std::binary_search(nuisance.begin(), nuisance.end(), i)) order.push_back(i);
    }
    return order;
}

/// The lower triangular L with M = L^T L of the parameters of interest, M the Schur complement of
/// the nuisance; empty if the rows do not identify all parameters.
MatrixXd lower_factor(const RowMatrixXd& stacked, const std::vector<Index>& nuisance) {
    const Index L = stacked.cols();
    if (stacked.rows() < L || L == 0 || !stacked.allFinite()) return {};
    const std::vector<Index> order = elimination_order(L, nuisance);
    const MatrixXd R = triangular_factor_of_many(stacked(Eigen::all, order));
    if (count_independent_columns(R) < L) return {};
    const Index interest = L - static_cast<Index>(nuisance.size());
    return R.bottomRightCorner(interest, interest).reverse();
}

/// Squares of the singular values of L by those of its inverse F, whose largest, the ones that
/// count, keep their digits.
VectorXd squared_singular_values(const MatrixXd& L, const MatrixXd& F) {
    VectorXd squares = singular_values(F).array().square().inverse().matrix();
    squares.tail(1) =
        eigen_decomposition(symmetric_gram(L), Eigen::EigenvaluesOnly).eigenvalues().tail(1);
    return squares;
}

double evaluate_factor(const Objective& objective, const MatrixXd& L) {
    if (objective.criterion == Criterion::D || objective.criterion == Criterion::O1) {
        const double root = L.diagonal().cwiseAbs().unaryExpr(&logarithm).sum();
        return value_of_log_determinant(objective, 2 * root, L.rows());
    }
    const MatrixXd F = invert_lower(L);
    switch (objective.criterion) {
        case Criterion::A:
            return 1 / F.squaredNorm();
        case Criterion::V:
            return 1 / (objective.mean_test_root.transpose() * F).squaredNorm();
        case Criterion::G:
            return 1 / root_sensitivities(*objective.test_poses, F).maxCoeff();
        default:
            return spectral_criterion(objective, squared_singular_values(L, F)).value;
    }
}

}  // namespace

double evaluate_rows(const Objective& objective, const RowMatrixXd& stacked) {
    const MatrixXd L = lower_factor(stacked, objective.nuisance);
    if (L.size() == 0) return value_if_singular;
    const double value = evaluate_factor(objective, L);
    return std::isfinite(value) ? value : value_if_singular;
}

}  // namespace posewise::detail
