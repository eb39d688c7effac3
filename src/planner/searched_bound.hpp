#pragma once

#include "posewise/selection/choice.hpp"
#include "refinement.hpp"

namespace posewise::detail {

/// Upper bound of the objective over all plans of as many continuous poses as `plan` has,
///     phi(M*) <= trace(Z H) + K max_q trace(B(q) Z B(q)^T), Z = supporting_matrix(M),
/// as far as the maximum over q is found: by gradient searches from the most sensitive of the first
/// of the pool (poses x joints, feasible, with their blocks) and of the poses met. A search, not a
/// proof. M is the optimum of the continuous relaxation over the poses met, at first those of
/// `plan` and those most sensitive at the relaxed optimum of its pool_choice; the maxima join them
/// and it is solved again, until what is found above it is small beside the bound's distance to the
/// plan, or `iterations` are over. `options` as for the choice from a pool. Infinity for O2 and O4.
double search_bound(const DesignSpace& space, const Objective& objective,
                    const SelectOptions& options, const PlannedPoses& plan, const RowMatrixXd& pool,
                    const Blocks& blocks, Index iterations, const StopSignal& stop = {});

}  // namespace posewise::detail
