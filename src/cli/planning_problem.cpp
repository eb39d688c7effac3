#include "planning_problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common.hpp"
#include "measured.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/text.hpp"
#include "posewise/core/units.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/model/joint_limits.hpp"
#include "posewise/planner/tour.hpp"

namespace posewise::cli {
namespace {

constexpr Index draws_per_workspace_pose = 20;
/// New poses keep so far from those that could not be reached (some joint, rad).
constexpr double distance_from_dropped = to_radians(5);

// ---- Poses measured already ----

void settle_base(Campaign& campaign, const std::optional<Measurements>& measured) {
    if (campaign.has_nominal_base && campaign.has_nominal_targets) return;
    if (!measured) {
        const std::string key = campaign.sensor->words().key;
        throw InputError(campaign.name + ": the campaign file states no " +
                         (campaign.has_nominal_base ? key : "base") + "; must state base and " +
                         key + " to plan, or measured poses (--augment) must tell them");
    }
    campaign.nominal = determined(register_base_and_targets(campaign, *measured));
    campaign.nominal.robot.setZero();
    campaign.has_nominal_base = campaign.has_nominal_targets = true;
}

// ---- Information held ----

void hold(PlanningProblem& problem, const MatrixXd& information, const RowMatrixXd& poses) {
    HeldPoses& held = problem.options.held;
    const Index L = parameter_count(problem.campaign);
    if (held.information.size() == 0) held.information.setZero(L, L);
    held.information += information;
    RowMatrixXd all(held.configurations.rows() + poses.rows(),
                    problem.campaign.robot.joint_count());
    if (held.configurations.rows() > 0)
        all.topRows(held.configurations.rows()) = held.configurations;
    if (poses.rows() > 0) all.bottomRows(poses.rows()) = poses;
    held.configurations = std::move(all);
}

void hold_measured(PlanningProblem& problem, const Measurements& measured) {
    hold(
        problem,
        information(make_blocks(problem.campaign, problem.campaign.nominal, measured.configurations,
                                mean_repeats(measured) * share_seen(measured))),
        measured.configurations);
    problem.measured_count = measured.configuration_count();
    problem.options.held_pose_count += problem.measured_count;
}

RowMatrixXd configurations_of(const std::vector<io::ContinuousPose>& poses, Index joint_count) {
    RowMatrixXd configurations(static_cast<Index>(poses.size()), joint_count);
    for (Index i = 0; i < configurations.rows(); ++i) {
        configurations.row(i) = poses[static_cast<std::size_t>(i)].joints.transpose();
    }
    return configurations;
}

/// Throws InputError for a pose that cannot be measured.
void check_kept(const PlanningProblem& problem, const io::ContinuousPose& pose) {
    std::string fault = describe_violation(problem.constraints, pose.joints);
    if (pose.visible.empty()) fault = "shows no target";
    if (fault.empty()) return;
    throw input_error_at({problem.request.repaired},
                         fmt::format("pose {} {}; find another for it with --drop {}",
                                     quote(pose.id), fault, pose.id));
}

/// Keeps the poses of a plan but those dropped, which new poses only must stay away from.
void hold_kept(PlanningProblem& problem, std::vector<io::ContinuousPose> poses) {
    const Campaign& campaign = problem.campaign;
    const Index joints = campaign.robot.joint_count();
    const auto& ids = problem.request.dropped;
    for (const std::string& id : ids) {
        const auto has_id = [&](const auto& pose) { return pose.id == id; };
        if (std::none_of(poses.begin(), poses.end(), has_id)) {
            throw InputError(
                fmt::format("--drop {}: {} has no such pose", id, problem.request.repaired));
        }
    }
    const auto dropped = std::stable_partition(poses.begin(), poses.end(), [&](const auto& pose) {
        return std::find(ids.begin(), ids.end(), pose.id) == ids.end();
    });
    const std::vector<io::ContinuousPose> away(dropped, poses.end());
    poses.erase(dropped, poses.end());
    for (const io::ContinuousPose& pose : poses) check_kept(problem, pose);
    const Index L = parameter_count(campaign);
    hold(problem, MatrixXd::Zero(L, L), configurations_of(away, joints));
    for (io::ContinuousPose& pose : poses) pose.is_kept = true;
    problem.kept = std::move(poses);
    if (problem.kept.empty()) return;
    const RowMatrixXd configurations = configurations_of(problem.kept, joints);
    hold(problem, information(blocks_of(problem, problem.kept)), configurations);
    problem.options.held_pose_count += configurations.rows();
}

// ---- How many, and where it matters ----

void count_new_poses(PlanningProblem& problem, Index asked_for) {
    const auto kept = static_cast<Index>(problem.kept.size());
    const Index count =
        asked_for > 0 ? asked_for : kept + static_cast<Index>(problem.request.dropped.size());
    if (count <= kept) {
        throw InputError(fmt::format("--poses is {}, must be above {}, as many as are kept of {}",
                                     count, kept, problem.request.repaired));
    }
    problem.options.pose_count = count - kept;
    if (problem.options.held.information.size() > 0) return;  // selection says if it is too few
    const Index least = least_pose_count(problem.campaign);
    if (count < least) {
        throw InputError(
            fmt::format("--poses is {}, must be at least {}: fewer do not identify {} "
                        "parameters; or let --prior tell the rest",
                        count, least, parameter_count(problem.campaign)));
    }
}

RowMatrixXd find_workspace(const io::PosePlanRequest& request, const io::CampaignFile& file) {
    const Campaign& campaign = file;
    if (!request.workspace.empty()) return io::read_configurations(request.workspace, file).joints;
    Cell cell = file.cell;
    cell.sight.reset();  // the robot works where the tracker sees nothing, too
    if (const auto& box = request.workspace_box_mm; !box.empty()) {
        cell.target_boxes = {{Vector3d(box[0], box[1], box[2]) / mm_per_m,
                              Vector3d(box[3], box[4], box[5]) / mm_per_m}};
    }
    const Index count = request.workspace_count;
    try {
        const Pool pool = make_pool(Constraints(campaign, std::move(cell)),
                                    draws_per_workspace_pose * count, request.seed + 1);
        return pool.configurations.topRows(std::min(count, pool.configurations.rows()));
    } catch (const InputError& error) {
        throw InputError(std::string("workspace: ") + error.what());
    }
}

io::PosePlanRequest complete_request(const PlanningArguments& arguments,
                                     const io::CampaignFile& file) {
    io::PosePlanRequest request = arguments.request;
    request.seed = arguments.seed.value_or(file.seed);
    request.has_prior = arguments.prior.value_or(file.spread.is_prior);
    request.criterion = !arguments.criterion.empty()  ? parse_criterion(arguments.criterion)
                        : request.is_focused_on_robot ? Criterion::D
                                                      : Criterion::V;
    return request;
}

void apply_options(PlanningProblem& problem) {
    PlanOptions& options = problem.options;
    options.criterion = problem.request.criterion;
    options.starts = problem.request.starts;
    options.seed = problem.request.seed;
    if (problem.request.is_focused_on_robot) {
        options.nuisance = nuisance_of_robot(problem.campaign);
    }
}

struct StatedProblem {
    PlanningProblem problem;
    io::CampaignFile file;
};

/// All but pool, poses to keep and workspace.
StatedProblem state_problem(const PlanningArguments& arguments) {
    io::CampaignFile file = io::read_campaign(arguments.request.campaign);
    check_torques_known(file.path, file.robot);
    const io::PosePlanRequest request = complete_request(arguments, file);
    std::optional<Measurements> measured;
    if (!request.augment.empty()) {
        measured = read_measured(request.augment, file);
        check_is_of_robot(file, *measured, request.augment);
    }
    file.spread.is_prior = request.has_prior;
    settle_base(file, measured);
    Cell cell = file.cell;
    if (!request.repaired.empty()) {
        cell.least_joint_distance = std::max(cell.least_joint_distance, distance_from_dropped);
    }
    const Campaign& campaign = file;
    PlanningProblem problem{request, campaign, Constraints(campaign, std::move(cell)), {}, {}, 0, 0,
                            {},      {}};
    apply_options(problem);
    if (request.has_prior) hold(problem, prior_information(campaign), {});
    if (measured) hold_measured(problem, *measured);
    return {std::move(problem), std::move(file)};
}

void draw_workspace(PlanningProblem& problem, const io::CampaignFile& file) {
    const RowMatrixXd workspace = find_workspace(problem.request, file);
    problem.workspace_count = workspace.rows();
    problem.prediction = make_prediction_blocks(problem.campaign, problem.campaign.nominal,
                                                workspace, problem.request.workspace_target - 1);
}

}  // namespace

PlanningProblem read_planning_problem(const PlanningArguments& arguments, const StopSignal& stop) {
    auto [problem, file] = state_problem(arguments);
    if (!problem.request.repaired.empty()) {
        hold_kept(problem, io::read_pose_plan(problem.request.repaired, problem.campaign).poses);
    }
    count_new_poses(problem, arguments.pose_count);
    problem.pool =
        make_pool(problem.constraints, problem.request.pool_count, problem.request.seed, stop);
    problem.request.pool_count = problem.pool.candidate_count;
    check_memory(problem.campaign, problem.pool.configurations.rows(), "--pool");
    plan_tour(problem.constraints, problem.pool.configurations.topRows(1));  // throws early if home
    draw_workspace(problem, file);
    return std::move(problem);
}

PlanningProblem state_planning_problem(const PlanningArguments& arguments) {
    auto [problem, file] = state_problem(arguments);
    draw_workspace(problem, file);
    return std::move(problem);
}

Blocks blocks_of(const PlanningProblem& problem, const std::vector<io::ContinuousPose>& poses) {
    const Campaign& campaign = problem.campaign;
    Seen is_seen(static_cast<Index>(poses.size()), campaign.sensor->target_count());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        is_seen.row(static_cast<Index>(i)) = seen_targets(poses[i].visible, is_seen.cols());
    }
    return make_blocks(campaign, campaign.nominal,
                       configurations_of(poses, campaign.robot.joint_count()),
                       times_seen(is_seen, problem.request.repeats));
}

std::string describe_violation(const Constraints& constraints, const VectorXd& q) {
    constexpr double rounding = 1e-9;  // m or rad
    const std::string beyond = describe_limit_violation(constraints.robot(), q);
    if (!beyond.empty()) return "is beyond the joint limits (less their margin): " + beyond;
    const ConstraintReport report = constraints.check(q);
    for (std::size_t k = 0; k < constraint_count; ++k) {
        const auto constraint = static_cast<Constraint>(k);
        if (report[constraint] >= -rounding || constraint == Constraint::JointLimits) continue;
        return std::string("does not meet ") + constraint_name(constraint);
    }
    return "";
}

std::vector<Index> visible_targets(const PlanningProblem& problem, const VectorXd& q) {
    return targets_seen(problem.constraints.seen(q));
}

}  // namespace posewise::cli
