#pragma once

#include "posewise/core/blocks.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/plan.hpp"

namespace posewise {

/// Samples per configuration, on average: the repeats that selection assumes.
double mean_repeats(const Measurements& measurements);

/// Configurations of a robot to choose from.
struct Candidates {
    CandidateKind kind = CandidateKind::Configurations;
    std::vector<std::string> ids;
    RowMatrixXd configurations;  ///< candidates x joints (and measured torques), rad or m
    RowMatrixXd share;           ///< share of each one's samples that show each target, 0 to 1
    /// What was observed there, for kind Measurements.
    std::optional<Measurements> measured;
    std::optional<std::uint64_t> seed{};  ///< that random ones were drawn with
};
Candidates measured_candidates(Measurements measured);
/// Candidates named 0, 1, ..., from a scrambled Halton sequence within the joint limits: those that
/// the campaign's cell allows, with the targets seen there. Throws InputError if hardly any is
/// allowed.
Candidates random_candidates(const Campaign& campaign, Index count, std::uint64_t seed);

/// What is asked for, further inputs besides the candidates, and when to stop.
struct ChoiceOptions : PlanRequest {
    std::optional<Measurements> held{};  ///< measured already: their information counts
    RowMatrixXd test_poses{};            ///< configurations for G and V; empty: the candidates
    std::vector<Index> groups{};         ///< label of each candidate; empty: none
    /// For plain blocks, in place of `held`. Rows after the last block are known, too, but are no
    /// pose's: those of a prior.
    Blocks held_blocks{};
    Blocks test_blocks{};
    /// For measured candidates: judges the calibration with all of them.
    JudgeCalibration judge = refuse_faults;
    StopSignal stop{};  ///< ends the search with the best so far
    ProgressCallback progress{};
};

/// Chooses the most informative candidates, with a proven bound. Base and targets are registered
/// from measured candidates, else as the campaign states them, else registered from held
/// measurements. Of random candidates only those are used whose blocks can be made in half of the
/// available time; Plan::candidate_count says how many. Throws InputError as select_poses(), for
/// ids that are not among the candidates, if base or targets are known from nowhere, and for
/// measured candidates that are no calibration (ChoiceOptions::judge).
Plan choose(const Campaign& campaign, Candidates candidates, const ChoiceOptions& options);

/// As above for plain blocks, named 0, 1, ..., without a robot.
Plan choose(Blocks candidates, const ChoiceOptions& options);

/// A stored plan that choose() made from these inputs, with its predictions. Throws InputError as
/// choose().
Plan judge_again(const Plan& plan, const Campaign& campaign, Candidates candidates,
                 const ChoiceOptions& options);

/// A candidate and how often to measure it, if that could be any number.
struct WeightedCandidate {
    std::string id;
    double weight = 0;  ///< above 0, at most PlanRequest::repeat_limit
};

/// Weights instead of a choice, an approximate design [Fedorov 1972]: the continuous relaxation of
/// choosing as many poses as the weights sum to.
struct ApproximateDesign {
    std::string campaign;                    ///< its name; empty: plain blocks
    PlanRequest request;                     ///< complete
    Index candidate_count = 0;               ///< candidates to weight
    std::vector<WeightedCandidate> weights;  ///< heaviest first, candidates of weight 0 left out
    double value = 0;                        ///< criterion value for the weighted information
    double bound = 0;       ///< proven: no weights, hence no choice of poses, have a larger value
    double efficiency = 0;  ///< value against the bound, see Choice::efficiency
    Ending ending = Ending::NotRun;
};

/// The most informative weights, from the inputs of choose(). Throws InputError as it does, and for
/// what weights cannot keep: groups and a least distance.
ApproximateDesign relax_choice(const Campaign& campaign, Candidates candidates,
                               const ChoiceOptions& options);
ApproximateDesign relax_choice(Blocks candidates, const ChoiceOptions& options);

}  // namespace posewise
