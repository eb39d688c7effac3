#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/cell.hpp"
#include "posewise/planner/planning.hpp"
#include "posewise/selection/choice.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise {

/// What a plan was made from.
enum class CandidateKind {
    Measurements,    ///< measured configurations; base and targets registered from them
    Configurations,  ///< a list of configurations
    Random,          ///< scrambled Halton sequence within the joint limits
    Blocks,          ///< plain blocks, no robot
    Pool,            ///< what a cell allows, without a grid: configurations are continuous
};

/// Sources of a plan's inputs, as stated by whoever had them: mostly paths. For messages, and to
/// find them again; empty where there were none.
struct PlanSources {
    std::string campaign;
    std::string estimate;  ///< an earlier one, applied to the campaign by with_earlier()
    std::string candidates;
    Index rows_per_block = 0;  ///< for plain blocks
    std::string variable;      ///< for plain blocks in a .mat or .npz file; empty: the first
    std::string augment;       ///< poses measured already
    std::string test_poses;
    std::string groups;
    std::string repaired;  ///< the plan that was repaired
    std::string workspace;
    std::string measured_plan;  ///< of a list of points: the plan whose poses were measured
    std::string points_unit;    ///< of the list, if it does not state it
};

/// A criterion, or none stated.
struct CriterionChoice : std::optional<Criterion> {
    using std::optional<Criterion>::optional;
    /// Throws std::bad_optional_access where none is stated.
    operator Criterion() const { return value(); }
};

/// What is asked for, in numbers and words. With the same inputs it restates a plan's problem.
struct PlanRequest {
    /// Nothing: the campaign's for choose(), V for make_plan(), D for plain blocks; D instead of V
    /// if base and targets do not count.
    CriterionChoice criterion{};
    Index pose_count = 0;  ///< K, must be stated; includes kept poses of a repair
    /// Whether the expected errors are also the prior standard deviations. For plain blocks; a
    /// campaign has ParameterSpread::is_prior.
    bool has_prior = false;
    Focus focus = Focus::All;
    double repeats = 0;  ///< samples per configuration; 0: as in measured candidates, or 1
    /// Independent searches; 0: the search's default. In a plan: those that ended.
    Index starts = 0;
    std::optional<std::uint64_t> seed{};  ///< for all draws; nothing: the campaign's, or 1
    PlanSources sources{};
    EarlierUse earlier{};  ///< how the estimate was used, if there was one

    // For choose().
    Index group_limit = 0;                ///< most poses from one group; 0: any number
    std::vector<std::string> excluded{};  ///< ids not to choose
    Index repeat_limit = 1;               ///< how often one candidate may be chosen
    double least_distance = 0;      ///< rad, Euclidean over revolute joints, between any two chosen
    std::optional<double> proof{};  ///< like SelectOptions::proof

    // For make_plan().
    std::vector<std::string> dropped{};  ///< ids of the repaired plan that could not be reached
    Index workspace_count = 500;         ///< configurations drawn for the workspace
    /// Least x, y, z, then largest, of targets in drawn configurations; empty: the cell's boxes.
    std::vector<double> workspace_box_mm{};
    Index workspace_target = 0;  ///< the target that counts, from 1; 0: all
    Index pool_count = 20000;    ///< candidates drawn
    /// Verification poses to draw, see Plan::verification. 0: as many as a repaired plan has.
    Index verification_count = 0;
    /// Poses are visited in a random order whose moves take at most this many times as long as the
    /// shortest order's, so that what drifts is not taken for a matter of place; 0: in the
    /// shortest.
    double random_order = 0;
    double time_limit = 0;  ///< s, as stated; 0: none
};

/// Fills in criterion and seed where none is stated.
void complete(PlanRequest& request, Criterion usual, std::uint64_t seed = 1);

/// One pose to measure.
struct PlannedPose {
    std::string id;
    VectorXd configuration;      ///< rad, m, and N m of measured torques; empty for plain blocks
    Index times = 1;             ///< how often to measure it; above 1 if repeats are allowed
    std::vector<Index> targets;  ///< targets it shows, from 0; empty: not stated
    std::optional<VectorXd> via = {};  ///< configuration to pass first
    bool is_blocked = false;           ///< no free way to it was found
    bool is_kept = false;              ///< from the repaired plan
    /// For continuous plans: the least there, for the nominal robot; nothing: not stated.
    std::optional<Clearance> clearance = {};
};

/// A number whose name ends with its unit, if it has one.
struct NamedNumber {
    std::string name;
    double value = 0;
};

