#include "parameters_json.hpp"

#include <numbers>

#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise::detail {
namespace {

Json targets_to_json(const Sensor& sensor, const VectorXd& unknowns) {
    Json targets = Json::object();
    for (Index j = 0; j < sensor.target_count(); ++j) {
        targets["target" + std::to_string(j + 1)] = {
            {"position_m", vector_to_json(sensor.target_position(j, unknowns))},
            {"known", sensor.targets().is_known(j)}};
    }
    return targets;
}

/// Values of the unknowns, by name and unit.
Json unknowns_to_json(const Sensor& sensor, const VectorXd& unknowns) {
    const std::vector<std::string> names = sensor.unknown_names();
    const auto units = sensor.unknown_units();
    Json json = Json::object();
    for (std::size_t k = 0; k < names.size(); ++k) {
        json[names[k] + si_suffix(*units[k])] = unknowns[static_cast<Index>(k)];
    }
    return json;
}

Json robot_to_json(const Campaign& campaign, const VectorXd& values, const VectorXd* sigmas) {
    const std::vector<std::string> names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    const VectorXd scale = parameter_scale(campaign);
    const Index robot_begin = base_parameter_count(campaign);
    Json robot = Json::object();
    for (Index k = 0; k < values.size(); ++k) {
        const auto i = static_cast<std::size_t>(robot_begin + k);
        const std::string unit = si_suffix(*units[i]);
        robot[names[i]] = {{"value" + unit, values[k]}};
        if (sigmas == nullptr) continue;
        robot[names[i]]["sigma" + unit] = (*sigmas)[robot_begin + k];
        robot[names[i]]["expected" + unit] = scale[robot_begin + k];
    }
    for (const Compliance& compliance : compliances(campaign.robot)) {
        const auto i = static_cast<std::size_t>(robot_begin + compliance.parameter);
        robot[names[i]][load_key(units[i] == &angle_units)] = compliance.largest;
    }
    return robot;
}

}  // namespace

Json base_to_json(const Isometry3d& world_from_base) {
    Eigen::Quaterniond q(world_from_base.linear());
    if (q.w() < 0) q.coeffs() *= -1;
    return {{"position_m", vector_to_json(Vector3d(world_from_base.translation()))},
            {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}},
            {"rpy_deg", vector_to_json(rpy_from_rotation(world_from_base.linear()) *
                                       (180 / std::numbers::pi))}};
}

Json parameters_to_json(const Campaign& campaign, const Parameters& parameters,
                        const VectorXd* sigmas) {
    const Sensor& sensor = *campaign.sensor;
    Json json = {{"base", base_to_json(parameters.world_from_base)},
                 {"robot", robot_to_json(campaign, parameters.robot, sigmas)}};
    if (sensor.observes_targets()) {
        json["targets"] = targets_to_json(sensor, parameters.sensor);
    } else {
        json["sensor"] = unknowns_to_json(sensor, parameters.sensor);
    }
    return json;
}

}  // namespace posewise::detail
