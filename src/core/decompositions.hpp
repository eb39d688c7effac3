#pragma once

#include <Eigen/Eigenvalues>

#include "posewise/core/types.hpp"

namespace posewise::detail {

// Eigen's decompositions that several files need, compiled in one.

/// The R of A = Q R by reflections [Householder 1958], min(rows, cols) x cols.
MatrixXd triangular_factor(MatrixXd A);

/// The X of least |A X - B|^2, for an A of full column rank.
VectorXd solve_least_squares(MatrixXd A, const VectorXd& b);
MatrixXd solve_least_squares(MatrixXd A, const MatrixXd& B);

/// Eigenvalues of the symmetric M in ascending order, eigenvectors in columns.
Eigen::SelfAdjointEigenSolver<MatrixXd> eigen_decomposition(
    const MatrixXd& M, Eigen::DecompositionOptions options = Eigen::ComputeEigenvectors);

/// F with C = F F^T, for a positive semidefinite C.
MatrixXd root_of(const MatrixXd& C);

/// The same, lower triangular.
MatrixXd lower_root_of(const MatrixXd& C);

}  // namespace posewise::detail