/// What to measure and how good that is: the result of choose() and make_plan(), what a plan file
/// holds and verify() checks.
struct Plan {
    std::string campaign;              ///< its name; empty: plain blocks
    std::vector<std::string> columns;  ///< like "q1_rad", "lift_m", "tau_q2_Nm"
    std::vector<PlannedPose> poses;    ///< if continuous: in visiting order
    PlanRequest request;               ///< complete, with defaults filled in
    double value = -std::numeric_limits<double>::infinity();  ///< value of the criterion
    /// The value in other words, if it is that of V or G and only positions are predicted: RMS
    /// position error due to the parameters over the test poses (G: at the worst), m. Not in files.
    std::optional<double> value_rms;

    // Where the poses come from, and what is proven about them.
    CandidateKind kind = CandidateKind::Configurations;
    Index candidate_count = 0;  ///< for a pool: the feasible ones
    std::string checksum;       ///< covers the candidates' numbers and ids; none for a pool
    /// Value of the best choice from the candidates. A continuous plan's `value` is above it.
    double choice_value = -std::numeric_limits<double>::infinity();
    /// Proven: no choice from the candidates has a larger value.
    double bound = std::numeric_limits<double>::infinity();
    double efficiency = 0;    ///< choice_value against the bound, see Choice::efficiency
    Certificate certificate;  ///< proves the bound; not kept for a pool

    // For continuous plans: from a search, not a proof. Infinity: not searched.
    double searched_bound = std::numeric_limits<double>::infinity();
    double searched_efficiency = 0;

    Index starts_at_best = 0;  ///< how many of the starts ended at this value
    Index tried = 0;           ///< choices that no bound ruled out; if optimal, all such
    Ending ending = Ending::NotRun;

    /// Accuracy that a calibration will achieve over the workspace; for choices over the
    /// candidates. In files only for continuous plans.
    std::optional<PredictedAccuracy> predicted;

    // For continuous plans: deviations, and how long measuring takes.
    std::vector<NamedNumber> standard_deviations;  ///< expected, for each parameter, m or rad
    double visiting_time = 0;                      ///< s, without verification poses
    /// s: all moves and standstills, at all stations; targets that a pose does not show take none.
    double duration = 0;
    /// Whether the only reflector is moved by hand at each pose, since that is quicker than one run
    /// for each target.
    bool is_target_changed_at_poses = false;
    Index target_runs = 1;  ///< else: runs through all poses at each station, one for each target

    /// Poses to judge the calibration on, never to calibrate with: random in the workspace,
    /// feasible and seen like the others, at least 5 deg (and the cell's least joint distance) from
    /// them and from each other. In visiting order, starting at the last of `poses`. Fewer than
    /// asked for if there are no more.
    std::vector<PlannedPose> verification;
    double verification_time = 0;  ///< s, for all moves to and between them

    /// What of the robot is not checked against the cell's obstacles, and listed candidates that
    /// are not allowed there, a sentence each.
    std::vector<std::string> cell_doubts;

    /// Noise and scales that it assumes: "sigma_m", "expected_error/dq2_rad". NaN: it was no
    /// number.
    std::vector<NamedNumber> assumptions;

    bool is_continuous() const { return kind == CandidateKind::Pool; }
    bool is_stopped_early() const {
        return ending == Ending::TimeLimit || ending == Ending::Interrupted;
    }
};

/// The model error that a plan assumes, m; nothing for plain blocks.
std::optional<double> assumed_model_error(const Plan& plan);

/// Names of a configuration's numbers, with SI units.
std::vector<std::string> configuration_columns(const Campaign& campaign);

/// What a campaign assumes: noise, model error, the expected error of each parameter.
std::vector<NamedNumber> assumptions_of(const Campaign& campaign);

/// Why a plan does not belong to a campaign (another name, joints or targets), in words that begin
/// with the place: "campaign: is 'a'; must be a plan of 'b'". Empty if it does.
std::string describe_mismatch(const Plan& plan, const Campaign& campaign);

/// The measured configurations that belong to a plan, in its order; ids in `excluded` do not count.
/// Throws InputError if one is missing or was measured at other joint values (beyond 2 mrad or
/// 2 mm; contacts: 0.2 rad or m), if the plan has other joints than the campaign's robot or fewer
/// or more poses than it states, and if all are excluded.
std::vector<Index> find_planned(const Plan& plan, const Campaign& campaign,
                                const Measurements& measured,
                                const std::vector<std::string>& excluded = {});

/// The measured configurations that belong to a plan's verification poses, as far as they were
/// measured. Throws InputError if one of them was measured at other joint values.
std::vector<Index> find_verification(const Plan& plan, const Campaign& campaign,
                                     const Measurements& measured,
                                     const std::vector<std::string>& excluded = {});

}  // namespace posewise
