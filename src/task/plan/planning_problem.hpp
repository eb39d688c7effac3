#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/task/planning.hpp"

namespace posewise::detail {

/// A planning problem stated from its inputs: what make_plan() solves and verify() judges by.
struct PlanningProblem {
    PlanRequest request;  ///< complete
    Campaign campaign;    ///< base and targets registered if only held measurements tell them
    Constraints constraints;
    PositionErrors errors;  ///< of target positions over the workspace
    RowMatrixXd workspace;  ///< configurations
    Index measured_count = 0;
    std::vector<std::string> measured_ids;
    std::vector<PlannedPose> kept;  ///< of the plan to repair
    std::vector<PlannedPose> kept_to_verify;
    PlanOptions search;  ///< without test poses, which are errors.by_parameters for G and V
};

/// New poses keep so far from those that could not be reached and, under a model error, from each
/// other; poses to verify from all others (some joint, rad; farther if the cell says so).
inline constexpr double distance_from_others = to_radians(5);

/// "camera.x_m": a number's name in a plan, with its SI unit if it has one.
std::string with_unit(const std::string& name, const AmountUnits& units);

/// The options that a plan was made with, to state its problem again: all of its poses are its own.
PlanningOptions options_of(const Plan& plan, const PlanningOptions& inputs);

/// All but pool and workspace; poses of a repaired plan are kept. Throws InputError as make_plan().
PlanningProblem state_planning(const Campaign& campaign, const PlanningOptions& options);

/// How many poses are new; completes the request. Throws InputError if that is none, or too few,
/// and where it is stopped.
void count_new_poses(PlanningProblem& problem, const StopSignal& stop);

/// The box that targets are in where the workspace is drawn, if one was stated.
std::optional<Box> workspace_box(const PlanRequest& request);

/// The workspace's configurations: drawn, unless `options` state them.
RowMatrixXd workspace_of(const PlanningProblem& problem, const PlanningOptions& options);
/// Fills in what errors are there.
void draw_workspace(PlanningProblem& problem, const PlanningOptions& options);

/// A pose at a configuration, with the targets that are seen there.
PlannedPose pose_at(const PlanningProblem& problem, std::string id, const VectorXd& configuration);

/// PlannedPose::clearance.
std::optional<Clearance> least_clearance(const PlanningProblem& problem,
                                         const VectorXd& configuration);

/// poses x targets.
Seen seen_at(const std::vector<PlannedPose>& poses, Index target_count);

/// Blocks of the targets that these poses show.
Blocks blocks_of(const PlanningProblem& problem, const std::vector<PlannedPose>& poses);

/// poses x joints.
RowMatrixXd configurations_of(const std::vector<PlannedPose>& poses, Index joint_count);

/// Information of what is held beside the poses of the plan, kept ones among them: of the prior and
/// of measured poses; zero if there is none.
MatrixXd held_information(const PlanningProblem& problem);

/// Value of the request's criterion for poses with these blocks, those held included.
double value_of(const PlanningProblem& problem, const Blocks& blocks);

/// Expected standard deviation of every parameter by the information matrix, m or rad.
std::vector<NamedNumber> standard_deviations(const Campaign& campaign, const MatrixXd& M);

/// The constraint that a pose does not meet, in words ("does not meet keep_out"), or the
/// target that it does not show or touch, though it says so; empty if it meets all, to rounding.
std::string describe_violation(const PlanningProblem& problem, const PlannedPose& pose);

}  // namespace posewise::detail
