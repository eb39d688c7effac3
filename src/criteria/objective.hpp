#pragma once

#include <limits>

#include "posewise/criteria/criterion.hpp"

namespace posewise::detail {

/// A criterion where the parameters cannot be told apart.
constexpr double value_if_singular = -std::numeric_limits<double>::infinity();

/// A criterion made ready for many information matrices of one problem.
struct Objective {
    Criterion criterion = Criterion::D;
    Index pose_count = 1;                ///< m, for O1
    const Blocks* test_poses = nullptr;  ///< for G; the caller keeps them alive
    /// Lower triangular T with the mean of B0^T B0 over the test poses = T T^T, for V.
    MatrixXd mean_test_root;
    /// Parameters estimated along but of no interest (ascending): the criterion is that of the
    /// Schur complement of their block, so D becomes Ds.
    std::vector<Index> nuisance;
    /// Least and largest eigenvalue (or worst test pose) are replaced by power sums of this degree,
    /// which makes E, G, O2, O3 and O4 smooth: E becomes Kiefer's (sum lambda^-p)^(-1/p). Infinity:
    /// the criterion itself.
    double sharpness = std::numeric_limits<double>::infinity();
};

/// Throws InputError if pose_count is below 1, or for G and V without test poses.
Objective make_objective(Criterion criterion, Index pose_count, const Blocks* test_poses = nullptr);

/// The criterion of M (parameters square, symmetric). value_if_singular if M is
/// singular, not positive definite or not finite; never NaN.
double evaluate(const Objective& objective, const MatrixXd& M);

/// The symmetric matrix Z with d evaluate(M) = trace(Z dM); zero where evaluate() is not finite.
/// Where the least or largest eigenvalue (or the worst test pose) is not unique, one of the
/// supergradients. `value`, unless null, becomes evaluate(M) at hardly any further cost.
MatrixXd gradient(const Objective& objective, const MatrixXd& M, double* value = nullptr);

}  // namespace posewise::detail
