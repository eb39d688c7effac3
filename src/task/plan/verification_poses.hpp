#pragma once

#include "planning_problem.hpp"

namespace posewise::detail {

/// Fills in Plan::verification: those of the plan that was repaired, and others drawn from the
/// feasible ones of a workspace that was stated, else from the pool.
void add_verification(const PlanningProblem& problem, const Pool& pool,
                      const PlanningOptions& options, Planning& planning);

/// How far poses to verify are from all others, joint_distance().
double verification_distance(const PlanningProblem& problem);

}  // namespace posewise::detail
