#pragma once

#include "least_squares.hpp"

namespace posewise::detail {

/// A linearised system in information form: |J d - r|^2 = d^T M d - 2 g^T d + squares.
struct NormalEquations {
    MatrixXd M;  ///< L x L, lower half
    VectorXd g;  ///< L
    double squares;
};
NormalEquations normal_equations(const IdentificationProblem& problem,
                                 const LinearisedSystem& system);

/// Inverse of a symmetric positive definite M, its rows and columns first scaled to a diagonal
/// of 1.
class Metric {
  public:
    /// By the lower half of M.
    explicit Metric(const MatrixXd& M);

    /// Whether its columns are so far from dependent that rounding of M, which squares them, does
    /// not matter.
    bool is_regular() const;

    VectorXd solve(const VectorXd& g) const;

  private:
    VectorXd inverse_norms_;
    MatrixXd L_;  ///< empty where M is not positive definite
};

}  // namespace posewise::detail
