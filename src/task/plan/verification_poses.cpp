#include "verification_poses.hpp"

#include <algorithm>
#include <numeric>

#include "new_ids.hpp"
#include "planner/tour.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {
namespace {

/// What they are drawn from: where the robot shall be accurate, as far as it can be measured there.
RowMatrixXd candidates(const PlanningProblem& problem, const Pool& pool,
                       const PlanningOptions& options) {
    const PlanRequest& request = problem.request;
    const bool is_stated = options.workspace.rows() > 0 || !request.workspace_box_mm.empty();
    if (!is_stated || problem.constraints.needs_contact()) return pool.configurations;
    return filter_pool(problem.constraints, workspace_of(problem, options)).configurations;
}

std::vector<Index> in_random_order(Index count, std::uint64_t seed) {
    constexpr std::uint64_t item = 0x766572696679;  // draws of other kinds have small numbers
    RandomStream stream(seed, item);
    std::vector<Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), Index{0});
    for (Index k = count - 1; k > 0; --k) {
        std::swap(order[static_cast<std::size_t>(k)],
                  order[static_cast<std::size_t>(stream.index(k + 1))]);
    }
    return order;
}

/// Configurations to keep away from.
std::vector<VectorXd> others_of(const PlanningProblem& problem, const Plan& plan) {
    std::vector<VectorXd> others;
    for (const PlannedPose& pose : plan.poses) others.push_back(pose.configuration);
    const RowMatrixXd& held = problem.search.held.configurations;
    for (Index i = 0; i < held.rows(); ++i) others.push_back(held.row(i).transpose());
    return others;
}

/// Those kept, then new ones: as many as there are up to `count`.
std::vector<PlannedPose> draw(const PlanningProblem& problem, const RowMatrixXd& from, Index count,
                              std::vector<VectorXd> others) {
    const double least = verification_distance(problem);
    std::vector<PlannedPose> poses = problem.kept_to_verify;
    for (PlannedPose& pose : poses) pose.is_kept = true;
    NewIds ids('v', problem);
    for (const Index i : in_random_order(from.rows(), problem.request.seed.value())) {
        if (std::ssize(poses) >= count) break;
        const VectorXd q = from.row(i).transpose();
        const auto is_near = [&](const VectorXd& other) {
            return joint_distance(q, other) < least;
        };
        if (std::ranges::any_of(others, is_near)) continue;
        poses.push_back(pose_at(problem, ids.next(), q));
        others.push_back(q);
    }
    return poses;
}

}  // namespace

double verification_distance(const PlanningProblem& problem) {
    return std::max(problem.constraints.cell().least_joint_distance, distance_from_others);
}

void add_verification(const PlanningProblem& problem, const Pool& pool,
                      const PlanningOptions& options, Planning& planning) {
    Plan& plan = planning.plan;
    Index& count = plan.request.verification_count;
    count = std::max<Index>(count, std::ssize(problem.kept_to_verify));
    if (count == 0) return;
    const std::vector<PlannedPose> poses =
        draw(problem, candidates(problem, pool, options), count, others_of(problem, plan));
    TourOptions tour_options;
    tour_options.order.seed = problem.request.seed.value();
    tour_options.random_order = problem.request.random_order;
    tour_options.start = plan.poses.back().configuration;
    const Tour tour =
        plan_tour(problem.constraints,
                  configurations_of(poses, problem.campaign.robot.joint_count()), tour_options);
    plan.verification.clear();
    for (const Visit& visit : tour.visits) {
        PlannedPose& pose =
            plan.verification.emplace_back(poses[static_cast<std::size_t>(visit.pose)]);
        pose.via = visit.via;
        pose.is_blocked = visit.is_blocked;
    }
    plan.verification_time = tour.time;
}

}  // namespace posewise::detail
