#pragma once

#include <Eigen/Cholesky>

#include "core/elementary.hpp"
#include "core/products.hpp"

namespace posewise::detail {

/// Whether M is positive definite beyond rounding. What is left of a column after those before it,
/// relative to the column, must exceed 1e-13: free of the columns' scales.
inline bool is_regular(const Eigen::LLT<MatrixXd>& cholesky, const MatrixXd& M) {
    if (M.rows() == 0 || cholesky.info() != Eigen::Success) return false;
    const auto pivots = cholesky.matrixLLT().diagonal().array().square();
    return ((pivots > 1e-13 * M.diagonal().array()) && pivots.isFinite()).all();
}

inline double log_determinant(const Eigen::LLT<MatrixXd>& cholesky) {
    return 2 * cholesky.matrixLLT().diagonal().unaryExpr(&logarithm).sum();
}

inline MatrixXd inverse(const Eigen::LLT<MatrixXd>& cholesky) {
    return symmetric_gram(invert_lower(cholesky.matrixLLT()));
}

/// What an information matrix says about the parameters of interest: the Schur complement of the
/// nuisance block, N^T M N with N = [I; -M22^-1 M21]. Both are empty if M is singular.
struct Reduction {
    MatrixXd N;
    MatrixXd M;
};
Reduction eliminate(const MatrixXd& M, const std::vector<Index>& nuisance);

}  // namespace posewise::detail
