#include "workspace.hpp"

#include <algorithm>

#include "measurement/contact.hpp"
#include "model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"

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

RowMatrixXd workspace_configurations(const Campaign& campaign, const Parameters& found, Index count,
                                     std::uint64_t seed) {
    if (!campaign.robot.torques().empty()) {
        return random_configurations(campaign.robot, count, seed);
    }
    Campaign placed = campaign;
    placed.nominal = found;
    placed.nominal.robot.setZero();
    placed.has_nominal_base = placed.has_nominal_targets = true;
    return workspace_configurations(placed, std::nullopt, count, seed);
}

std::optional<WorkspaceError> expected_workspace_error(const Campaign& campaign,
                                                       const Estimate& estimate) {
    constexpr Index count = 200;
    if (campaign.sensor->has_contacts()) return std::nullopt;
    try {
        // Where a camera does not see the board its pixels say nothing.
        RowMatrixXd configurations;
        if (campaign.sensor->has_view()) {
            const ViewedPoses drawn = viewed_poses(campaign, estimate.parameters, count, 1);
            configurations = drawn.configurations.topRows(drawn.in_view);
        } else {
            configurations = workspace_configurations(campaign, estimate.parameters, count, 1);
        }
        if (configurations.rows() == 0) return std::nullopt;
        WorkspaceError error{
            predict_errors(campaign, estimate, configurations).front().overall, {}, {}};
        if (campaign.sensor->has_pixels()) {
            error.place = expected_place_error(campaign, estimate, configurations);
            if (campaign.robot.parameter_count() == 0) return error;
            error.robot = expected_robot_error(campaign, estimate, configurations);
        }
        return error;
    } catch (const InputError&) {
        return std::nullopt;  // limits are missing, or the cell leaves no room
    }
}

}  // namespace posewise::detail
