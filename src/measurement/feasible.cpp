#include "feasible.hpp"

#include <algorithm>

#include "model/halton.hpp"
#include "places.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"

namespace posewise::detail {
namespace {

/// The rows of the sequence that are feasible.
Pool keep_feasible(const Constraints& constraints, RowMatrixXd drawn) {
    for (const auto& [joint, value] : constraints.cell().fixed_joints) {
        drawn.col(joint).setConstant(value);
    }
    const Index count = drawn.rows();
    Pool pool = filter_pool(constraints, constraints.bring_to_contacts(drawn, 0));
    pool.candidate_count = count;
    return pool;
}

}  // namespace

ShownPoses draw_feasible(const Campaign& campaign, Index count,
                         const std::function<RowMatrixXd(const Chain& robot, Index count)>& draw) {
    check_places(campaign);
    const Constraints constraints(campaign, campaign.cell);
    const Chain robot = with_margin(campaign.robot, campaign.cell.limit_margin);
    const bool is_free = !constraints.restricts_places() && campaign.cell.fixed_joints.empty();
    if (is_free || constraints.needs_contact()) {
        ShownPoses poses = draw_poses(campaign, campaign.nominal, count,
                                      [&](Index drawn) { return draw(robot, drawn); });
        if (is_free) return poses;
    }
    constexpr Index most = 4000000;  // drawn
    Pool pool;
    for (Index drawn = count;; drawn *= 4) {
        pool = keep_feasible(constraints, draw(robot, std::min(drawn, most)));
        if (pool.configurations.rows() >= count) break;
        if (drawn >= std::max<Index>(1024 * count, 4096) || drawn >= most) {
            throw few_feasible(constraints, pool, count);
        }
    }
    return {pool.configurations.topRows(count), pool.is_seen.topRows(count)};
}

}  // namespace posewise::detail
