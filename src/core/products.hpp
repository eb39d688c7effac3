#pragma once

#include "posewise/core/types.hpp"

namespace posewise::detail {

// Products and factors of dense matrices in the widest vectors that the machine has. Each number is
// one sum in the order of the rows, whatever their width and the caches are.

/// A^T A, its lower half; zero above.
MatrixXd gram(const Eigen::Ref<const RowMatrixXd>& A);

/// The same, M^T = M.
MatrixXd symmetric_gram(const Eigen::Ref<const RowMatrixXd>& A);

/// `columns` rounded up to whole vectors: transposed_product() does not copy a B of that width.
Index whole_columns(Index columns);
/// A^T B.
RowMatrixXd transposed_product(const Eigen::Ref<const RowMatrixXd>& A,
                               const Eigen::Ref<const RowMatrixXd>& B);

/// The L of M = L L^T, zero above its diagonal, by the lower half of M; empty if M is not positive
/// definite.
MatrixXd cholesky(const MatrixXd& M);

/// L^-1 B, L the lower half of a square matrix.
RowMatrixXd solve_lower(const MatrixXd& L, const Eigen::Ref<const RowMatrixXd>& B);

/// L^-1, L the lower half of a square matrix.
RowMatrixXd invert_lower(const MatrixXd& L);

}  // namespace posewise::detail
