#pragma once

#include "planning_problem.hpp"
#include "posewise/planner/tour.hpp"

namespace posewise::cli {

/// Expected standard deviation of every parameter by the information matrix, m or rad.
VectorXd standard_deviations(const Campaign& campaign, const MatrixXd& M);

/// What was found, how good it is, and the poses in visiting order.
void print_pose_plan(const PlanningProblem& problem, const io::PosePlanFile& file,
                     const Tour& tour);

/// Predicted accuracy for other numbers of poses, chosen from the pool (a part of it: an estimate).
void print_other_counts(const PlanningProblem& problem, const PredictedAccuracy& planned);

void print_deviations(const Campaign& campaign, const VectorXd& standard_deviations);

}  // namespace posewise::cli
