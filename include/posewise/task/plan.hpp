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
#include "posewise/planner/prediction.hpp"
#include "posewise/selection/choice.hpp"
#include "posewise/task/earlier.hpp"

namespace posewise {

/// What a plan was made from.
enum class CandidateKind {
    Measurements,    ///< measured configurations; base and targets registered from them
    Configurations,  ///< a list of configurations
    Random,          ///< scrambled Halton sequence within the joint limits
    Blocks,          ///< plain blocks, no robot
    Pool,            ///< what a cell allows, and everything between: configurations are continuous
};

/// Where a plan's inputs came from, as whoever had them says: paths, mostly. For messages, and to
/// find them again; empty where there were none.
struct PlanSources {
    std::string campaign;
    std::string estimate;  ///< an earlier one that with_earlier() applied to the campaign
    std::string candidates;
    Index rows_per_block = 0;  ///< of plain blocks
    std::string variable;      ///< of plain blocks in a MATLAB file; empty: the first
    std::string augment;       ///< poses measured already
    std::string test_poses;
    std::string groups;
    std::string repaired;  ///< the plan that was repaired
    std::string workspace;
};

/// What is asked for, in numbers and words. With the same inputs it states a plan's problem again.
struct PlanRequest {
    Criterion criterion = Criterion::D;
    Index pose_count = 0;  ///< K, must be stated; all together, kept poses of a repair too
    /// Whether the expected errors are the prior standard deviations, too. Of plain blocks; for a
    /// campaign its ParameterSpread::is_prior says so.
    bool has_prior = false;
    bool is_focused_on_robot = false;  ///< base and targets are estimated along, but do not count
    double repeats = 0;  ///< samples of each configuration; 0: as in measured candidates, or 1
    /// Independent searches; 0: as many as the search takes by default. Of a plan: those that
    /// ended.
    Index starts = 0;
    std::uint64_t seed = 1;  ///< of all draws
    PlanSources sources;
    EarlierUse earlier{};  ///< how the estimate was used, if there was one

    // Of choose().
    Index group_limit = 0;              ///< most of one group; 0: any number
    std::vector<std::string> excluded;  ///< ids not to choose
    Index repeat_limit = 1;             ///< how often one candidate may be chosen
    double least_distance = 0;      ///< rad, Euclidean over the turning joints, of any two chosen
    std::optional<double> proof{};  ///< as SelectOptions::proof

    // Of make_plan().
    std::vector<std::string> dropped;  ///< ids of the repaired plan that could not be reached
    Index workspace_count = 500;       ///< configurations drawn for the workspace
    /// Least x, y, z, then largest, where targets are in drawn ones; empty: the cell's boxes.
    std::vector<double> workspace_box_mm;
    Index workspace_target = 0;  ///< that counts, from 1; 0: all
    Index pool_count = 20000;    ///< candidates drawn
    /// Poses to draw beside those planned, see Plan::verification. 0: as many as a repaired plan
    /// has.
    Index verification_count = 0;
    double time_limit = 0;  ///< s, as was stated; 0: none
};

/// One pose to measure.
struct PlannedPose {
    std::string id;
    VectorXd configuration;      ///< rad, m, and N m of measured torques; empty for plain blocks
    Index times = 1;             ///< to measure it; above 1 where repeats are allowed
    std::vector<Index> targets;  ///< that it shows, from 0; empty: not stated
    std::optional<VectorXd> via = {};  ///< configuration to pass on the way there
    bool is_blocked = false;           ///< no free way there was found
    bool is_kept = false;              ///< of the plan that was repaired
    /// Of continuous plans: the least there, at the nominal robot; nothing: not stated.
    std::optional<Clearance> clearance = {};
};

/// A number by its name, which ends with its unit where it has one.
struct NamedNumber {
    std::string name;
    double value = 0;
};

/// What to measure and how good that is: the result of choose() and make_plan(), what a plan file
/// holds and verify() checks.
struct Plan {
    std::string campaign;              ///< its name; empty: plain blocks
    std::vector<std::string> columns;  ///< of a configuration: "q1_rad", "lift_m", "tau_q2_Nm"
    std::vector<PlannedPose> poses;    ///< of continuous ones: in the order to visit them
    PlanRequest request;               ///< complete: what was left open is filled in
    double value = -std::numeric_limits<double>::infinity();  ///< of the criterion
    /// What the value says, where it is that of V or G and nothing else but positions is predicted:
    /// RMS position error by the parameters over the test poses (G: at the worst), m. Not in files.
    std::optional<double> value_rms;

