#pragma once

#include "refinement.hpp"

namespace posewise::detail {

/// Upper bound of the objective over all plans of `pose_count` continuous poses,
///     phi(M*) <= trace(Z H) + K max_q trace(B(q) Z B(q)^T), Z = supporting_matrix(M),
/// as far as the maximum over q is found: by gradient searches from the most sensitive of
/// `starts` (poses x joints, feasible). A search, not a proof. The bound is the least of those met
/// on the way from M towards the optimum of the continuous relaxation, one such pose after
/// another. Infinity for O2 and O4, or if M is not positive definite.
double search_bound(const DesignSpace& space, const Objective& objective, const HeldPoses& held,
                    Index pose_count, const MatrixXd& M, const RowMatrixXd& starts,
                    Index iterations, const StopSignal& stop = {});

}  // namespace posewise::detail
