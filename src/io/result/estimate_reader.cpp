#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.hpp"
#include "estimate_covariance.hpp"
#include "estimate_fields.hpp"
#include "io/campaign/campaign_sections.hpp"
#include "io/campaign/robot_statement.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise::io {
namespace {

using detail::Json;
using detail::JsonValue;
using detail::Quantity;
using detail::read_numbers;
using detail::Size;

Vector3d read_position(const JsonValue& value) {
    read_numbers(value, 3);  // as many
    Vector3d position;
    Index axis = 0;
    for (const JsonValue& item : value.list()) Size{}.read(item, position[axis++]);
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
    const JsonValue rpy = base["rpy_deg"];
    Vector3d angles;
    for (Index k = 0; k < 3; ++k) {
        angles[k] = to_radians(read_numbers(rpy, 3)[static_cast<std::size_t>(k)]);
    }
    const Matrix3d stated = rotation_from_rpy(angles);
    if (!((stated - world_from_base.linear()).array().abs() <= 1e-6).all()) {
        throw rpy.error("is not the rotation of quaternion_wxyz; must agree with it");
    }
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
        Size{turns}.read(robot[name]["value" + detail::si_suffix(turns)], values[k]);
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
    const auto units = sensor.unknown_units();
    VectorXd unknowns(static_cast<Index>(names.size()));
    for (std::size_t k = 0; k < names.size(); ++k) {
        const std::string key = names[k] + detail::si_suffix(*units[k]);
        if (!values.has(key)) throw values.error("has no " + key + detail::as_then);
        Size{units[k] != &length_units}.read(values[key], unknowns[static_cast<Index>(k)]);
    }
    return unknowns;
}

Parameters read_parameters(const JsonValue& root, const Campaign& campaign, const EarlierUse& use) {
    Parameters parameters;
    parameters.world_from_base =
        use.has_new_base ? campaign.nominal.world_from_base : read_base(root["base"]);
    parameters.robot = read_robot(root["robot"], campaign);
    if (use.has_new_targets) {
        parameters.sensor = campaign.nominal.sensor;
    } else if (campaign.sensor->observes_targets()) {
        parameters.sensor = read_targets(root["targets"], *campaign.sensor);
    } else {
        parameters.sensor = read_unknowns(root["sensor"], *campaign.sensor);
    }
    return parameters;
}

void check_readings(const JsonValue& value, const Sensor& sensor) {
    const std::string readings = value.text();
    if (readings == sensor.words().readings) return;
    throw value.error("is " + detail::quote(readings) + ", the campaign's sensor measures " +
                      sensor.words().readings + "; must be an estimate of this campaign");
}

/// Of another board, which nothing else of an estimate tells.
void check_corner_count(const JsonValue& measured, const Sensor& sensor) {
    if (!sensor.has_pixels() || sensor.has_contacts()) return;
    const double samples = measured["samples"].number(), readings = measured["readings"].number();
    const Index count = sensor.target_count();
    if (readings == samples * static_cast<double>(count)) return;
    throw measured["readings"].error(fmt::format(
        "are {:g} in {:g} samples, {:g} {} each, the campaign's sensor has {}; must be an estimate "
        "of this campaign",
        readings, samples, readings / samples, sensor.words().readings, count));
}

EarlierFile read_root(const JsonValue& root, const Campaign& campaign, const EarlierUse& use) {
    if (!use.has_new_targets) check_readings(root["readings"], *campaign.sensor);
    if (!use.has_new_targets && !use.has_new_base && root.has("measured")) {
        check_corner_count(root["measured"], *campaign.sensor);
    }
    detail::check_is_of_robot(root["chain"], campaign.robot);
    EarlierFile earlier;
    Estimate& estimate = earlier.estimate;
    estimate.parameters = read_parameters(root, campaign, use);
    estimate.names = parameter_names(campaign);
    estimate.covariance = detail::read_covariance(root, campaign, use);
    detail::fit_fields(detail::Fields(root), estimate, earlier.faults);
    return earlier;
}

/// The campaign's, with those that the estimate learned.
ParameterSpread read_learned_sizes(const JsonValue& sizes, const Campaign& campaign) {
    ParameterSpread spread = campaign.spread;
    spread.is_open = false;
    for (const SharedSize& shared : shared_sizes(campaign.spread, campaign.robot)) {
        const std::string key = shared.key + detail::si_suffix(shared.is_angle);
        if (!sizes.has(key)) continue;
        const JsonValue learned = sizes[key]["learned"];
        const double size = learned.number();
        const double largest =
            detail::largest_error(shared.is_angle ? Quantity::Angle : Quantity::Length);
        if (!detail::is_plausible_amount(size, largest)) {
            const detail::Unit& unit = *detail::find_unit(shared.is_angle ? "rad" : "m");
            throw learned.error(
                fmt::format("is {:g}; must be {}", size, detail::plausible_amount(unit, largest)));
        }
        size_of(spread, campaign.robot, shared.members.front()) = size;
    }
    return spread;
}

/// Where noise and expected sizes are others now than when the estimate was made. The model error
/// is what it found, and so are sizes that were learned.
std::vector<std::string> find_changes(const JsonValue& assumes, const Campaign& campaign,
                                      bool has_learned) {
    const Json before = assumes.json().flatten();
    std::vector<std::string> changes;
    for (const NamedNumber& now : assumptions_of(campaign)) {
        const bool is_found = now.name.starts_with("model_error") ||
                              (has_learned && now.name.starts_with("expected_error/"));
        const auto then = before.find('/' + now.name);
        if (is_found || then == before.end() || !then->is_number()) continue;
        const auto was = then->get<double>();
        if (std::abs(was - now.value) <= 1e-9 * std::max(was, now.value)) continue;
        changes.push_back(fmt::format("{} was {:g}, is {:g}", now.name, was, now.value));
    }
    return changes;
}

}  // namespace

