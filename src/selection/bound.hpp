#pragma once

#include "../criteria/objective.hpp"
#include "posewise/selection/exchange.hpp"

namespace posewise::detail {

/// The objective that `options` ask for. Throws InputError for nuisance columns that do not exist,
/// are not ascending, are all columns, or come with G or V.
Objective make_objective(const Blocks& candidates, const SelectOptions& options);

/// The criterion's value of a choice, held information included.
double choice_value(const Blocks& candidates, const SelectOptions& options,
                    const std::vector<Index>& poses);

/// Upper bound of the objective over all choices the options allow, from any positive definite M.
/// With phi the information function of the criterion, H the held information and Z =
/// supporting_matrix(M),
///     phi(M*) <= trace(Z M*) <= trace(Z H) + the K largest trace(B_i Z B_i^T),
/// K largest within repeat and group limits. For D this is Kiefer's log det M + L log(S / L), for A
/// T^2 / S. O2 is bounded by a ratio of such sums along M's (softened) extreme eigenvectors, O4 by
/// O2 times O3. Infinity if M is not positive definite.
double upper_bound(const Blocks& candidates, const SelectOptions& options,
                   const Certificate& certificate);

/// In [0, 1]: the part of the best possible value that is proven reached; D by exp((value - bound)
/// / parameters), the others by value / bound. `parameter_count` is that of the interesting ones.
double efficiency(Criterion criterion, double value, double bound, Index parameter_count);

}  // namespace posewise::detail
