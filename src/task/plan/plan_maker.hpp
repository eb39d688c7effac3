#pragma once

#include <functional>
#include <optional>

#include "planner/design_space.hpp"
#include "planning_problem.hpp"

namespace posewise::detail {

/// Fills in what follows from a planning's plan, information and tour: prediction, budget, missing
/// poses, how long it takes.
void conclude(Planning& planning, const PlanningProblem& problem, Index drop_out_count);

struct CampaignTime {
    double total = 0;                         ///< s: moves, standstills and what is done by hand
    bool is_target_changed_at_poses = false;  ///< see Plan
    Index target_runs = 1;                    ///< likewise
};
/// `moves`: of one run through all poses, s. `is_seen`: poses x targets, at least one of each pose.
CampaignTime campaign_time(const PlanningProblem& problem, double moves, const Seen& is_seen);

/// Plan::value_rms of that value.
std::optional<double> value_rms_of(const PlanningProblem& problem, double value);

/// Makes plans of any number of poses in one cell; pool, workspace and what they tell are made
/// once.
class PlanMaker {
  public:
    /// Draws pool and workspace. The options must outlive it. Throws InputError as make_plan().
    PlanMaker(PlanningProblem problem, const PlanningOptions& options);

    const PlanningProblem& problem() const { return problem_; }
    const Pool& pool() const { return pool_; }

    /// So many new poses, with a searched bound if `needs_bound` says so: it takes longer than the
    /// rest.
    Planning make(Index pose_count, const std::function<bool(const Planning&)>& needs_bound) const;
    /// The same, but one start from a part of the pool, and no bounds: nearly as good in a tenth of
    /// the time.
    Planning make_quickly(Index pose_count) const;

    /// Draws the poses to verify, see Plan::verification; the plan's others stay as they are.
    void add_verification(Planning& planning) const;

  private:
    /// Candidates of a search.
    struct Candidates {
        DesignSpace space;
        RowMatrixXd configurations;
        Blocks blocks;
    };
    Candidates candidates(Index pool_part) const;
    /// Without a bound.
    PlanOptions search_for(Index pose_count) const;
    /// Plans. Poses that are nearly alike share what the model lacks, which the information takes
    /// as independent: a plan that has some is made again with a least distance, if the pool allows
    /// it.
    PlannedPoses plan_apart(Candidates& from, const PlanOptions& search) const;
    Ending ending_of(const PlannedPoses& planned) const;
    Planning finish(PlanOptions search, const PlannedPoses& planned) const;
    /// Accuracy by poses of the pool, whose blocks these are.
    PredictedAccuracy predict_choice(const std::vector<Index>& poses, const Blocks& blocks) const;

    PlanningProblem problem_;
    const PlanningOptions& options_;
    Pool pool_;
    bool is_pool_complete_ = true;
};

}  // namespace posewise::detail
