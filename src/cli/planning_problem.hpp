#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/io/campaign_file.hpp"
#include "posewise/io/pose_plan_file.hpp"
#include "posewise/planner/planning.hpp"
#include "posewise/planner/prediction.hpp"

namespace posewise::cli {

/// What the command line of `plan` says.
struct PlanningArguments {
    io::PosePlanRequest request;
    Index pose_count = 0;  ///< all together; 0: as many as the plan to repair has
    std::string criterion;
    std::optional<bool> prior;
    std::optional<std::uint64_t> seed;
};

/// A planning problem with all its files read, ready to be solved.
struct PlanningProblem {
    io::PosePlanRequest request;  ///< complete, defaults of the campaign filled in
    Campaign campaign;            ///< base and targets registered if only --augment tells them
    Constraints constraints;
    Pool pool;
    std::vector<io::ContinuousPose> kept;  ///< of the plan to repair
    Index measured_count = 0;              ///< poses of --augment
    Index workspace_count = 0;
    Blocks prediction;    ///< target positions over the workspace
    PlanOptions options;  ///< without test poses, which are `prediction` for G and V
};

/// Reads what the arguments name, draws pool and workspace; less of the pool if `stop` comes.
/// Throws InputError for files that cannot be used, or not together, and for a cell without a
/// feasible pose.
PlanningProblem read_planning_problem(const PlanningArguments& arguments, const StopSignal& stop);

/// The same but for the pool and the poses of a plan to repair: what a finished plan is judged by.
PlanningProblem state_planning_problem(const PlanningArguments& arguments);

/// Blocks of the targets that these poses state to show.
Blocks blocks_of(const PlanningProblem& problem, const std::vector<io::ContinuousPose>& poses);

/// The constraint that a pose does not meet, in words ("does not meet keep_out"); empty if it
/// meets all, to rounding.
std::string describe_violation(const Constraints& constraints, const VectorXd& q);

/// Targets a pose shows, from 0; all if the cell does not speak of sight.
std::vector<Index> visible_targets(const PlanningProblem& problem, const VectorXd& q);

}  // namespace posewise::cli
