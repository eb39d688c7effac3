#include "posewise/measurement/campaign.hpp"

#include <algorithm>

#include "posewise/core/errors.hpp"

namespace posewise {

Index parameter_count(const Campaign& campaign) {
    return 6 + campaign.robot.parameter_count() +
           static_cast<Index>(campaign.sensor->unknown_names().size());
}

std::vector<std::string> parameter_names(const Campaign& campaign) {
    std::vector<std::string> names{"base.x", "base.y", "base.z", "base.rx", "base.ry", "base.rz"};
    for (const auto& name : campaign.robot.parameter_names()) names.push_back(name);
    for (const auto& name : campaign.sensor->unknown_names()) names.push_back(name);
    return names;
}

std::vector<bool> parameter_is_angle(const Campaign& campaign) {
    std::vector<bool> is_angle(static_cast<std::size_t>(parameter_count(campaign)), false);
    std::fill_n(is_angle.begin() + 3, 3, true);
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        is_angle[static_cast<std::size_t>(6 + k)] =
            campaign.robot.parameter_element(k).motion == Motion::Rotation;
    }
    return is_angle;
}

VectorXd parameter_scale(const Campaign& campaign) {
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    VectorXd scale(static_cast<Index>(names.size()));
    for (std::size_t k = 0; k < names.size(); ++k) {
        scale[static_cast<Index>(k)] = is_angle[k] ? campaign.spread.angle : campaign.spread.length;
    }
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        const ErrorTerm* const term = campaign.robot.parameter_term(k);
        if (term == nullptr || term->kind == TermKind::Free) continue;
        const bool is_gravity = term->kind == TermKind::Gravity;
        scale[6 + k] = is_gravity ? campaign.spread.gravity : campaign.spread.harmonic;
    }
    for (const auto& [name, size] : campaign.spread.by_name) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            throw InputError("spread names parameter '" + name +
                             "', which this robot and sensor do not have");
        }
        scale[found - names.begin()] = size;
    }
    return scale;
}

MatrixXd prior_information(const Campaign& campaign) {
    VectorXd information = VectorXd::Zero(parameter_count(campaign));
    if (campaign.spread.is_prior)
        information.segment(6, campaign.robot.parameter_count()).setOnes();
    return information.asDiagonal();
}

Parameters advance(const Parameters& parameters, const VectorXd& step) {
    Parameters moved = parameters;
    const Vector3d phi = step.segment<3>(3);
    const double angle = phi.norm();
    if (angle > 0) {
        const Matrix3d turn = Eigen::AngleAxisd(angle, phi / angle).toRotationMatrix();
        // Through a unit quaternion, so that rounding never accumulates into a non-rotation.
        moved.world_from_base.linear() =
            Eigen::Quaterniond(turn * parameters.world_from_base.linear())
                .normalized()
                .toRotationMatrix();
    }
    moved.world_from_base.translation() += step.head<3>();
    moved.robot += step.segment(6, parameters.robot.size());
    moved.sensor += step.tail(parameters.sensor.size());
    return moved;
}

Isometry3d world_from_flange(const Campaign& campaign, const Parameters& parameters,
                             const VectorXd& configuration) {
    return parameters.world_from_base *
           campaign.robot.base_from_flange(configuration, parameters.robot);
}

Campaign with_robot(const Campaign& campaign, Chain robot) {
    Campaign changed = campaign;
    changed.robot = std::move(robot);
    changed.nominal.robot = VectorXd::Zero(changed.robot.parameter_count());
    const auto names = parameter_names(changed);
    std::erase_if(changed.spread.by_name, [&](const auto& entry) {
        return std::find(names.begin(), names.end(), entry.first) == names.end();
    });
    return changed;
}

}  // namespace posewise
