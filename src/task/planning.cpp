#include "posewise/task/planning.hpp"

#include <cmath>
#include <set>

#include "../planner/tour.hpp"
#include "inputs.hpp"
#include "planning_problem.hpp"

namespace posewise {
namespace {

using detail::PlanningProblem;

PlannedPoses search(const PlanningProblem& problem, const Pool& pool,
                    const PlanningOptions& options) {
    PlanOptions search = problem.search;
    if (needs_test_poses(search.criterion)) search.test_poses = &problem.prediction;
    search.stop = options.stop;
    search.progress = options.progress;
    return plan_poses(problem.campaign, problem.constraints, pool, problem.request.repeats, search);
}

/// p1, p2, ... but for those that poses kept or dropped have.
class NewIds {
  public:
    explicit NewIds(const PlanningProblem& problem)
        : taken_(problem.request.dropped.begin(), problem.request.dropped.end()) {
        for (const PlannedPose& pose : problem.kept) taken_.insert(pose.id);
    }
    std::string next() {
        std::string id;
        do id = 'p' + std::to_string(++last_);
        while (taken_.count(id) > 0);
        return id;
    }

  private:
    std::set<std::string> taken_;
    int last_ = 0;
};

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
    NewIds ids(problem);
    std::vector<PlannedPose> arranged;
    const auto kept = static_cast<Index>(problem.kept.size());
    for (const Visit& visit : tour.visits) {
        PlannedPose pose;
        if (visit.pose < kept) {
            pose = problem.kept[static_cast<std::size_t>(visit.pose)];
        } else {
            pose.id = ids.next();
            pose.configuration = poses.row(visit.pose).transpose();
            pose.targets = targets_seen(problem.constraints.seen(pose.configuration));
        }
        pose.via = visit.via;
        pose.is_blocked = visit.is_blocked;
        arranged.push_back(std::move(pose));
    }
    return arranged;
}

Plan make_result(const PlanningProblem& problem, const PlannedPoses& planned, const Pool& pool,
                 const Tour& tour) {
    const Campaign& campaign = problem.campaign;
    Plan plan;
    plan.campaign = campaign.name;
    plan.columns = configuration_columns(campaign);
    plan.poses = arrange(problem, all_poses(problem, planned.configurations), tour);
    plan.request = problem.request;
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
    plan.ending = Ending::Converged;
    plan.predicted = predict_accuracy(problem.prediction, planned.information, campaign);
    if (needs_test_poses(plan.request.criterion)) {
        const auto positions = static_cast<double>(problem.prediction[0].rows()) / 3;
        plan.value_rms = 1 / std::sqrt(plan.value * positions);
    }
    plan.standard_deviations = detail::standard_deviations(campaign, planned.information);
    plan.visiting_time = tour.time;
    plan.assumptions = assumptions_of(campaign);
    return plan;
}

}  // namespace

Planning make_plan(const Campaign& campaign, const PlanningOptions& options) {
    PlanningProblem problem = detail::state_planning(campaign, options);
    detail::count_new_poses(problem, options.stop);
    const Index asked_for = problem.request.pool_count;
    Pool pool =
        make_pool(problem.constraints, asked_for, options.seed, options.stop.with_half_the_time());
    problem.request.pool_count = pool.candidate_count;
    detail::check_memory(problem.campaign, pool.configurations.rows(), "--pool");
    detail::plan_tour(problem.constraints, pool.configurations.topRows(1));  // throws early if home
    detail::draw_workspace(problem, options);
    const PlannedPoses planned = search(problem, pool, options);
    detail::TourOptions tour_options;
    tour_options.order.seed = options.seed;
    Tour tour =
        plan_tour(problem.constraints, all_poses(problem, planned.configurations), tour_options);
    Plan plan = make_result(problem, planned, pool, tour);
    if (planned.is_interrupted || pool.candidate_count < asked_for) {
        plan.ending = options.stop.is_interrupted() ? Ending::Interrupted : Ending::TimeLimit;
    }
    return {std::move(plan),
            std::move(pool),
            std::move(tour),
            problem.measured_count,
            problem.workspace_count,
            std::move(problem.campaign),
            std::move(problem.prediction),
            std::move(problem.search)};
}

}  // namespace posewise
