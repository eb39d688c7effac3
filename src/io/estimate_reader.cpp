#include <fmt/format.h>

#include <cmath>

#include "../core/text.hpp"
#include "json.hpp"
#include "json_reader.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/model/error_terms.hpp"
#include "robot_statement.hpp"
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

Parameters read_parameters(const JsonValue& root, const Campaign& campaign) {
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

MatrixXd read_covariance(const JsonValue& covariance, const std::vector<std::string>& names) {
    const std::vector<JsonValue> listed = covariance["parameters"].list();
    const std::vector<JsonValue> rows = covariance["rows_si"].list();
    if (listed.size() != names.size() || rows.size() != names.size()) {
        throw covariance.error(fmt::format("has {} parameters in {} rows; must have {}",
                                           listed.size(), rows.size(), names.size()));
    }
    MatrixXd matrix(std::ssize(names), std::ssize(names));
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (listed[k].text() != names[k]) {
            throw listed[k].error("is " + detail::quote(listed[k].text()) + "; must be " +
                                  detail::quote(names[k]));
        }
        const std::vector<double> row = read_numbers(rows[k], k + 1);
        const auto i = static_cast<Index>(k);
        matrix.row(i).head(i + 1) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), i + 1);
        matrix.col(i).head(i + 1) = matrix.row(i).head(i + 1).transpose();
        constexpr double rounding = 1 + 1e-9;
        for (Index j = 0; j <= i; ++j) {
            if (matrix(i, j) * matrix(i, j) <= rounding * matrix(i, i) * matrix(j, j) &&
                matrix(i, i) >= 0) {
                continue;
            }
            throw rows[k].error("is no row of a covariance; a correlation is beyond 1");
        }
    }
    return matrix;
}

Ending read_ending(const JsonValue& value) {
    for (int k = 0; k <= static_cast<int>(Ending::Failed); ++k) {
        if (value.text() == ending_name(static_cast<Ending>(k))) return static_cast<Ending>(k);
    }
    throw value.error("is " + detail::quote(value.text()) + "; must be as posewise writes it");
}

double read_size(const JsonValue& value) {
    const double number = value.number();
    if (!(number >= 0)) throw value.error(fmt::format("is {:g}; must be at least 0", number));
    return number;
}

}  // namespace

Estimate read_estimate(const std::string& path, const Campaign& campaign) {
    const detail::Json document = detail::read_document(path, "estimate");
    const JsonValue root(document, path);
    const std::string readings = root["readings"].text();
    if (readings != campaign.sensor->words().readings) {
        throw root["readings"].error("is " + detail::quote(readings) + ", the campaign's sensor " +
                                     "measures " + campaign.sensor->words().readings +
                                     "; must be an estimate of this campaign");
    }
    detail::check_is_of_robot(root["chain"], campaign.robot);
    Estimate estimate;
    estimate.parameters = read_parameters(root, campaign);
    estimate.names = parameter_names(campaign);
    estimate.covariance = read_covariance(root["covariance"], estimate.names);
    estimate.ending = read_ending(root["ending"]);
    estimate.iterations = root["iterations"].count(0);
    estimate.degrees_of_freedom = root["degrees_of_freedom"].count(0);
    estimate.variance_factor = read_size(root["variance_factor"]);
    estimate.model_error = read_size(root["model_error_m"]);
    estimate.model_error_orientation = read_size(root["model_error_rad"]);
    return estimate;
}

}  // namespace posewise::io
