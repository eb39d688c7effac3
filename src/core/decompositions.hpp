#pragma once

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <optional>

#include "posewise/core/types.hpp"

namespace posewise::detail {

// Eigen's decompositions, compiled in one file: each takes a compiler 5 to 15 seconds.

/// The R of A = Q R by reflections [Householder 1958], min(rows, cols) x cols.
MatrixXd triangular_factor(MatrixXd A);

/// Both: Q has min(rows, cols) columns.
struct OrthogonalFactors {
    MatrixXd Q;
    MatrixXd R;
};
OrthogonalFactors orthogonal_factors(const MatrixXd& A);

/// Factors A = Q R by reflections; the whole Q is applied, never formed.
class Reflections {
  public:
    Reflections() = default;
    explicit Reflections(const MatrixXd& A);
    /// min(rows, cols) x cols.
    const MatrixXd& R() const { return R_; }
    MatrixXd Q_times(const MatrixXd& X) const;
    MatrixXd Q_transposed_times(const MatrixXd& X) const;

  private:
    Eigen::HouseholderQR<MatrixXd> qr_;
    MatrixXd R_;
};

/// Factors A with pivoted columns: the next one is that of which those before leave most. A column
/// is dependent where they leave at most `threshold` of the largest.
class PivotedReflections {
  public:
    /// By default the threshold is that of rounding, as Eigen has it.
    explicit PivotedReflections(const MatrixXd& A, std::optional<double> threshold = std::nullopt);
    Index rank() const;
    /// X of least |A X - B|^2, with zeros for dependent columns.
    MatrixXd solve(const MatrixXd& B) const;
    /// What of B is outside the column space, in some orthonormal basis: (rows - rank) x cols.
    MatrixXd outside(const MatrixXd& B) const;
    /// An orthonormal basis of the column space: rows x rank.
    MatrixXd basis() const;

  private:
    Eigen::ColPivHouseholderQR<MatrixXd> qr_;
};

/// The R of many rows, some at a time, up to the signs of its rows.
MatrixXd triangular_factor_of_many(const RowMatrixXd& A);

/// Rows below rows; either may be empty.
RowMatrixXd stack(const RowMatrixXd& above, const RowMatrixXd& below);

/// The information R^T R of rows, `parameter_count` square; zeros without rows.
MatrixXd information_of(const RowMatrixXd& rows, Index parameter_count);

/// The columns of A, each over its norm; those of zeros as they are.
MatrixXd with_columns_of_norm_one(const MatrixXd& A);

/// Singular values of A, largest first, one for each column (zero beyond the rows), and the
/// directions they are of, in the columns of V.
struct SingularDirections {
    VectorXd values;
    MatrixXd V;
};
SingularDirections singular_directions(const MatrixXd& A);

/// Returns the singular values alone, min(rows, cols) of them.
VectorXd singular_values_of(const MatrixXd& A);

/// Inverts a regular square matrix.
MatrixXd inverse_of(const MatrixXd& A);

/// How many columns of A are independent, of norm 1 each: what is left of one beside those before
/// it, pivoted by reflections, exceeds 1e-10, well above rounding (about 1e-14) and free of units.
/// The rule for rows of an identification Jacobian: an information matrix A^T A, whose rounding is
/// that of the square, cannot tell.
Index count_independent_columns(const MatrixXd& A);

/// The X of least |A X - B|^2, for an A of full column rank.
VectorXd solve_least_squares(MatrixXd A, const VectorXd& b);
MatrixXd solve_least_squares(MatrixXd A, const MatrixXd& B);

/// Returns the shortest x of least |A x - b|^2; `threshold` as in PivotedReflections.
VectorXd solve_with_least_norm(const MatrixXd& A, const VectorXd& b, double threshold);

/// Eigenvalues of the symmetric M in ascending order, eigenvectors in columns.
Eigen::SelfAdjointEigenSolver<MatrixXd> eigen_decomposition(
    const MatrixXd& M, Eigen::DecompositionOptions options = Eigen::ComputeEigenvectors);

/// F with C = F F^T, for a positive semidefinite C.
MatrixXd root_of(const MatrixXd& C);

/// The lower triangular T with A^T A = T T^T, by the rows of A.
MatrixXd lower_root_of_gram(const RowMatrixXd& A);

}  // namespace posewise::detail