    // What the poses were taken from, and what is proven about it.
    CandidateKind kind = CandidateKind::Configurations;
    Index candidate_count = 0;  ///< of a pool: the feasible ones
    std::string checksum;       ///< of the candidates' numbers and ids; none of a pool
    /// Of the best choice from the candidates. For a continuous plan `value` is above it.
    double choice_value = -std::numeric_limits<double>::infinity();
    /// Proven: no choice from the candidates has a larger value.
    double bound = std::numeric_limits<double>::infinity();
    double efficiency = 0;    ///< of choice_value against the bound, see Choice::efficiency
    Certificate certificate;  ///< proves the bound; not kept for a pool

    // Of continuous plans: by a search, not a proof. Infinity: not searched.
    double searched_bound = std::numeric_limits<double>::infinity();
    double searched_efficiency = 0;

    Index starts_at_best = 0;  ///< how many of the starts ended at this value
    Index tried = 0;           ///< choices that no bound ruled out; of an optimal choice all such
    Ending ending = Ending::NotRun;

    /// What calibration will achieve: over the workspace, of choices over the candidates. Files
    /// hold that of continuous plans.
    std::optional<PredictedAccuracy> predicted;

    // Of continuous plans: deviations, and how long measuring takes.
    std::vector<NamedNumber> standard_deviations;  ///< expected, of each parameter, m or rad
    double visiting_time = 0;                      ///< s, without those to verify

    /// To judge the calibration on, and never to calibrate with: random in the workspace, feasible
    /// and seen like the others, 5 deg or more (and the cell's least joint distance) from them and
    /// from each other. In the order to visit them, from the last of `poses` on. Fewer than asked
    /// for where there are no more.
    std::vector<PlannedPose> verification;
    double verification_time = 0;  ///< s, of all moves to and between them

    /// What of the robot is not kept off the cell's obstacles, and listed candidates that are not
    /// allowed there, a sentence each.
    std::vector<std::string> cell_doubts;

    /// Noise and scales it rests on: "sigma_m", "expected_error/dq2_rad". A NaN was no number.
    std::vector<NamedNumber> assumptions;

    bool is_continuous() const { return kind == CandidateKind::Pool; }
    bool is_stopped_early() const {
        return ending == Ending::TimeLimit || ending == Ending::Interrupted;
    }
};

/// The model error that a plan assumes, m; nothing of plain blocks.
std::optional<double> assumed_model_error(const Plan& plan);

/// The names of a configuration's numbers, with SI units.
std::vector<std::string> configuration_columns(const Campaign& campaign);

/// What a campaign assumes: noise, model error, the expected error of each parameter.
std::vector<NamedNumber> assumptions_of(const Campaign& campaign);

/// Where a plan is not of a campaign (another name, joints or targets), in words that begin with
/// the place: "campaign: is 'a'; must be a plan of 'b'". Empty if it is.
std::string describe_mismatch(const Plan& plan, const Campaign& campaign);

/// Which of the measured configurations are those of a plan, in its order; ids in `excluded` do not
/// count. Throws InputError if one is not there or was measured at other joint values (beyond 2
/// mrad or 2 mm), if the plan has other joints than the campaign's robot or not as many poses as it
/// is of, and if all are excluded.
std::vector<Index> find_planned(const Plan& plan, const Campaign& campaign,
                                const Measurements& measured,
                                const std::vector<std::string>& excluded = {});

/// Which of the measured configurations are those that a plan has to verify, as far as they were
/// measured. Throws InputError if one of them was measured at other joint values.
std::vector<Index> find_verification(const Plan& plan, const Campaign& campaign,
                                     const Measurements& measured,
                                     const std::vector<std::string>& excluded = {});

}  // namespace posewise
