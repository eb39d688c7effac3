#include "planning_problem.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "core/decompositions.hpp"
#include "core/text.hpp"
#include "measurement/places.hpp"
#include "measurement/prior_rows.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/jacobian/identification.hpp"
#include "task/calibration/inputs.hpp"
#include "workspace.hpp"

namespace posewise::detail {
namespace {

// ---- What is known before ----

/// Base and targets: as stated, else registered from what was measured.
Campaign with_base(Campaign campaign, const PlanningOptions& options) {
    const std::optional<Measurements>& measured = options.held;
    const std::string& name = options.sources.augment;
    if (campaign.has_nominal_base && campaign.has_nominal_targets) {
        if (measured) check_measured(campaign, *measured, name);
        return campaign;
    }
    if (!measured && can_assume_places(campaign)) return campaign;
    if (!measured && campaign.sensor->has_contacts()) throw unstated_contacts(campaign);
    if (!measured) {
        throw InputError(campaign.name +
                         ": the campaign file states no base, on which what this sensor tells "
                         "depends; must state base to plan, or measured poses (`held`) must "
                         "tell it");
    }
    campaign.nominal = register_measured(campaign, *measured, name);
    campaign.has_nominal_base = campaign.has_nominal_targets = true;
    return campaign;
}

void hold(PlanningProblem& problem, const RowMatrixXd& rows, const RowMatrixXd& poses) {
    HeldPoses& held = problem.search.held;
    held.rows = stack(held.rows, rows);
    RowMatrixXd all(held.configurations.rows() + poses.rows(),
                    problem.campaign.robot.joint_count());
    if (held.configurations.rows() > 0)
        all.topRows(held.configurations.rows()) = held.configurations;
    if (poses.rows() > 0) all.bottomRows(poses.rows()) = poses;
    held.configurations = std::move(all);
}

// ---- The plan to repair ----

/// Throws InputError for a pose that cannot be measured.
void check_kept(const PlanningProblem& problem, const PlannedPose& pose) {
    const std::string fault = describe_violation(problem, pose);
    if (fault.empty()) return;
    throw input_error_at({problem.request.sources.repaired},
                         fmt::format("pose {} {}; find another for it with `dropped` {}",
                                     quote(pose.id), fault, pose.id));
}

/// Throws InputError for a plan that is not of this campaign, or without a pose to drop.
void check_repaired(const PlanningProblem& problem, const Plan& repaired) {
    const std::string& name = problem.request.sources.repaired;
    std::string fault;
    if (!repaired.is_continuous()) {
        fault =
            fmt::format("is a choice from {}; must be a plan of continuous poses to be repaired",
                        repaired.kind == CandidateKind::Blocks ? "plain blocks" : "candidates");
    } else {
        fault = describe_mismatch(repaired, problem.campaign);
    }
    if (!fault.empty()) throw input_error_at({name}, fault);
    for (const std::string& id : problem.request.dropped) {
        if (std::ranges::count(problem.request.dropped, id) > 1) {
            throw InputError(fmt::format("`dropped` {}: is given twice; keep one", id));
        }
        if (std::ranges::count(repaired.verification, id, &PlannedPose::id) > 0) {
            throw InputError(
                fmt::format("`dropped` {}: is a pose to verify, which need not be replaced; leave "
                            "it out of what is measured",
                            id));
        }
        const auto has_id = [&](const PlannedPose& pose) { return pose.id == id; };
        if (std::any_of(repaired.poses.begin(), repaired.poses.end(), has_id)) continue;
        throw InputError(fmt::format("`dropped` {}: {} has no such pose", id, name));
    }
}

/// Keeps the poses of a plan but those dropped, which new poses only must stay away from.
void hold_kept(PlanningProblem& problem, const Plan& repaired) {
    check_repaired(problem, repaired);
    const auto& ids = problem.request.dropped;
    std::vector<PlannedPose> away;
    for (const PlannedPose& pose : repaired.poses) {
        const bool is_dropped = std::find(ids.begin(), ids.end(), pose.id) != ids.end();
        (is_dropped ? away : problem.kept).push_back(pose);
    }
    problem.kept_to_verify = repaired.verification;
    away.insert(away.end(), repaired.verification.begin(), repaired.verification.end());
    for (const PlannedPose& pose : problem.kept) check_kept(problem, pose);
    for (const PlannedPose& pose : problem.kept_to_verify) check_kept(problem, pose);
    const Index joints = problem.campaign.robot.joint_count();
    hold(problem, {}, configurations_of(away, joints));
    if (problem.kept.empty()) return;
    for (PlannedPose& pose : problem.kept) pose.is_kept = true;
    hold(problem, blocks_of(problem, problem.kept).matrix, configurations_of(problem.kept, joints));
    problem.search.held_pose_count += static_cast<Index>(problem.kept.size());
}

}  // namespace

PlanningOptions options_of(const Plan& plan, const PlanningOptions& inputs) {
    PlanningOptions made = inputs;
    static_cast<PlanRequest&>(made) = plan.request;
    made.repaired.reset();
    return made;
}

PlanningProblem state_planning(const Campaign& given, const PlanningOptions& options) {
    check_torques_known(given);
    const Campaign campaign = with_base(given, options);
    check_places(campaign);
    check_knowable(campaign, options.stop);
    Cell cell = campaign.cell;
    if (options.repaired) {
        cell.least_joint_distance = std::max(cell.least_joint_distance, distance_from_others);
    }
    PlanningProblem problem{
        options, campaign, Constraints(campaign, std::move(cell)), {}, {}, 0, {}, {}, {}, {}};
    complete(problem.request, Criterion::V, campaign.seed);
    problem.request.has_prior = campaign.spread.is_prior;
    if (problem.request.repeats == 0) problem.request.repeats = 1;
    problem.search.criterion = problem.request.criterion;
    if (options.starts > 0) problem.search.starts = options.starts;
    problem.request.starts = problem.search.starts;
    problem.search.seed = problem.request.seed.value();
    problem.search.nuisance = nuisance_of(options.focus, campaign);
    if (prior_count(campaign) > 0) hold(problem, prior_rows(campaign), {});
    if (options.held) {
        hold(problem, measured_blocks(campaign, campaign.nominal, *options.held).matrix,
             options.held->configurations);
        problem.measured_count = options.held->configuration_count();
        problem.measured_ids = options.held->ids;
        problem.search.held_pose_count += problem.measured_count;
    }
    if (options.repaired) hold_kept(problem, *options.repaired);
    return problem;
}

void count_new_poses(PlanningProblem& problem, const StopSignal& stop) {
    const auto kept = static_cast<Index>(problem.kept.size());
    Index& count = problem.request.pose_count;
    if (count == 0) count = kept + static_cast<Index>(problem.request.dropped.size());
    if (count <= kept) {
        throw InputError(
            fmt::format("`pose_count` is {}, must be above {}, as many as are kept of {}", count,
                        kept, problem.request.sources.repaired));
    }
    problem.search.pose_count = count - kept;
    compute_from(problem.request.sources.campaign, [&] {
        check_enough_poses(problem.campaign, count, problem.measured_count, stop);
    });
}

std::optional<Box> workspace_box(const PlanRequest& request) {
    const auto& box = request.workspace_box_mm;
    if (box.empty()) return std::nullopt;
    if (box.size() != 6) {
        throw InputError("`workspace_box_mm` has " + std::to_string(box.size()) +
                         " numbers; must have 6, least x, y, z, then largest");
    }
    return Box{Vector3d(box[0], box[1], box[2]) / mm_per_m,
               Vector3d(box[3], box[4], box[5]) / mm_per_m};
}

RowMatrixXd workspace_of(const PlanningProblem& problem, const PlanningOptions& options) {
    const PlanRequest& request = problem.request;
    if (options.workspace.rows() > 0) return options.workspace;
    return workspace_configurations(problem.campaign, workspace_box(request),
                                    request.workspace_count, request.seed.value() + 1);
}

void draw_workspace(PlanningProblem& problem, const PlanningOptions& options) {
    problem.workspace = workspace_of(problem, options);
    problem.errors = make_position_errors(problem.campaign, problem.workspace,
                                          problem.request.workspace_target - 1);
}

RowMatrixXd configurations_of(const std::vector<PlannedPose>& poses, Index joint_count) {
    RowMatrixXd configurations(static_cast<Index>(poses.size()), joint_count);
    for (Index i = 0; i < configurations.rows(); ++i) {
        configurations.row(i) = poses[static_cast<std::size_t>(i)].configuration.transpose();
    }
    return configurations;
}

PlannedPose pose_at(const PlanningProblem& problem, std::string id, const VectorXd& configuration) {
    PlannedPose pose;
    pose.id = std::move(id);
    pose.configuration = configuration;
    pose.targets = targets_seen(problem.constraints.seen(configuration));
    pose.clearance = least_clearance(problem, configuration);
    return pose;
}

std::optional<Clearance> least_clearance(const PlanningProblem& problem,
                                         const VectorXd& configuration) {
    Clearance nearest = problem.constraints.nearest(configuration);
    return nearest.body.empty() ? std::nullopt : std::optional(std::move(nearest));
}

Seen seen_at(const std::vector<PlannedPose>& poses, Index target_count) {
    Seen is_seen(static_cast<Index>(poses.size()), target_count);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        is_seen.row(static_cast<Index>(i)) = seen_targets(poses[i].targets, is_seen.cols());
    }
    return is_seen;
}

