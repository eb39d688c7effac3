#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/controller.hpp"
#include "posewise/planner/planning.hpp"
#include "posewise/task/answers.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/judgement.hpp"
#include "posewise/task/plan.hpp"

namespace posewise {

/// What is asked for, further inputs besides the campaign, and when to stop.
struct PlanningOptions : PlanRequest {
    explicit PlanningOptions(Index poses = 0) {
        pose_count = poses;
        repeats = 1;
    }
    std::optional<Measurements> held;  ///< measured already: their information counts
    std::optional<Plan> repaired;      ///< its poses are kept, except those dropped
    RowMatrixXd workspace;     ///< configurations where accuracy matters; empty: drawn in the cell
    Index drop_out_count = 1;  ///< poses that may be missing, see Planning::drop_outs
    /// Campaigns with richer errors, the richest last, for Planning::left_out. Nothing: none.
    std::function<std::vector<OtherCampaign>()> richer{};
    StopSignal stop{};  ///< ends the search with the best so far
    ProgressCallback progress{};
};

/// What errors do that a robot has and its model has not. A poorer model has less to find, so it
/// promises more than it keeps. RMS over workspace and targets, model error included, m.
struct ErrorsLeftOut {
    std::string key;        ///< the richer model: "errors: full"
    Index error_count = 0;  ///< how many more errors that has
    double promised = 0;    ///< expected by the poorer model alone
    double expected = 0;    ///< by it if the robot has all errors of the richer one, as expected
    double lower = 0;       ///< the same if they are as small as in 5 % of such robots
    double upper = 0;       ///< or as large
    double with_them = 0;   ///< expected if the richer model is fitted to the same poses
};

/// A plan, and how its making went.
struct Planning {
    Plan plan;
    Pool pool;
    Tour tour;
    Index measured_count = 0;   ///< poses measured already
    Index workspace_count = 0;  ///< workspace configurations of the prediction
    Campaign campaign;          ///< base and targets registered, if only held poses show them
    PositionErrors errors;      ///< errors of target positions over the workspace
    PlanOptions search;         ///< criterion, new poses, nuisance and what was held
    MatrixXd information;       ///< from all poses and what is held (scaled parameters)
    std::optional<PredictedAccuracy> chosen;  ///< by the best choice from the pool, not moved
    InformationByNoise by_noise;              ///< for all poses
    ErrorBudget budget;
    std::vector<DropOut> without_each;      ///< with each pose of the plan missing, in its order
    std::vector<DropOut> drop_outs;         ///< the poses that hurt most, missing one after another
    std::optional<ErrorsLeftOut> left_out;  ///< nothing: none that matter, or an estimate tells
    std::optional<RobotError> robot_alone{};  ///< over the workspace, where pixels are measured
    std::vector<ImageCoverage> images{};      ///< of expected_readings(), one a camera
};

/// Proposes configurations to measure in the campaign's cell: draws a pool, chooses from it,
/// refines each pose continuously and orders the poses for a quick tour. The pool takes at most
/// half of the available time. Throws InputError for a cell without a feasible pose, for kept poses
/// that cannot be measured, for fewer poses than identify the parameters, and as plan_poses().
Planning make_plan(const Campaign& campaign, const PlanningOptions& options);

/// What the poses to calibrate with show of a robot that is as the campaign states it: a sample of
/// each, without noise; for find_image_coverage().
Measurements expected_readings(const Campaign& campaign, const Plan& plan);

/// A stored plan that make_plan() made with these options: its predictions, its error budget and
/// the value of each pose. The pool is unknown; the tour has only its time. Throws InputError as
/// make_plan(), and if the poses do not identify the parameters.
Planning judge_again(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);

/// Predicted accuracy for a number of new poses.
struct CountAccuracy {
    Index pose_count = 0;
    bool is_planned = false;  ///< as planned; else chosen from a part of the pool: an estimate
    /// Nothing: too few to identify the parameters, or more than the pool has.
    std::optional<PredictedAccuracy> accuracy;
};

/// For half, as many and twice as many new poses as planned, by count; after a stop for those known
/// by then.
std::vector<CountAccuracy> predict_other_counts(const Planning& planning,
                                                const StopSignal& stop = {});

/// What a plan shall reach, or how long it may take, instead of a number of poses.
struct TargetOptions {
    std::optional<double> limit;  ///< for the position error over the workspace, m
    double assurance = 0.95;      ///< probability of keeping it, before measuring
    ErrorQuantity quantity = ErrorQuantity::Rms;
    std::optional<double> duration;  ///< s, see Planning::duration
    Index most_poses = 1000;         ///< new poses
    /// Keep the limit even if this many poses, the most important ones, drop out.
    Index robust_to = 0;
};

/// What a number of new poses is expected to reach, with drop-outs.
struct CountPrediction {
    Index pose_count = 0;
    bool is_planned = false;  ///< as planned; else chosen from a part of the pool: an estimate
    /// Nothing: too few to identify the parameters. For chosen poses, never above that of fewer.
    std::optional<ErrorRange> error;
    double duration = 0;  ///< s; for chosen poses straight moves, ignoring collisions
};

/// Numbers of poses that suffice if the errors turn out small or large (1 in 20 each): how
/// uncertain the number is that a target needs. Chosen from a part of the pool, see
/// CountPrediction::is_planned.
struct CountRange {
    std::optional<Index> lower;  ///< suffices with 5 % probability
    std::optional<Index> upper;  ///< with 95 %; nothing: more than `most`, or no number
    Index most = 0;              ///< largest number looked at
};

/// How a search for the number of poses ended.
enum class TargetEnding {
    NotRun,
    Reached,     ///< the plan keeps the limit, one with fewer poses does not; or as many as fit
    BelowFloor,  ///< no number of poses keeps the limit
    /// Neither TargetOptions::most_poses nor the pool suffices; or more than 200 poses are needed,
    /// whose plans take minutes each: the curve says about how many.
    TooManyPoses,
    TooLong,  ///< what keeps the limit takes longer than there is time
};

/// A plan with as many poses as a target needs.
struct TargetPlanning {
    TargetOptions target;
    TargetEnding ending = TargetEnding::NotRun;
    std::optional<Planning> planning;  ///< if Reached
    std::optional<ErrorRange> error;   ///< error of that plan
    /// No plan with one pose less keeps the limit (without a limit: none with one more fits), as
    /// far as a completed search found. False: stopped early, there may be one.
    bool is_settled = false;
    /// For a limit, kept or not; nothing: stopped early, or too long, or the floor of even the 5 %
    /// end is above the limit.
    std::optional<CountRange> counts;
    std::vector<CountPrediction> curve;     ///< by count, as far as looked at
    ErrorRange floor;                       ///< error left if the parameters are known exactly
    double floor_of_known_model_error = 0;  ///< m; likewise once an estimate tells it
    double left_over = 0;                   ///< m; share of the model error in the expected floor
    double repeatability = 0;               ///< m; that of the joints
    bool has_error_terms = false;  ///< the model has errors that depend on the configuration
};

/// Finds the least number of poses whose plan keeps the limit, and that plan: first by choices from
/// a part of the pool, then by quick plans, finally by plans like those of make_plan(). Without a
/// limit: as many poses as fit in the duration. Ignores options.pose_count. A stop ends the search
/// with the last plan that keeps the target, marked as stopped early. Throws InputError if
/// neither a limit nor a duration is stated, if one of them or the assurance is out of range, if
/// the duration is too short for the least number of poses, for a plan to repair, if it is stopped
/// before there is a plan, and as make_plan().
TargetPlanning plan_for_target(const Campaign& campaign, const PlanningOptions& options,
                               const TargetOptions& target);

/// How to check the closed-form prediction of a plan.
struct SimulatedPlanOptions {
    ErrorQuantity quantity = ErrorQuantity::Rms;
    double assurance = 0.95;
    Index missing = 0;  ///< this many of Planning::drop_outs, from the first on, are not measured
    /// Configurations to judge at: the plan's workspace, if it was stated. Empty: as many as the
    /// plan has, drawn anew.
    RowMatrixXd workspace;
    std::uint64_t seed = 1;  ///< robot i draws from stream (seed, i)
    /// Digits of the standard deviation over the robots that must be certain; results are certain
    /// to half a unit of the last one.
    Index digits = 2;
    Index most_robots = 100000;
    StopSignal stop{};            ///< ends it with the complete blocks
    ProgressCallback progress{};  ///< counts robots; the total is a guess
};

/// One number of an ErrorRange, m.
struct SimulatedNumber {
    double predicted = 0;    ///< by the closed form
    double found = 0;        ///< infinity: too many robots were not calibrated
    double uncertainty = 0;  ///< standard deviation of `found`; infinity: unknown
};

/// Results of simulated robots, measured at a plan's poses and calibrated.
struct SimulatedPlan {
    ErrorQuantity quantity = ErrorQuantity::Rms;
    double assurance = 0.95;
    /// As in ErrorRange; for the RMS, `expected` is the root mean square over robots whose model
    /// error and sizes are as the campaign expects them.
    SimulatedNumber expected, lower, upper, assured;
    Index robot_count = 0;         ///< in complete blocks; 0: it was stopped before the first ended
    Index expected_count = 0;      ///< additional robots of expected sizes, for `expected`
    Index block_count = 0;         ///< with equally many robots
    Index uncalibrated_count = 0;  ///< among all robots; they count as the worst
    double deviation = 0;          ///< over the calibrated robots, m
    double tolerance = 0;          ///< bound on twice each uncertainty, m
    Ending ending = Ending::NotRun;  ///< Converged: kept; IterationLimit: most_robots came first
    Index digits = 2;

