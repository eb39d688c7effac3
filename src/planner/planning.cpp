#include "posewise/planner/planning.hpp"

#include "plan_space.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {

PlannedPoses plan_poses(const Campaign& campaign, const Constraints& constraints, const Pool& pool,
                        double repeats, const PlanOptions& options) {
    check_pool_size(pool, options.pose_count);
    const detail::DesignSpace space =
        detail::make_design_space(campaign, campaign.nominal, repeats, &constraints);
    return plan_poses(space, pool.configurations,
                      make_blocks(campaign, campaign.nominal, pool.configurations,
                                  times_seen(pool.is_seen, repeats)),
                      options);
}

std::vector<Index> nuisance_of_robot(const Campaign& campaign) {
    const Index robot_begin = base_parameter_count(campaign);
    const Index robot_end = robot_begin + campaign.robot.parameter_count();
    std::vector<Index> nuisance;
    for (Index k = 0; k < parameter_count(campaign); ++k) {
        if (k < robot_begin || k >= robot_end) nuisance.push_back(k);
    }
    return nuisance;
}

}  // namespace posewise
