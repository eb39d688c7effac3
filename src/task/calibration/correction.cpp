#include "posewise/task/correction.hpp"

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"

namespace posewise {
namespace {

/// From the base frame of the estimate to that which the nominal poses are in.
Isometry3d estimated_base_from_base(const Campaign& campaign, const Parameters& found,
                                    CorrectionBase base) {
    if (base == CorrectionBase::Estimate) return Isometry3d::Identity();
    if (!campaign.has_nominal_base) {
        throw InputError("the campaign " + detail::quote(campaign.name) +
                         " states no base; must state the one that the poses are meant in");
    }
    return found.world_from_base.inverse() * campaign.nominal.world_from_base;
}

bool is_home(const Chain& robot, const Correction& correction, const CorrectionOptions& options) {
    constexpr double most = 0.5;  // of the error without correction
    const auto size = [&](const PoseError& error) {
        return std::hypot(error.position, options.length_per_angle * error.orientation);
    };
    return describe_shortfall(robot, correction).empty() ||
           size(correction.residual) <= most * size(correction.uncorrected);
}

/// What of the program collides in the campaign's cell, the targets taken off, or is beyond its
/// joint sums already.
CellViolations find_collisions(const Campaign& campaign, const RowMatrixXd& configurations) {
    Campaign working = campaign;
    working.has_nominal_targets = false;
    Cell cell;
    cell.joint_sums = campaign.cell.joint_sums;
    cell.links = campaign.cell.links;
    cell.keep_outs = campaign.cell.keep_outs;
    cell.safety_distance = campaign.cell.safety_distance;
    working.cell = cell;
    return find_violations(Constraints(working, cell, false), configurations);
}

/// Of the program, and of what its corrections add.
std::string describe_collisions(const Campaign& campaign, const CorrectedPoses& poses) {
    RowMatrixXd corrected = poses.nominal;
    for (Index i = 0; i < corrected.rows(); ++i) {
        corrected.row(i) = poses.corrections[static_cast<std::size_t>(i)].joints.transpose();
    }
    const CellViolations before = find_collisions(campaign, poses.nominal);
    const CellViolations after = find_collisions(campaign, corrected);
    const std::string text = describe(before, poses.ids);
    if (std::ranges::includes(before.rows, after.rows)) return text;
    return text + (text.empty() ? "" : "; ") + "once corrected, " + describe(after, poses.ids);
}

}  // namespace

CorrectedPoses correct_poses(const Campaign& campaign, const Parameters& found,
                             const RowMatrixXd& configurations, const std::vector<std::string>& ids,
                             CorrectionBase base, const CorrectionOptions& stated) {
    CorrectionOptions options = stated;
    options.joint_sums = campaign.cell.joint_sums;
    const Isometry3d from_base = estimated_base_from_base(campaign, found, base);
    const VectorXd no_errors = VectorXd::Zero(campaign.robot.parameter_count());
    CorrectedPoses corrected{campaign.robot, ids, configurations, {}, {}, {}};
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd nominal = configurations.row(i).transpose();
        try {
            corrected.corrections.push_back(correct_configuration(
                campaign.robot, found.robot, nominal,
                from_base * campaign.robot.base_from_flange(nominal, no_errors), options));
        } catch (const InputError& error) {
            throw InputError("configuration " + detail::quote(ids[static_cast<std::size_t>(i)]) +
                             ": " + error.what());
        }
        if (!is_home(campaign.robot, corrected.corrections.back(), options)) {
            corrected.not_home.push_back(i);
        }
    }
    corrected.collisions = describe_collisions(campaign, corrected);
    return corrected;
}

}  // namespace posewise