    bool is_sure() const { return ending == Ending::Converged; }
};

/// Whether a limit on the error (m) is kept with the assurance asked for; open within twice the
/// uncertainty.
LimitVerdict judge_limit(const SimulatedPlan& simulated, double limit);

/// Throws InputError, saying what to do instead, if robots cannot be simulated for plans of this
/// campaign: its sensor has contacts, poses were measured already (on one robot; the simulated ones
/// are others), or the repeats are no whole number.
void check_simulable(const Campaign& campaign, const PlanningOptions& options);

/// Checks the closed-form prediction of a plan by a Monte Carlo simulation of full calibrations.
/// Each robot is drawn as in draw_robot(), measured at all poses of the plan and calibrated from
/// these measurements only. It is judged at workspace configurations that the plan was not made
/// with: where each target is at one visit, including model error and repeatability, against where
/// the calibrated model has it. In each block of robots, model error and sizes fill their range
/// evenly (a Kronecker sequence, shifted at random). Blocks are added until twice the standard
/// deviation of each number over the blocks, divided by the root of their count, is at most the
/// numerical tolerance [JCGM 101:2008, 7.9]; the result is that of all robots at once.
/// Independent of the number of threads, unless it is stopped. Throws InputError as
/// check_simulable(), for options out of range, and if the plan's workspace was stated but is not
/// given.
SimulatedPlan simulate_plan(const Planning& planning, const SimulatedPlanOptions& options);

/// Whether one item of a plan is as stated.
struct Finding {
    std::string name;  ///< "poses", "bound"
    bool is_right = true;
    std::string text;  ///< empty: the two numbers say it
    double stated = 0;
    double actual = 0;
};

/// What was found about a plan, in the order it was checked.
struct Verification {
    Index candidate_count = 0;  ///< candidates to choose from; for continuous plans: poses
    std::vector<Finding> findings;
    /// Why checking ended there: "poses[2].id: 'p9' is not among the candidates". Empty: it did
    /// not.
    std::string obstacle;

