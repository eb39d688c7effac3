#include "posewise/task/planning.hpp"

#include "plan_maker.hpp"

namespace posewise {

Planning make_plan(const Campaign& campaign, const PlanningOptions& options) {
    detail::PlanningProblem problem = detail::state_planning(campaign, options);
    detail::count_new_poses(problem, options.stop);
    const Index count = problem.search.pose_count;
    return detail::PlanMaker(std::move(problem), options).make(count, [](const Planning&) {
        return true;
    });
}

}  // namespace posewise
