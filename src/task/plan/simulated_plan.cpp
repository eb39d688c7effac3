#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/elementary.hpp"
#include "core/parallel.hpp"
#include "core/progress_counter.hpp"
#include "planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/planning.hpp"
#include "task/choice/robot_blocks.hpp"
#include "task/study/trial_robot.hpp"
#include "workspace.hpp"

namespace posewise {
namespace {

using detail::RobotBlocks;

constexpr double unlimited = std::numeric_limits<double>::infinity();

// ---- What is asked for ----

void check_sensor(const Campaign& campaign) {
    if (!campaign.sensor->has_contacts()) return;
    throw InputError(campaign.name +
                     ": robots that touch sockets cannot be simulated: each touches them at joint "
                     "values of its own, not at those planned");
}

void check_repeats(double repeats) {
    if (repeats == std::floor(repeats)) return;
    throw InputError(fmt::format(
        "repeats are {:g}; must be a whole number to verify the plan on robots that are drawn",
        repeats));
}

void check_measured_count(Index count) {
    if (count == 0) return;
    throw InputError(
        "poses measured already are of one robot, those that are drawn to verify a plan are others;"
        " verify it without them (`held`), or use what they tell as an estimate that is the prior "
        "(`earlier`, `earlier.is_prior`)");
}

void check_options(const Planning& planning, const SimulatedPlanOptions& options) {
    constexpr Index least_robots = 100;
    const auto check = [](const char* what, Index value, Index least, Index most) {
        if (value >= least && value <= most) return;
        throw InputError(fmt::format("{} {}, must be from {} to {}", what, value, least, most));
    };
    check("digits to be sure are", options.digits, 1, 6);
    check("robots to draw at most are", options.most_robots, least_robots, Index{1} << 40);
    check("poses that are missing are", options.missing, 0,
          static_cast<Index>(planning.drop_outs.size()));
    if (!planning.plan.request.sources.workspace.empty() && options.workspace.rows() == 0) {
        throw InputError("the plan's workspace was stated; must be given to verify it, too");
    }
}

/// Of the plan, but for those that are missing.
std::vector<PlannedPose> measured_poses(const Planning& planning, Index missing) {
    std::vector<PlannedPose> poses;
    for (std::size_t i = 0; i < planning.plan.poses.size(); ++i) {
        const auto end = planning.drop_outs.begin() + missing;
        const bool is_missing =
            std::any_of(planning.drop_outs.begin(), end,
                        [&](const DropOut& one) { return one.pose == static_cast<Index>(i); });
        if (!is_missing) poses.push_back(planning.plan.poses[i]);
    }
    return poses;
}

detail::Subset subset_of(const std::vector<PlannedPose>& poses, const Campaign& campaign) {
    return {detail::configurations_of(poses, campaign.robot.joint_count()),
            detail::seen_at(poses, campaign.sensor->target_count())};
}

RowMatrixXd judged_at(const Planning& planning, const SimulatedPlanOptions& options) {
    if (options.workspace.rows() > 0) return options.workspace;
    const PlanRequest& request = planning.plan.request;
    // Not those that the prediction is over, nor a study's.
    return detail::workspace_configurations(planning.campaign, detail::workspace_box(request),
                                            planning.workspace_count, request.seed.value() + 3);
}

// ---- One robot ----

/// What all robots share.
class PlanTrials {
  public:
    PlanTrials(const Planning& planning, const SimulatedPlanOptions& options)
        : campaign_(planning.campaign),
          options_(options),
          repeats_(static_cast<Index>(planning.plan.request.repeats)),
          target_(planning.plan.request.workspace_target - 1),
          subset_(subset_of(measured_poses(planning, options.missing), planning.campaign)),
          test_(judged_at(planning, options)) {}

    /// The quantity, m; infinity: it was not calibrated.
    double run(Index number, const detail::RobotSizes& sizes) const {
        RandomStream stream(options_.seed, static_cast<std::uint64_t>(number));
        const KnownWithin& known = campaign_.known_within;
        const double errors = detail::power(known.error_size, sizes.errors);
        const double model = detail::power(known.model_error, sizes.model_error);
        DrawnRobot robot = draw_robot(campaign_, errors, model, detail::draw_seed(stream));
        const detail::TrialRobot trial =
            detail::visit(campaign_, std::move(robot), test_, detail::draw_seed(stream));
        const auto estimate =
            detail::calibrate_robot(campaign_, trial, subset_, repeats_, detail::draw_seed(stream));
        if (!estimate || !estimate->parameters.robot.allFinite()) return unlimited;
        const HeldOut off = detail::compare_positions(
            judged(detail::target_positions(campaign_, estimate->parameters, test_)),
            judged(trial.positions));
        if (options_.quantity == ErrorQuantity::Rms) return off.rms;
        return options_.quantity == ErrorQuantity::Max ? off.max : off.p95;
    }

  private:
    /// Columns of the targets whose positions count.
    RowMatrixXd judged(const RowMatrixXd& positions) const {
        return target_ < 0 ? positions : RowMatrixXd(positions.middleCols(3 * target_, 3));
    }

