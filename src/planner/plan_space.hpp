#pragma once

#include "design_space.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::detail {

/// K continuous poses: starts from selection on the pool (the first on all of it, the others on
/// random parts), each refined by refine_poses() on one thread; the best kicked and refined again
/// until that gains nothing, then finished. The result does not depend on the number of threads.
/// `blocks` are those of `pool` (poses x joints, feasible). Throws InputError as select_poses(), or
/// if pool and blocks differ in count.
PlannedPoses plan_poses(const DesignSpace& space, const RowMatrixXd& pool, const Blocks& blocks,
                        const PlanOptions& options);

/// Its searched bound and the efficiency by that, for a plan that was made of all the same but
/// without them (options.bound_iterations 0).
void add_searched_bound(const DesignSpace& space, const RowMatrixXd& pool, const Blocks& blocks,
                        const PlanOptions& options, PlannedPoses& planned);

}  // namespace posewise::detail
