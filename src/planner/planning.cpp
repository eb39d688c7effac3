#include "posewise/planner/planning.hpp"

#include "plan_space.hpp"
#include "posewise/core/errors.hpp"
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

std::vector<Index> nuisance_of(Focus focus, const Campaign& campaign) {
    if (focus == Focus::All) return {};
    const Index robot_begin = base_parameter_count(campaign);
    const Index robot_end = robot_begin + campaign.robot.parameter_count();
    const auto units = campaign.sensor->unknown_units();
    const Index place_begin = robot_end + campaign.sensor->unknown_sizes().size();
    const auto counts = [&](Index k) {
        if (focus == Focus::Robot) return k >= robot_begin && k < robot_end;
        if (k < place_begin) return false;
        const AmountUnits* const unit = units[static_cast<std::size_t>(k - robot_end)];
        return unit != &pixel_units && unit != &plain_units;
    };
    std::vector<Index> nuisance;
    for (Index k = 0; k < parameter_count(campaign); ++k) {
        if (!counts(k)) nuisance.push_back(k);
    }
    if (std::ssize(nuisance) < parameter_count(campaign)) return nuisance;
    throw InputError(focus == Focus::Robot
                         ? "`focus` is robot, whose errors are none; must be all or place"
                         : "`focus` is place, but nothing of the sensor's place is "
                           "unknown; must be all or robot");
}

}  // namespace posewise
