#include "workspace.hpp"

#include <algorithm>
#include <numeric>

#include "measurement/contact.hpp"
#include "model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/measurement/measurements.hpp"

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

namespace {

/// At random poses that show what a sensor with a view needs, of those targets that are in view.
std::optional<WorkspaceError> error_in_view(const Campaign& campaign, const Estimate& estimate,
                                            Index count) {
    const ViewedPoses drawn = viewed_poses(campaign, estimate.parameters, count, 1);
    if (drawn.in_view == 0) return std::nullopt;
    Measurements shown;
    shown.configurations = drawn.configurations.topRows(drawn.in_view);
    shown.observations = RowMatrixXd::Zero(drawn.in_view, campaign.sensor->row_count());
    shown.is_seen = drawn.is_seen.topRows(drawn.in_view);
    shown.ids.resize(static_cast<std::size_t>(drawn.in_view));
    shown.first_sample.resize(shown.ids.size() + 1);
    std::iota(shown.first_sample.begin(), shown.first_sample.end(), 0);
    WorkspaceError error{expected_sample_error(campaign, estimate, shown), {}, {}};
    if (!campaign.sensor->has_pixels()) return error;
    error.place = expected_place_error(campaign, estimate, shown.configurations);
    if (campaign.robot.parameter_count() == 0) return error;
    error.robot = expected_robot_error(campaign, estimate, shown.configurations);
    return error;
}

}  // namespace

std::optional<WorkspaceError> expected_workspace_error(const Campaign& campaign,
                                                       const Estimate& estimate) {
    constexpr Index count = 200;
    if (campaign.sensor->has_contacts()) return std::nullopt;
    try {
        // What a camera does not see says nothing.
        if (campaign.sensor->has_view()) return error_in_view(campaign, estimate, count);
        const RowMatrixXd configurations =
            workspace_configurations(campaign, estimate.parameters, count, 1);
        return WorkspaceError{
            predict_errors(campaign, estimate, configurations).front().overall, {}, {}};
    } catch (const InputError&) {
        return std::nullopt;  // limits are missing, or the cell leaves no room
    }
}

}  // namespace posewise::detail
