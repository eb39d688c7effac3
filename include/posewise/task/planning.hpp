#pragma once

#include "posewise/core/progress.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/planner/assurance.hpp"
#include "posewise/planner/planning.hpp"
#include "posewise/task/plan.hpp"

namespace posewise {

/// What is asked for, what there is besides the campaign, and when to stop.
struct PlanningOptions : PlanRequest {
    explicit PlanningOptions(Index poses = 0) {
        pose_count = poses;
        criterion = Criterion::V;
        repeats = 1;
    }
    std::optional<Measurements> held;  ///< measured already: their information counts
    std::optional<Plan> repaired;      ///< its poses are kept, but for those dropped
    RowMatrixXd workspace;     ///< configurations where accuracy matters; empty: drawn in the cell
    Index drop_out_count = 1;  ///< poses that may be missing, see Planning::drop_outs
    StopSignal stop{};         ///< ends the search with the best so far
    ProgressCallback progress{};
};

/// A plan, and what became of its making.
struct Planning {
    Plan plan;
    Pool pool;
    Tour tour;
    Index measured_count = 0;     ///< poses measured already
    Index workspace_count = 0;    ///< configurations the prediction is over
    Campaign campaign;            ///< base and targets registered if only held poses tell them
    PositionErrors errors;        ///< of target positions over the workspace
    PlanOptions search;           ///< criterion, new poses, nuisance and what was held
    MatrixXd information;         ///< of all poses and what is held (scaled parameters)
    InformationByNoise by_noise;  ///< of all poses
    ErrorBudget budget;
    std::vector<DropOut> without_each;  ///< each pose of the plan missing, in its order
    std::vector<DropOut>
        drop_outs;        ///< poses of the plan that hurt most, missing one after another
    double duration = 0;  ///< s: all moves, and the cell's dwell for each sample
};

/// Proposes configurations to measure in the campaign's cell: draws a pool, chooses from it,
/// refines each pose continuously and orders the poses for a quick tour. Half of the time there is
/// goes to the pool at most. Throws InputError for a cell without a feasible pose, for kept poses
/// that cannot be measured, for fewer poses than identify the parameters, and as plan_poses().
Planning make_plan(const Campaign& campaign, const PlanningOptions& options);

/// A plan that make_plan() made with these options and that was kept: what it predicts, what the
/// error consists of and what each pose is worth. Of the pool nothing is known, of the tour its
/// time. Throws InputError as make_plan(), and where the poses do not identify the parameters.
Planning judge_again(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);

/// Predicted accuracy of a number of new poses.
struct CountAccuracy {
    Index pose_count = 0;
    bool is_planned = false;  ///< as planned; else chosen from a part of the pool: an estimate
    /// Nothing: too few to identify the parameters, or more than the pool has.
    std::optional<PredictedAccuracy> accuracy;
};

/// Of half, as many and twice as many new poses as were planned, by count; after a stop of those
/// that are known by then.
std::vector<CountAccuracy> predict_other_counts(const Planning& planning,
                                                const StopSignal& stop = {});

}  // namespace posewise
