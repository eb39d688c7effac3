#pragma once

#include "criteria/objective.hpp"
#include "posewise/selection/choice.hpp"

namespace posewise::detail {

/// Throws InputError for a criterion that cannot leave columns out of account: G, V, O2 and O4.
void check_takes_nuisance(Criterion criterion);

/// The objective that `options` ask for. Throws InputError for nuisance columns that do not exist,
/// are not ascending, are all columns, or come with G or V.
Objective make_objective(const Blocks& candidates, const SelectOptions& options);

/// The criterion's value of a choice by its stacked rows, those held included: what is stated and
/// what verifies it. Minus infinity where they do not identify the parameters.
double choice_value(const Blocks& candidates, const SelectOptions& options,
                    const std::vector<Index>& poses);

/// Upper bound of the objective over all choices the options allow, from any positive definite M.
/// With phi the information function of the criterion, H the held information and Z =
/// supporting_matrix(M),
///     phi(M*) <= trace(Z M*) <= trace(Z H) + the K largest trace(B_i Z B_i^T),
/// K largest within repeat and group limits. For D this is Kiefer's log det M + L log(S / L), for A
/// T^2 / S. O2 is bounded by a ratio of such sums along M's (softened) extreme eigenvectors, O4 by
/// O2 times O3. Above that by what rounding may take from it (bound_rounding()). Infinity if M is
/// not positive definite, or so nearly that rounding leaves nothing to prove.
double upper_bound(const Blocks& candidates, const SelectOptions& options,
                   const Certificate& certificate);

/// Relative rounding of the information function's bound from M: some rounding of numbers times
/// the condition number of M, for criteria of eigenvalues as it is, for others of M with columns
/// scaled (by the sum of variance inflation factors M_ii (M^-1)_ii, which is no less than that over
/// the number of columns). Infinity if M is not positive definite.
double bound_rounding(Criterion criterion, const MatrixXd& M);

/// In [0, 1]: the part of the best possible value that is proven reached; D by exp((value - bound)
/// / parameters), the others by value / bound. `parameter_count` is that of the interesting ones.
double efficiency(Criterion criterion, double value, double bound, Index parameter_count);

}  // namespace posewise::detail
