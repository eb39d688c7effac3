#pragma once

#include "posewise/criteria/objective.hpp"

namespace posewise {

/// Upper bound of the objective over all K-subsets of the candidates, from any positive definite
/// M. With phi the concave, degree-1 homogeneous form of the criterion (its information function
/// [Pukelsheim 1993, ch. 5]: det^(1/L) for D, the square for O3 and O5),
///     phi(M*) <= trace(phi'(M) M*) <= sum of the K largest trace(B_i phi'(M) B_i^T).
/// O2 is bounded by a ratio of such sums along M's extreme eigenvectors, O4 by O2 times O3.
/// Infinity if M is not positive definite.
double upper_bound(const Objective& objective, const Blocks& candidates, Index pose_count,
                   const MatrixXd& M);

/// The least of the bounds met on the way (`iterations` conditional-gradient steps) from M to the
/// optimum of the continuous relaxation, where the bound is tightest.
double tightened_bound(const Objective& objective, const Blocks& candidates, Index pose_count,
                       const MatrixXd& M, Index iterations);

/// In [0, 1]: the part of the best possible value that is proven reached; D by exp((value - bound)
/// / parameters), the others by value / bound.
double efficiency(Criterion criterion, double value, double bound, Index parameter_count);

}  // namespace posewise