Estimate read_estimate(const std::string& path, const Campaign& campaign) {
    const detail::Json document = detail::read_document(path, "estimate");
    return read_root(JsonValue(document, path), campaign, {}).estimate;
}

EarlierFile read_earlier(const std::string& path, const Campaign& campaign, const EarlierUse& use) {
    const detail::Json document = detail::read_document(path, "estimate");
    const JsonValue root(document, path);
    EarlierFile earlier = read_root(root, campaign, use);
    if (use.is_prior) detail::check_definite(root, earlier.estimate.covariance);
    earlier.use = use;
    if (root.has("warnings")) earlier.warnings = root["warnings"].texts();
    const bool has_learned = root.has("learned_sizes");
    if (has_learned) {
        earlier.estimate.spread = read_learned_sizes(root["learned_sizes"], campaign);
    }
    if (root.has("assumes")) earlier.changes = find_changes(root["assumes"], campaign, has_learned);
    return earlier;
}

std::vector<std::string> find_faults(const Campaign& campaign, const EarlierFile& earlier) {
    Campaign judged = campaign;
    if (earlier.estimate.spread) judged.spread = *earlier.estimate.spread;
    std::vector<std::string> faults = posewise::find_faults(judged, earlier.estimate);
    for (const std::string& stated : earlier.faults) {
        if (std::ranges::find(faults, stated) == faults.end()) faults.push_back(stated);
    }
    return faults;
}

bool are_of_checksum(const std::string& checksum, const Measurements& measurements,
                     const std::vector<std::string>& excluded) {
    if (checksum == checksum_of(measurements)) return true;
    if (excluded.empty()) return false;
    try {
        return checksum == checksum_of(leave_out(measurements, excluded));
    } catch (const InputError&) {  // they have no such configurations
        return false;
    }
}

bool is_made_from(const std::string& estimate_path, const Measurements& measurements) {
    const detail::Json document = detail::read_document(estimate_path, "estimate");
    const JsonValue root(document, estimate_path);
    constexpr const char* key = "measurements_checksum";
    if (!root.has("made_from") || !root["made_from"].has(key)) return false;
    std::vector<std::string> excluded;
    if (root.has("excluded")) excluded = root["excluded"].texts();
    return are_of_checksum(root["made_from"][key].text(), measurements, excluded);
}

}  // namespace posewise::io
