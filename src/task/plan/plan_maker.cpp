#include "plan_maker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "new_ids.hpp"
#include "planner/plan_space.hpp"
#include "planner/tour.hpp"
#include "pool_choices.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/calibration.hpp"
#include "task/calibration/expected_distance.hpp"
#include "task/calibration/inputs.hpp"
#include "verification_poses.hpp"

namespace posewise::detail {
namespace {

/// The poses kept, then the new ones.
RowMatrixXd all_poses(const PlanningProblem& problem, const RowMatrixXd& planned) {
    const auto kept = static_cast<Index>(problem.kept.size());
    RowMatrixXd poses(kept + planned.rows(), planned.cols());
    poses.topRows(kept) = detail::configurations_of(problem.kept, planned.cols());
    poses.bottomRows(planned.rows()) = planned;
    return poses;
}

/// All poses in the order of the tour; new ones are named in it.
std::vector<PlannedPose> arrange(const PlanningProblem& problem, const RowMatrixXd& poses,
                                 const Tour& tour) {
    NewIds ids('p', problem);
    std::vector<PlannedPose> arranged;
    const auto kept = static_cast<Index>(problem.kept.size());
    for (const Visit& visit : tour.visits) {
        PlannedPose pose;
        if (visit.pose < kept) {
            pose = problem.kept[static_cast<std::size_t>(visit.pose)];
        } else {
            pose = pose_at(problem, ids.next(), poses.row(visit.pose).transpose());
        }
        pose.clearance = least_clearance(problem, pose.configuration);
        pose.via = visit.via;
        pose.is_blocked = visit.is_blocked;
        arranged.push_back(std::move(pose));
    }
    return arranged;
}

/// Whether two planned poses, or one and a measured one, differ by less in every joint.
bool has_repeats(const RowMatrixXd& planned, const RowMatrixXd& measured, double distance) {
    for (Index i = 0; i < planned.rows(); ++i) {
        if (!is_apart(planned.topRows(i), planned.row(i), distance) ||
            !is_apart(measured, planned.row(i), distance)) {
            return true;
        }
    }
    return false;
}

bool has_model_error(const Campaign& campaign) {
    return campaign.model_error > 0 || campaign.model_error_orientation > 0;
}

Plan make_result(const PlanningProblem& problem, const PlannedPoses& planned, const Pool& pool,
                 const Tour& tour) {
    const Campaign& campaign = problem.campaign;
    Plan plan;
    plan.campaign = campaign.name;
    plan.columns = configuration_columns(campaign);
    plan.poses = arrange(problem, all_poses(problem, planned.configurations), tour);
    plan.request = problem.request;
    plan.request.pose_count = static_cast<Index>(plan.poses.size());
    plan.value = planned.value;
    plan.kind = CandidateKind::Pool;
    plan.candidate_count = pool.configurations.rows();
    plan.choice_value = planned.pool_choice.value;
    plan.bound = planned.pool_choice.bound;
    plan.efficiency = planned.pool_choice.efficiency;
    plan.searched_bound = planned.searched_bound;
    plan.searched_efficiency = planned.efficiency;
    plan.request.starts = planned.starts;
    plan.starts_at_best = planned.starts_at_best;
    plan.value_rms = value_rms_of(problem, plan.value);
    plan.visiting_time = tour.time;
    plan.assumptions = assumptions_of(campaign);
    const std::string unchecked = describe_unchecked_bodies(campaign);
    if (!unchecked.empty()) plan.cell_doubts.push_back(unchecked);
    if (has_model_error(campaign) &&
        has_repeats(planned.configurations, problem.search.held.configurations,
                    distance_from_others)) {
        plan.cell_doubts.push_back(
            fmt::format("no plan was found whose poses are {:g} deg apart in some joint; where two "
                        "are nearer, what the model lacks is counted as independent but is not",
                        to_degrees(distance_from_others)));
    }
    return plan;
}

/// Returns nothing where no pixels are measured, or no error of the robot is sought.
std::optional<RobotError> predict_robot_alone(const PlanningProblem& problem, const MatrixXd& M) {
    const Campaign& campaign = problem.campaign;
    if (!campaign.sensor->has_pixels() || campaign.robot.parameter_count() == 0) {
        return std::nullopt;
    }
    Estimate estimate = uncalibrated(campaign, campaign.nominal);
    const double nominal = expected_robot_error(campaign, estimate, problem.workspace).calibrated;
    const VectorXd scale = parameter_scale(campaign);
    estimate.covariance = scale.asDiagonal() *
                          M.llt().solve(MatrixXd::Identity(M.rows(), M.cols())) *
                          scale.asDiagonal();
    return RobotError{nominal,
                      expected_robot_error(campaign, estimate, problem.workspace).calibrated};
}

}  // namespace

void conclude(Planning& planning, const PlanningProblem& problem, Index drop_out_count) {
    const Campaign& campaign = problem.campaign;
    const std::vector<PlannedPose>& poses = planning.plan.poses;
    const double repeats = planning.plan.request.repeats;
    const Blocks& prediction = problem.errors.by_parameters;
    const Blocks blocks = blocks_of(problem, poses);
    MatrixXd left = planning.information;
    planning.by_noise = information_by_noise(
        campaign, campaign.nominal, configurations_of(poses, campaign.robot.joint_count()),
        times_seen(seen_at(poses, campaign.sensor->target_count()), repeats));
    planning.plan.predicted =
        predict_accuracy(problem.errors, planning.information, campaign, planning.by_noise);
    planning.budget =
        make_budget(problem.errors, campaign, planning.information, planning.by_noise);
    planning.without_each = drop_each(prediction, blocks, planning.information);
    planning.drop_outs = drop_worst(prediction, blocks, drop_out_count, left);
    planning.robot_alone = predict_robot_alone(problem, planning.information);
    if (campaign.sensor->has_pixels()) {
        planning.images =
            find_image_coverage(*campaign.sensor, expected_readings(campaign, planning.plan));
    }
    const CampaignTime time =
        campaign_time(problem, planning.tour.time, seen_at(poses, campaign.sensor->target_count()));
    planning.plan.duration = time.total;
    planning.plan.is_target_changed_at_poses = time.is_target_changed_at_poses;
    planning.plan.target_runs = time.target_runs;
}

CampaignTime campaign_time(const PlanningProblem& problem, double moves, const Seen& is_seen) {
    const Cell& cell = problem.campaign.cell;
    const auto count = static_cast<double>(is_seen.rows());
    const double samples = cell.dwell * problem.request.repeats;
    CampaignTime time;
    time.total = moves + count * (cell.settle + samples);
    const Sensor& sensor = *problem.campaign.sensor;
    if (cell.target_change > 0 && sensor.observes_targets() && sensor.target_count() > 1) {
        const auto targets = static_cast<double>(sensor.target_count());
        const auto visible = static_cast<double>(is_seen.count());
        const double in_runs = targets * moves + visible * (cell.settle + samples) +
                               (targets - 1) * cell.target_change;
        const double at_poses = moves + count * cell.settle + visible * samples +
                                (visible - count) * cell.target_change;
        time.is_target_changed_at_poses = at_poses < in_runs;
        if (!time.is_target_changed_at_poses) time.target_runs = sensor.target_count();
        time.total = std::min(in_runs, at_poses);
    }
    const auto stations = static_cast<double>(cell.stations);
    time.total = stations * time.total + (stations - 1) * cell.station_change;
    return time;
}

std::optional<double> value_rms_of(const PlanningProblem& problem, double value) {
    if (!needs_test_poses(problem.request.criterion)) return std::nullopt;
    const auto positions = static_cast<double>(problem.errors.by_parameters[0].rows()) / 3;
    return 1 / std::sqrt(value * positions);
}

PlanMaker::PlanMaker(PlanningProblem problem, const PlanningOptions& options)
    : problem_(std::move(problem)), options_(options) {
    const Index asked_for = problem_.request.pool_count;
    pool_ = make_pool(problem_.constraints, asked_for, problem_.request.seed.value(),
                      options.stop.with_half_the_time());
    is_pool_complete_ = pool_.candidate_count >= asked_for;
    problem_.request.pool_count = pool_.candidate_count;
    check_memory(problem_.campaign, pool_.configurations.rows(), "pool_count");
    plan_tour(problem_.constraints, pool_.configurations.topRows(1));  // throws early if home
    draw_workspace(problem_, options);
}

PlanMaker::Candidates PlanMaker::candidates(Index pool_part) const {
    const Campaign& campaign = problem_.campaign;
    const double repeats = problem_.request.repeats;
    const RowMatrixXd configurations = pool_.configurations.topRows(pool_part);
    return {make_design_space(campaign, campaign.nominal, repeats, &problem_.constraints),
            configurations,
            make_blocks(campaign, campaign.nominal, configurations,
                        times_seen(pool_.is_seen.topRows(pool_part), repeats))};
}

PlanOptions PlanMaker::search_for(Index pose_count) const {
    check_pool_size(pool_, pose_count);
    PlanOptions search = problem_.search;
    search.pose_count = pose_count;
    search.bound_iterations = 0;
    if (needs_test_poses(search.criterion)) search.test_poses = &problem_.errors.by_parameters;
    search.stop = options_.stop;
    return search;
}

Planning PlanMaker::make(Index pose_count,
                         const std::function<bool(const Planning&)>& needs_bound) const {
    PlanOptions search = search_for(pose_count);
    search.progress = options_.progress;
    Candidates from = candidates(pool_.configurations.rows());
    PlannedPoses planned = plan_apart(from, search);
    Planning planning = finish(search, planned);
    planning.chosen = predict_choice(planned.pool_choice.poses, from.blocks);
    if (!needs_bound(planning)) return planning;
    search.bound_iterations = problem_.search.bound_iterations;
    add_searched_bound(from.space, from.configurations, from.blocks, search, planned);
    planning.plan.searched_bound = planned.searched_bound;
    planning.plan.searched_efficiency = planned.efficiency;
    if (!planning.tour.is_cut_short) planning.plan.ending = ending_of(planned);
    return planning;
}

PredictedAccuracy PlanMaker::predict_choice(const std::vector<Index>& poses,
                                            const Blocks& blocks) const {
    const RowMatrixXd repeats =
        times_seen(Seen(pool_.is_seen(poses, Eigen::all)), problem_.request.repeats);
    return predict_accuracy(
        problem_.errors,
        information_of(problem_.search.held.rows, blocks.parameter_count()) +
            information(blocks, poses),
        problem_.campaign,
        information_by_noise(problem_.campaign, problem_.campaign.nominal,
                             RowMatrixXd(pool_.configurations(poses, Eigen::all)), repeats));
}

Planning PlanMaker::make_quickly(Index pose_count) const {
    PlanOptions search = search_for(pose_count);
    search.starts = 1;
    Candidates from = candidates(
        std::min(pool_.configurations.rows(), std::max(quick_pool_part, 2 * pose_count)));
    return finish(search, plan_apart(from, search));
}

PlannedPoses PlanMaker::plan_apart(Candidates& from, const PlanOptions& search) const {
    PlannedPoses planned = plan_poses(from.space, from.configurations, from.blocks, search);
    const RowMatrixXd& measured = search.held.configurations;
    if (from.space.least_joint_distance >= distance_from_others ||
        !has_model_error(problem_.campaign) ||
        !has_repeats(planned.configurations, measured, distance_from_others)) {
        return planned;
    }
    constexpr double least = to_radians(0.5);
    for (double distance = distance_from_others; distance > least; distance /= 2) {
        from.space.least_joint_distance = distance;
        try {
            return plan_poses(from.space, from.configurations, from.blocks, search);
        } catch (const InputError&) {
            // So many poses so far apart were not found.
        }
    }
    return planned;
}

void PlanMaker::add_verification(Planning& planning) const {
    detail::add_verification(problem_, pool_, options_, planning);
}

Ending PlanMaker::ending_of(const PlannedPoses& planned) const {
    if (!planned.is_interrupted && is_pool_complete_) return Ending::Converged;
    return options_.stop.is_interrupted() ? Ending::Interrupted : Ending::TimeLimit;
}

Planning PlanMaker::finish(PlanOptions search, const PlannedPoses& planned) const {
    TourOptions tour_options;
    tour_options.order.seed = problem_.request.seed.value();
    tour_options.random_order = problem_.request.random_order;
    tour_options.stop = options_.stop;
    Tour tour =
        plan_tour(problem_.constraints, all_poses(problem_, planned.configurations), tour_options);
    Plan plan = make_result(problem_, planned, pool_, tour);
    plan.ending =
        tour.is_cut_short ? options_.stop.ending_or(Ending::TimeLimit) : ending_of(planned);
    search.progress = {};
    search.test_poses = nullptr;
    search.bound_iterations = problem_.search.bound_iterations;
    Planning planning;
    planning.plan = std::move(plan);
    planning.pool = pool_;
    planning.tour = std::move(tour);
    planning.measured_count = problem_.measured_count;
    planning.workspace_count = problem_.workspace.rows();
    planning.campaign = problem_.campaign;
    planning.errors = problem_.errors;
    planning.search = std::move(search);
    // As verify() sums it, so that no digit depends on the order of the poses.
    planning.information =
        held_information(problem_) + information(blocks_of(problem_, planning.plan.poses));
    planning.plan.standard_deviations =
        standard_deviations(problem_.campaign, planning.information);
    conclude(planning, problem_, options_.drop_out_count);
    return planning;
}

}  // namespace posewise::detail
