#include "calibration_tables.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/format.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise::detail {
namespace {

using MetricRow = std::pair<std::string, std::function<double(const Metrics&)>>;

std::vector<MetricRow> list_metric_rows(const Metrics& example) {
    std::vector<MetricRow> rows;
    if (example.coordinate_count > 0) {
        rows = {
            {"distance RMS", [](const Metrics& m) { return m.distance_rms; }},
            {"distance max", [](const Metrics& m) { return m.distance_max; }},
            {"distance mean", [](const Metrics& m) { return m.distance_mean; }},
            {"distance 95 %", [](const Metrics& m) { return m.distance_p95; }},
        };
    }
    const Index axes = example.coordinate_count == 3 ? 3 : 0;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(axes); ++axis) {
        const std::string name(1, static_cast<char>('x' + axis));
        rows.push_back({name + " RMS", [=](const Metrics& m) { return m.coordinate_rms[axis]; }});
        rows.push_back({name + " max", [=](const Metrics& m) { return m.coordinate_max[axis]; }});
    }
    if (example.has_orientation) {
        const bool are_pixels = example.orientation_units == &pixel_units;
        rows.push_back({are_pixels ? "reprojection RMS/px" : "turn RMS/mrad",
                        [](const Metrics& m) { return m.orientation_rms; }});
        rows.push_back({are_pixels ? "reprojection max/px" : "turn max/mrad",
                        [](const Metrics& m) { return m.orientation_max; }});
    }
    return rows;
}

/// The numbers parameter_names() names, in SI units; the base's turn as a rotation vector.
VectorXd flatten(const Campaign& campaign, const Parameters& parameters) {
    VectorXd base(6);
    base << parameters.world_from_base.translation(),
        vector_from_rotation(parameters.world_from_base.linear());
    std::vector<Index> unknown;
    for (Index k = 0; k < 6; ++k) {
        if (!campaign.base_is_known[static_cast<std::size_t>(k)]) unknown.push_back(k);
    }
    VectorXd values(parameter_count(campaign));
    values << base(unknown), parameters.robot, parameters.sensor;
    return values;
}

const std::initializer_list<std::string> deviation_header{"std. dev.", ""};

void add_deviation(std::vector<std::string>& row, double deviation, const AmountUnits& units) {
    row.push_back(format_fixed(mm_per_m * deviation, 4));
    row.emplace_back(units.error);
}

}  // namespace

