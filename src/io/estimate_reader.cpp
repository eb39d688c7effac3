#include <fmt/format.h>

#include <cmath>

#include "../core/text.hpp"
#include "json.hpp"
#include "json_reader.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/model/error_terms.hpp"
#include "units.hpp"

namespace posewise::io {
namespace {

using detail::JsonValue;
using detail::Quantity;

std::vector<double> read_numbers(const JsonValue& value, std::size_t count) {
    const std::vector<JsonValue> items = value.list();
    if (items.size() != count) {
        throw value.error("has " + std::to_string(items.size()) + " values; must have " +
                          std::to_string(count));
    }
    std::vector<double> numbers;
    for (const JsonValue& item : items) numbers.push_back(item.number());
    return numbers;
}

/// m or rad, of a size that occurs.
double check_size(double si, Quantity quantity, const JsonValue& value) {
    if (is_plausible(si, quantity)) return si;
    const detail::Unit* const unit = detail::find_unit(quantity == Quantity::Length ? "m" : "rad");
    throw value.error(fmt::format("is {:g}; must be {}", si, plausible(*unit)));
}

Vector3d read_position(const JsonValue& value) {
    Vector3d position;
    const std::vector<double> xyz = read_numbers(value, 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        position[static_cast<Index>(axis)] = check_size(xyz[axis], Quantity::Length, value);
    }
    return position;
}

Isometry3d read_base(const JsonValue& base) {
    const JsonValue quaternion = base["quaternion_wxyz"];
    const std::vector<double> wxyz = read_numbers(quaternion, 4);
    const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    if (!(std::abs(q.norm() - 1) < 1e-6)) {
        throw quaternion.error(fmt::format("has length {:g}; must be 1", q.norm()));
    }
    Isometry3d world_from_base(q.normalized());
    world_from_base.translation() = read_position(base["position_m"]);
    return world_from_base;
}

VectorXd read_robot(const JsonValue& robot, const Campaign& campaign) {
    const std::vector<std::string> names = campaign.robot.parameter_names();
    VectorXd values(campaign.robot.parameter_count());
    for (Index k = 0; k < values.size(); ++k) {
        const bool turns = campaign.robot.parameter_element(k).motion == Motion::Rotation;
        const std::string& name = names[static_cast<std::size_t>(k)];
        if (!robot.has(name)) {
            throw robot.error("has no parameter " + detail::quote(name) +
                              "; must be an estimate of this campaign");
        }
        const JsonValue value = robot[name]["value" + detail::si_suffix(turns)];
        values[k] = check_size(value.number(), turns ? Quantity::Angle : Quantity::Length, value);
    }
    // What gives way is in proportion to the load, which limits or payload may have changed.
    for (const Compliance& compliance : compliances(campaign.robot)) {
        const bool turns = campaign.robot.joint(compliance.joint).motion == Motion::Rotation;
        const JsonValue load =
            robot[names[static_cast<std::size_t>(compliance.parameter)]][detail::load_key(turns)];
        if (!(load.number() > 0)) throw load.error("must be above 0");
        values[compliance.parameter] *= compliance.largest / load.number();
    }
    const std::size_t count = robot.values().size();
    if (count != names.size()) {
        throw robot.error("has " + std::to_string(count) + " parameters, the campaign's robot " +
                          std::to_string(names.size()) + "; must be an estimate of this campaign");
    }
    return values;
}

VectorXd read_targets(const JsonValue& targets, const Sensor& sensor) {
    VectorXd unknowns(static_cast<Index>(sensor.unknown_names().size()));
    for (Index j = 0; j < sensor.target_count(); ++j) {
        if (sensor.targets().is_known(j)) continue;
        const Vector3d position =
            read_position(targets["target" + std::to_string(j + 1)]["position_m"]);
        for (Index axis = 0; axis < 3; ++axis) {
            const Index k = sensor.targets().unknown_index(j, axis);
            if (k >= 0) unknowns[k] = position[axis];
        }
    }
    return unknowns;
}

VectorXd read_unknowns(const JsonValue& values, const Sensor& sensor) {
    const std::vector<std::string> names = sensor.unknown_names();
    const std::vector<bool> is_angle = sensor.unknown_is_angle();
    VectorXd unknowns(static_cast<Index>(names.size()));
    for (std::size_t k = 0; k < names.size(); ++k) {
        const JsonValue value = values[names[k] + detail::si_suffix(is_angle[k])];
        unknowns[static_cast<Index>(k)] =
            check_size(value.number(), is_angle[k] ? Quantity::Angle : Quantity::Length, value);
    }
    return unknowns;
}

}  // namespace

Parameters read_estimate(const std::string& path, const Campaign& campaign) {
    const detail::Json document = detail::read_document(path, "estimate");
    const JsonValue root(document, path);
    Parameters parameters;
    parameters.world_from_base = read_base(root["base"]);
    parameters.robot = read_robot(root["robot"], campaign);
    if (campaign.sensor->observes_targets()) {
        parameters.sensor = read_targets(root["targets"], *campaign.sensor);
    } else {
        parameters.sensor = read_unknowns(root["sensor"], *campaign.sensor);
    }
    return parameters;
}

}  // namespace posewise::io