    const Campaign& campaign_;
    const SimulatedPlanOptions& options_;
    Index repeats_;
    Index target_;
    detail::Subset subset_;
    RowMatrixXd test_;
};

// ---- All of them ----

/// Those of the next round that are complete when it ends, or is stopped.
void run_round(const PlanTrials& trials, const SimulatedPlanOptions& options, Index count,
               Index guessed, RobotBlocks& blocks) {
    const Index each = blocks.robots_a_block();
    const Index first = blocks.count();
    VectorXd values = VectorXd::Constant(count * each, -1);
    detail::ProgressCounter counter(
        options.progress,
        Progress{.done = first * each, .total = std::max(guessed, first + count) * each + 1});
    detail::for_each_index(values.size(), [&](Index i) {
        if (options.stop.is_set()) return;
        const Index b = first + i / each;
        values[i] = trials.run(first * each + i, blocks.sizes(b, i % each));
        counter.count();
    });
    for (Index b = 0; b < count; ++b) {
        if (values.segment(b * each, each).minCoeff() < 0) return;
        blocks.add(values.segment(b * each, each));
    }
}

/// The closed form.
ErrorRange predict(const Planning& planning, const SimulatedPlanOptions& options) {
    const Campaign& campaign = planning.campaign;
    MatrixXd M = planning.information;
    std::vector<PlannedPose> missing;
    for (Index i = 0; i < options.missing; ++i) {
        const Index pose = planning.drop_outs[static_cast<std::size_t>(i)].pose;
        missing.push_back(planning.plan.poses[static_cast<std::size_t>(pose)]);
    }
    if (!missing.empty()) {
        const auto [configurations, is_seen] = subset_of(missing, campaign);
        M -= information(make_blocks(campaign, campaign.nominal, configurations,
                                     times_seen(is_seen, planning.plan.request.repeats)));
    }
    return predict_range(planning.errors, campaign, M, planning.by_noise, options.quantity,
                         options.assurance, planning.plan.request.seed.value());
}

}  // namespace

LimitVerdict judge_limit(const SimulatedPlan& simulated, double limit) {
    const SimulatedNumber& assured = simulated.assured;
    if (simulated.robot_count == 0) return LimitVerdict::Open;
    if (std::isinf(assured.found)) return LimitVerdict::NotKept;
    if (std::abs(assured.found - limit) <= 2 * assured.uncertainty) return LimitVerdict::Open;
    return assured.found < limit ? LimitVerdict::Kept : LimitVerdict::NotKept;
}

void check_simulable(const Campaign& campaign, const PlanningOptions& options) {
    check_sensor(campaign);
    check_repeats(options.repeats);
    check_measured_count(options.held ? options.held->configuration_count() : 0);
}

SimulatedPlan simulate_plan(const Planning& planning, const SimulatedPlanOptions& options) {
    check_sensor(planning.campaign);
    check_repeats(planning.plan.request.repeats);
    check_measured_count(planning.measured_count);
    check_options(planning, options);
    const ErrorRange predicted = predict(planning, options);
    const PlanTrials trials(planning, options);
    RobotBlocks blocks(planning.campaign.known_within, options);
    SimulatedPlan result;
    result.quantity = options.quantity;
    result.assurance = options.assurance;
    result.digits = options.digits;
    result.ending = Ending::NotRun;
    Index guessed = 0;
    while (result.ending == Ending::NotRun) {
        // A fifth more than there are: at most so many too many.
        const Index next =
            std::max({RobotBlocks::least - blocks.count(), blocks.count() / 5, Index{1}});
        const Index left = blocks.most() - blocks.count();
        run_round(trials, options, std::min(next, left), guessed, blocks);
        result.deviation = blocks.deviation();
        result.tolerance = detail::numerical_tolerance(result.deviation, options.digits);
        const bool is_sure =
            blocks.count() >= RobotBlocks::least && blocks.doubt() <= result.tolerance;
        if (is_sure) {
            result.ending = Ending::Converged;
        } else if (options.stop.is_set()) {
            result.ending = options.stop.ending_or(Ending::TimeLimit);
        } else if (blocks.count() >= blocks.most()) {
            result.ending = Ending::IterationLimit;
        }
        guessed = blocks.needed(result.tolerance);
    }
    const Index all = blocks.count() * blocks.robots_a_block();
    if (options.progress && all > 0) options.progress(Progress{.done = all, .total = all});
    result.block_count = blocks.count();
    result.robot_count = blocks.any_count();
    result.expected_count = blocks.expected_count();
    result.uncalibrated_count = blocks.uncalibrated_count();
    const detail::FoundRange found = blocks.count() > 0 ? blocks.found() : detail::FoundRange{};
    const auto number = [&](double closed, double detail::FoundRange::*which) {
        return SimulatedNumber{closed, found.*which, blocks.uncertainty(which)};
    };
    result.expected = number(predicted.expected, &detail::FoundRange::expected);
    result.lower = number(predicted.lower, &detail::FoundRange::lower);
    result.upper = number(predicted.upper, &detail::FoundRange::upper);
    result.assured = number(predicted.assured, &detail::FoundRange::assured);
    return result;
}

}  // namespace posewise