Blocks blocks_of(const PlanningProblem& problem, const std::vector<PlannedPose>& poses) {
    const Campaign& campaign = problem.campaign;
    return make_blocks(
        campaign, campaign.nominal, configurations_of(poses, campaign.robot.joint_count()),
        times_seen(seen_at(poses, campaign.sensor->target_count()), problem.request.repeats));
}

MatrixXd held_information(const PlanningProblem& problem) {
    const RowMatrixXd& rows = problem.search.held.rows;
    const Index kept = problem.kept.empty() ? 0 : blocks_of(problem, problem.kept).matrix.rows();
    return information_of(rows.topRows(rows.rows() - kept), parameter_count(problem.campaign));
}

std::string with_unit(const std::string& name, const AmountUnits& units) {
    return units.si.empty() ? name : fmt::format("{}_{}", name, units.si);
}

std::vector<NamedNumber> standard_deviations(const Campaign& campaign, const MatrixXd& M) {
    const MatrixXd covariance = M.llt().solve(MatrixXd::Identity(M.rows(), M.cols()));
    const VectorXd deviations =
        covariance.diagonal().cwiseSqrt().cwiseProduct(parameter_scale(campaign));
    const auto names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    std::vector<NamedNumber> named;
    for (std::size_t k = 0; k < names.size(); ++k) {
        named.push_back({with_unit(names[k], *units[k]), deviations[static_cast<Index>(k)]});
    }
    return named;
}

std::string describe_violation(const PlanningProblem& problem, const PlannedPose& pose) {
    const Constraints& constraints = problem.constraints;
    const VectorXd& q = pose.configuration;
    const std::string violation = posewise::describe_violation(constraints, q, Stop::Measured);
    if (!violation.empty()) return violation;
    const SeenTargets is_seen = constraints.seen(q);
    const std::vector<std::string> contacts = problem.campaign.sensor->contact_names();
    for (const Index target : pose.targets) {
        if (is_seen[target]) continue;
        return contacts.empty() ? fmt::format("does not show target {}", target + 1)
                                : "does not touch " + contacts[static_cast<std::size_t>(target)];
    }
    return pose.targets.empty() ? "shows no target" : "";
}

}  // namespace posewise::detail