    /// Names of what is not as stated, each once.
    std::vector<std::string> wrong() const;
    bool is_right() const { return obstacle.empty() && wrong().empty(); }
};

/// Recomputes value, bound and efficiency of a choice from its inputs and its certificate; checks
/// the candidates by their checksum, the poses and the limits. `options` are the plan's request
/// with its inputs. If a plan claims to be optimal beyond its certificate, that search is repeated.
/// Throws InputError as choose().
Verification verify(const Plan& plan, const Campaign& campaign, const Candidates& candidates,
                    const ChoiceOptions& options);
/// As above for plain blocks.
Verification verify(const Plan& plan, const Blocks& candidates, const ChoiceOptions& options);

/// Checks every pose of a continuous plan (joint limits, the cell's constraints, targets seen), its
/// value and its predicted accuracy. Its bounds cannot be proven from what a plan holds. Throws
/// InputError as make_plan(), and for a plan of another campaign.
Verification verify(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);

// A plan as a robot's controller is sent it: joints in the digits of a program, and the way.

/// The plan with every configuration, also vias, at joint values that are whole multiples of
/// `steps` (of each controller joint, rad or m): the nearest ones that keep the joint limits and
/// the cell and show the targets that the pose states, among the two of each joint that are next to
/// the planned value. Measured torques stay. Poses of a choice, which states no way, are put in the
/// order of a short tour, with vias. Throws InputError for a plan of another campaign, a
/// pose without free way, a pose that violates limits or the cell as it is planned or however it is
/// rounded, and where sockets are to be touched, which no program can.
Plan sent_plan(const Plan& plan, const Campaign& campaign, const ControllerJoints& controller,
               const VectorXd& steps);

/// A configuration (rad or m) at whole multiples of `steps` (of each controller joint): the nearest
/// that is not beyond the joint limits and the campaign's joint sums, or no further than
/// `configuration` itself, among the two of each joint that are next to it; if there is none, the
/// nearest. Throws InputError for a step that is not positive.
VectorXd rounded_within_limits(const VectorXd& configuration, const Campaign& campaign,
                               const ControllerJoints& controller, const VectorXd& steps);

/// What rounding costs.
struct RoundingLoss {
    Criterion criterion = Criterion::D;
    double planned = 0;  ///< value of the criterion
    double sent = 0;
    double largest_turn = 0;   ///< by which rounding moved a joint, rad
    double largest_slide = 0;  ///< likewise, m
    /// Predicted RMS position error over the workspace, m; for continuous plans.
    std::optional<double> planned_rms = {};
    std::optional<double> sent_rms = {};
};
/// Compares a continuous plan, made with these options, before and after rounding. Throws
/// InputError as verify().
RoundingLoss rounding_loss(const Plan& plan, const Plan& sent, const Campaign& campaign,
                           const PlanningOptions& options);
/// Compares a choice from configurations that were not measured yet.
RoundingLoss rounding_loss(const Plan& plan, const Plan& sent, const Campaign& campaign,
                           Candidates candidates, const ChoiceOptions& options);

/// The sent plan with one of its poses visited again, as ref1, ref2, ..., after each `every` other
/// poses to calibrate with, and after the last of them: what changes there drifts. The ways to and
/// from these visits are not planned; route_of() finds them if it is asked to. Throws InputError if
/// the plan has no pose to calibrate with of this id, or one that is called like a visit.
Plan with_revisits(const Plan& sent, const std::string& id, Index every);

/// How often a program visits the poses, and in which order.
struct RouteOptions {
    Index repeats = 1;         ///< passes over all poses
    bool is_reversed = false;  ///< every second pass goes back along the way of the one before
    bool finds_ways = false;   ///< where the straight move is not free, instead of refusing it
};

/// One stop on the way.
struct RouteStop {
    enum class Kind { Home, Via, Pose };
    Kind kind = Kind::Pose;
    std::string id;  ///< the pose's; empty for home and vias
    Index times = 1;
    VectorXd configuration;
};

/// The way of a program through a sent plan: home, if the cell has one, then poses and verification
/// poses in the plan's order with their vias, then home. Every move is checked against the cell
/// again, and the way back, which no plan states, is found. Throws InputError for a move that is
/// not free, and for a reversed pass without a home.
std::vector<RouteStop> route_of(const Plan& sent, const Campaign& campaign,
                                const ControllerJoints& controller, const VectorXd& steps,
                                const RouteOptions& options = {});

/// What keeps a robot from taking this way, which perhaps was edited since it was sent: "pose 'p3'
/// is beyond the joint limits (less their margin): q2 is 61 deg, must be from -50 to 60 deg" and
/// the like of joint sums and the cell, targets that poses of the plan are to show and do not, and
/// moves that are not free. Each once. Throws InputError as Constraints.
std::vector<std::string> find_faults(const std::vector<RouteStop>& route, const Campaign& campaign,
                                     const std::optional<Plan>& sent);

}  // namespace posewise
