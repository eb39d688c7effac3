#pragma once

#include "posewise/task/limit.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {

/// How the closed-form prediction of a plan is checked.
struct SimulatedPlanOptions {
    ErrorQuantity quantity = ErrorQuantity::Rms;
    double assurance = 0.95;
    Index missing = 0;  ///< so many of Planning::drop_outs, from the first on, are not measured
    /// Configurations to judge at, if the plan's workspace was stated, that; empty: as many as the
    /// plan has, drawn anew.
    RowMatrixXd workspace;
    std::uint64_t seed = 1;  ///< robot i draws from stream (seed, i)
    /// Of the standard deviation over the robots, that are to be sure: what is found is sure to
    /// half a unit of the last of them.
    Index digits = 2;
    Index most_robots = 100000;
    StopSignal stop{};            ///< ends it with the blocks that are complete
    ProgressCallback progress{};  ///< of the robots; how many are needed is guessed
};

/// One number of an ErrorRange, m.
struct SimulatedNumber {
    double predicted = 0;    ///< by the closed form
    double found = 0;        ///< infinity: too many robots were not calibrated
    double uncertainty = 0;  ///< standard deviation of what is found; infinity: unknown
};

/// What was found on robots that were drawn, measured at a plan's poses and calibrated.
struct SimulatedPlan {
    ErrorQuantity quantity = ErrorQuantity::Rms;
    double assurance = 0.95;
    /// As ErrorRange: of the RMS it is the root of the mean square over robots whose model error
    /// and sizes are as the campaign expects them.
    SimulatedNumber expected, lower, upper, assured;
    Index robot_count = 0;           ///< complete blocks; 0: it was stopped before the first ended
    Index expected_count = 0;        ///< robots of expected sizes beside those, for `expected`
    Index block_count = 0;           ///< of equally many robots
    Index uncalibrated_count = 0;    ///< of all robots; they count as the worst
    double deviation = 0;            ///< over the robots that were calibrated, m
    double tolerance = 0;            ///< twice each uncertainty is to be at most this, m
    Ending ending = Ending::NotRun;  ///< Converged: it is; IterationLimit: most_robots came first
    Index digits = 2;

    bool is_sure() const { return ending == Ending::Converged; }
};

/// Whether a limit of the error (m) is kept with the assurance asked for; open within twice the
/// uncertainty.
LimitVerdict judge_limit(const SimulatedPlan& simulated, double limit);

/// Throws InputError, which says what to do instead, where robots cannot be drawn for plans of this
/// campaign: its sensor has contacts, poses were measured already (on one robot, which others are
/// not), or the repeats are no whole number.
void check_simulable(const Campaign& campaign, const PlanningOptions& options);

/// Checks the closed-form prediction of a plan by a Monte Carlo of full calibrations. Each robot is
/// drawn as draw_robot() does, measured at all poses of the plan, calibrated from nothing but that
/// and judged at configurations of the workspace that the plan was not made with: where each target
/// is at one visit, model error and repeatability included, against where the calibrated model has
/// it. In each block of robots model error and sizes fill what they may be evenly (a Kronecker
/// sequence, shifted at random). Blocks are added until twice the standard deviation of each number
/// over the blocks, by the root of their count, is at most the numerical tolerance [JCGM 101:2008,
/// 7.9]; what is found is that of all robots at once. The same result for any number of threads,
/// unless it is stopped. Throws InputError as check_simulable(), for options out of range, and if
/// the plan's workspace was stated but is not given.
SimulatedPlan simulate_plan(const Planning& planning, const SimulatedPlanOptions& options);

}  // namespace posewise
