#include "posewise/task/inspection.hpp"

#include <algorithm>
#include <numbers>

#include "jacobian/nominal_factor.hpp"
#include "model/complete_model.hpp"
#include "model/driven_axes.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {

std::vector<OnAxis> find_on_axis(const Campaign& campaign) {
    const Chain bare = without_parameters(campaign.robot);
    std::vector<OnAxis> found;
    if (!campaign.has_nominal_targets || campaign.sensor->has_orientation()) return found;
    const auto [axes, flange] = detail::find_driven_axes(bare, VectorXd());
    const detail::DrivenAxis& last = axes.back();
    if (last.element->motion != Motion::Rotation) return found;
    const Vector3d direction =
        last.base_from_element.linear().col(static_cast<Index>(last.element->axis));
    const double near = detail::least_visible * extent(bare);
    const Targets& targets = campaign.sensor->targets();
    for (Index k = 0; k < targets.count(); ++k) {
        const Vector3d place = flange * targets.position(k, campaign.nominal.sensor);
        const Vector3d beside = place - last.base_from_element.translation();
        if (direction.cross(beside).norm() > near) return {};
        found.push_back({k, bare.joint(last.element->joints.front().joint).name});
    }
    return found;
}

std::vector<Index> find_narrow_limits(const Campaign& campaign) {
    constexpr double times = 10;
    const double whole = to_radians(2 * std::numbers::pi);  // a turn in rad, read as deg
    const std::vector<Joint>& joints = campaign.robot.joints();
    std::vector<Index> turning;
    for (Index j = 0; j < std::ssize(joints); ++j) {
        if (campaign.robot.joint(j).motion == Motion::Rotation) turning.push_back(j);
    }
    const auto range = [&](Index j) {
        return campaign.robot.joint(j).upper - campaign.robot.joint(j).lower;
    };
    std::vector<Index> narrow;
    for (const Index j : turning) {
        const Joint& joint = campaign.robot.joint(j);
        if (joint.lower < -whole || joint.upper > whole) continue;
        const auto wider = std::ranges::count_if(
            turning, [&](Index other) { return range(other) >= times * range(j); });
        if (2 * wider >= std::ssize(turning) - 1) narrow.push_back(j);
    }
    return narrow;
}

Inspection inspect(const Campaign& campaign, const Chain& declared, bool is_stated) {
    Inspection inspection;
    inspection.campaign = campaign;
    inspection.complete = with_robot(campaign, detail::complete_model(declared));
    if (is_stated) inspection.stated = find_identifiable(campaign);
    inspection.of_complete = find_identifiable(inspection.complete);
    inspection.least_pose_count = least_calibration_count(campaign);
    inspection.unknowable = find_unknowable(campaign);
    inspection.on_axis = find_on_axis(campaign);
    return inspection;
}

std::vector<std::string> find_doubtful_parameters(const Inspection& inspection) {
    const bool is_stated = inspection.stated.has_value();
    const Campaign& campaign = is_stated ? inspection.campaign : inspection.complete;
    const Identifiability& found = is_stated ? *inspection.stated : inspection.of_complete;
    std::vector<std::string> weakest;
    if (campaign.spread.is_prior || has_clear_gap(found)) return weakest;
    const auto names = parameter_names(campaign);
    for (const Index k : weakest_kept(campaign, found)) {
        weakest.push_back(names[static_cast<std::size_t>(k)]);
    }
    return weakest;
}

}  // namespace posewise
