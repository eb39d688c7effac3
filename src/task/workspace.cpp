#include "workspace.hpp"

#include <algorithm>

#include "posewise/core/errors.hpp"
#include "posewise/planner/pool.hpp"

namespace posewise::detail {

RowMatrixXd workspace_configurations(const Campaign& campaign, const std::optional<Box>& target_box,
                                     Index count, std::uint64_t seed) {
    constexpr Index draws_per_pose = 20;
    Cell cell = campaign.cell;
    cell.sight.reset();  // the robot works where the tracker sees nothing, too
    if (target_box) cell.target_boxes = {*target_box};
    try {
        const Pool pool =
            make_pool(Constraints(campaign, std::move(cell), false), draws_per_pose * count, seed);
        return pool.configurations.topRows(std::min(count, pool.configurations.rows()));
    } catch (const InputError& error) {
        throw InputError(std::string("workspace: ") + error.what());
    }
}

}  // namespace posewise::detail
