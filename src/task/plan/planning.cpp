#include "posewise/task/planning.hpp"

#include <fmt/format.h>

#include "left_out.hpp"
#include "plan_maker.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {

Planning make_plan(const Campaign& campaign, const PlanningOptions& options) {
    detail::PlanningProblem problem = detail::state_planning(campaign, options);
    detail::count_new_poses(problem, options.stop);
    const Index count = problem.search.pose_count;
    const Index all = problem.request.pose_count;
    if (options.drop_out_count > 1 && options.drop_out_count >= all) {
        throw InputError(fmt::format("{} poses that may be missing leave none of {}; must be fewer",
                                     options.drop_out_count, all));
    }
    const detail::PlanMaker maker(std::move(problem), options);
    Planning planning = maker.make(count, [](const Planning&) { return true; });
    maker.add_verification(planning);
    detail::judge_left_out(planning, options);
    return planning;
}

Planning judge_again(const Plan& plan, const Campaign& campaign, const PlanningOptions& options) {
    const PlanningOptions made = detail::options_of(plan, options);
    detail::PlanningProblem problem = detail::state_planning(campaign, made);
    detail::draw_workspace(problem, made);
    Planning judged;
    judged.plan = plan;
    judged.tour.time = plan.visiting_time;
    for (const PlannedPose& pose : plan.poses) {
        if (pose.is_blocked) ++judged.tour.blocked_count;
        if (!pose.is_kept) ++judged.search.pose_count;
    }
    judged.measured_count = problem.measured_count;
    judged.workspace_count = problem.workspace.rows();
    judged.campaign = problem.campaign;
    judged.errors = problem.errors;
    judged.information =
        held_information(problem) + information(detail::blocks_of(problem, plan.poses));
    judged.plan.value_rms = detail::value_rms_of(problem, plan.value);
    detail::conclude(judged, problem, options.drop_out_count);
    return judged;
}

}  // namespace posewise
