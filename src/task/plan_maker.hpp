#pragma once

#include "planning_problem.hpp"

namespace posewise::detail {

/// Makes plans of any number of poses in one cell; pool, workspace and what they tell are made
/// once.
class PlanMaker {
  public:
    /// Draws pool and workspace. The options must outlive it. Throws InputError as make_plan().
    PlanMaker(PlanningProblem problem, const PlanningOptions& options);

    const PlanningProblem& problem() const { return problem_; }
    const Pool& pool() const { return pool_; }

    /// So many new poses.
    Planning make(Index pose_count) const;
    /// The same, but one start from a part of the pool, and no bounds: nearly as good in a tenth of
    /// the time.
    Planning make_quickly(Index pose_count) const;

  private:
    Planning make(PlanOptions search, Index pool_part) const;
    PlannedPoses search(const PlanOptions& search, Index pool_part) const;

    PlanningProblem problem_;
    const PlanningOptions& options_;
    Pool pool_;
    bool is_pool_complete_ = true;
};

}  // namespace posewise::detail