Table metrics_table(const std::vector<std::pair<std::string, Metrics>>& columns) {
    Table table;
    const auto kinds = list_metric_rows(columns.front().second);
    const bool state_units = kinds.front().first.ends_with("/px");
    table.header = {state_units ? "error" : "error/mm"};
    for (const auto& [name, metrics] : columns) table.header.push_back(name);
    for (const auto& [name, value] : kinds) {
        std::vector<std::string> row{name};
        for (const auto& [unused, metrics] : columns) {
            row.push_back(metrics.point_count > 0 ? format_mm(value(metrics)) : "-");
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

Table sensor_table(const std::vector<SensorAccuracy>& sensors) {
    Table table{{"sensor", "readings", "unit", "nominal", "calibrated", "held out"}, {}};
    Index number = 0;
    for (const SensorAccuracy& one : sensors) {
        table.rows.push_back({fmt::format("{} ({})", ++number, one.readings),
                              std::to_string(one.fit.point_count), std::string(one.units->error),
                              format_mm(one.nominal.rms()), format_mm(one.fit.rms()),
                              one.held_out ? format_mm(one.held_out->rms()) : "-"});
    }
    return table;
}

Table value_table(const Campaign& campaign, const Parameters& parameters) {
    const VectorXd values = flatten(campaign, parameters);
    const auto names = parameter_names(campaign);
    const auto units_of_all = parameter_units(campaign);
    Table table{{"parameter", "value", ""}, {}};
    for (Index k = 0; k < values.size(); ++k) {
        const auto i = static_cast<std::size_t>(k);
        // The base's turn is no small error.
        const bool in_degrees =
            k < base_parameter_count(campaign) && units_of_all[i] == &angle_units;
        const AmountUnits& units = *units_of_all[i];
        const double value = in_degrees ? units.to_reading(values[k]) : mm_per_m * values[k];
        table.rows.push_back({names[i], format_fixed(value, 4),
                              std::string(in_degrees ? units.reading : units.error)});
    }
    return table;
}

Table parameter_table(const Campaign& campaign, const Estimate& estimate) {
    const VectorXd deviations = standard_deviations(estimate);
    const auto units_of_all = parameter_units(campaign);
    Table table = value_table(campaign, estimate.parameters);
    table.header.insert(table.header.end(), deviation_header);
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        add_deviation(table.rows[k], deviations[static_cast<Index>(k)], *units_of_all[k]);
    }
    return table;
}

Table refitted_table(const Calibration& calibration) {
    if (!calibration.refitted) return {};
    const Campaign& campaign = *calibration.refitted;
    const auto units_of_all = parameter_units(campaign);
    Table table = value_table(campaign, campaign.nominal);
    table.header.insert(table.header.end(), deviation_header);
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const auto sigma = calibration.refitted_sigmas.find(table.rows[k].front());
        if (sigma == calibration.refitted_sigmas.end()) continue;  // the robot's
        add_deviation(table.rows[k], sigma->second, *units_of_all[k]);
    }
    const auto begin = table.rows.begin() + base_parameter_count(campaign);
    table.rows.erase(begin, begin + campaign.robot.parameter_count());
    return table;
}

void add_sigmas_beside_held(const Calibration& calibration, Table& parameters) {
    const auto& sigmas = calibration.sigmas_beside_held;
    if (sigmas.empty()) return;
    parameters.header.emplace_back("were those held exact");
    for (std::vector<std::string>& row : parameters.rows) {
        const auto found = sigmas.find(row.front());
        row.push_back(found == sigmas.end() ? "-" : format_fixed(mm_per_m * found->second, 4));
    }
}

Table compliance_table(const Campaign& campaign, const Estimate& estimate) {
    const VectorXd deviations = standard_deviations(estimate);
    const Index robot_begin = base_parameter_count(campaign);
    Table table{{"joint", "compliance", "std. dev.", "", "largest torque", ""}, {}};
    for (const Compliance& compliance : compliances(campaign.robot)) {
        const double value = estimate.parameters.robot[compliance.parameter];
        const double deviation = deviations[robot_begin + compliance.parameter];
        const double factor = 1e6 / compliance.largest;
        const Joint& joint = campaign.robot.joint(compliance.joint);
        table.rows.push_back(
            {joint.name, format_short(factor * value, 4), format_short(factor * deviation, 2),
             joint.motion == Motion::Rotation ? "urad/(N m)" : "um/N",
             format_short(compliance.largest, 4), std::string(units_of(joint.motion).load)});
    }
    return table;
}

Table correlation_table(const Estimate& estimate, Index count) {
    Table table{{"parameter", "parameter", "correlation"}, {}};
    for (const Correlation& pair : strongest_correlations(estimate, count)) {
        table.rows.push_back({estimate.names[static_cast<std::size_t>(pair.first)],
                              estimate.names[static_cast<std::size_t>(pair.second)],
                              format_fixed(pair.coefficient, 3)});
    }
    return table;
}

Table outlier_table(const Campaign& campaign, const Estimate& estimate, Index count) {
    const std::vector<std::string> contacts = campaign.sensor->contact_names();
    std::vector<Outlier> outliers = estimate.outliers;
    std::stable_sort(outliers.begin(), outliers.end(), [](const Outlier& a, const Outlier& b) {
        return a.deviations > b.deviations;
    });
    outliers.resize(std::min(outliers.size(), static_cast<std::size_t>(std::max<Index>(count, 0))));
    Table table{{"configuration", contacts.empty() ? "target" : "socket", "error/mm", "std. devs.",
                 "weight"},
                {}};
    for (const Outlier& outlier : outliers) {
        table.rows.push_back({outlier.id,
                              contacts.empty() ? std::to_string(outlier.target + 1)
                                               : contacts[static_cast<std::size_t>(outlier.target)],
                              format_mm(outlier.distance), format_fixed(outlier.deviations, 1),
                              format_fixed(outlier.weight, 3)});
    }
    return table;
}

Table socket_table(const Campaign& campaign, const Estimate& estimate) {
    Table table{{"socket", "x/mm", "y/mm", "z/mm"}, {}};
    const auto* const sensor = dynamic_cast<const SocketSensor*>(campaign.sensor.get());
    for (Index k = 0; sensor != nullptr && k < sensor->target_count(); ++k) {
        if (!sensor->has_distance(k)) continue;
        const Vector3d at = sensor->socket_position(k, estimate.parameters.sensor);
        table.rows.push_back({sensor->sockets()[static_cast<std::size_t>(k)].name,
                              format_mm(at.x()), format_mm(at.y()), format_mm(at.z())});
    }
    return table;
}

Table model_table(const ModelSelection& selection) {
    Table table{{"set", "parameters", "fit RMS/mm", "held-out RMS/mm", "std. error/mm", ""}, {}};
    for (const ModelTrial& trial : selection.trials) {
        const auto k = static_cast<Index>(table.rows.size());
        const bool is_judged = trial.failure.empty();
        const auto figure = [&](double metres) { return is_judged ? format_mm(metres) : "-"; };
        std::string mark = k == selection.recommended ? "recommended" : "";
        if (k == selection.best) mark += mark.empty() ? "best" : ", best";
        table.rows.push_back({trial.set.name, std::to_string(trial.parameter_count),
                              figure(trial.fit_rms), figure(trial.held_out_rms),
                              figure(trial.standard_error), mark});
    }
    return table;
}

}  // namespace posewise::detail
