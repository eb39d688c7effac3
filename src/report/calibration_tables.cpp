#include "posewise/report/calibration_tables.hpp"

#include <functional>

#include "posewise/report/units.hpp"

namespace posewise {
namespace {

using MetricRow = std::pair<std::string, std::function<double(const Metrics&)>>;

std::vector<MetricRow> list_metric_rows() {
    std::vector<MetricRow> rows{
        {"distance RMS", [](const Metrics& m) { return m.distance_rms; }},
        {"distance max", [](const Metrics& m) { return m.distance_max; }},
        {"distance mean", [](const Metrics& m) { return m.distance_mean; }},
        {"distance 95 %", [](const Metrics& m) { return m.distance_p95; }},
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::string name(1, static_cast<char>('x' + axis));
        rows.push_back({name + " RMS", [=](const Metrics& m) { return m.coordinate_rms[axis]; }});
        rows.push_back({name + " max", [=](const Metrics& m) { return m.coordinate_max[axis]; }});
    }
    return rows;
}

/// The numbers parameter_names() names, in SI units; the base's turn as a rotation vector.
VectorXd flatten(const Parameters& parameters) {
    const Eigen::AngleAxisd turn(parameters.world_from_base.linear());
    VectorXd values(6 + parameters.robot.size() + parameters.sensor.size());
    values << parameters.world_from_base.translation(), turn.angle() * turn.axis(),
        parameters.robot, parameters.sensor;
    return values;
}

}  // namespace

Table metrics_table(const std::vector<std::pair<std::string, Metrics>>& columns) {
    Table table;
    table.header = {"error/mm"};
    for (const auto& [name, metrics] : columns) table.header.push_back(name);
    for (const auto& [name, value] : list_metric_rows()) {
        std::vector<std::string> row{name};
        for (const auto& [unused, metrics] : columns) {
            row.push_back(metrics.point_count > 0 ? format_mm(value(metrics)) : "-");
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

Table parameter_table(const Campaign& campaign, const Estimate& estimate) {
    const VectorXd values = flatten(estimate.parameters);
    const VectorXd deviations = standard_deviations(estimate);
    const auto is_angle = parameter_is_angle(campaign);
    Table table{{"parameter", "value", "", "std. dev.", ""}, {}};
    for (Index k = 0; k < values.size(); ++k) {
        const auto i = static_cast<std::size_t>(k);
        const bool in_degrees = k >= 3 && k < 6;
        const double value = in_degrees ? to_degrees(values[k]) : mm_per_m * values[k];
        table.rows.push_back({estimate.names[i], format_fixed(value, 4),
                              in_degrees ? "deg" : std::string(error_unit(is_angle[i])),
                              format_fixed(mm_per_m * deviations[k], 4),
                              std::string(error_unit(is_angle[i]))});
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

}  // namespace posewise
