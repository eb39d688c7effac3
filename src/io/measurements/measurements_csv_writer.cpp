#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "measurement_columns.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise::io {

namespace {

/// Joint values of a configuration, each after a comma.
std::string joint_cells(const Measurements& measurements, Index configuration,
                        const std::vector<double>& factors) {
    std::string cells;
    for (Index j = 0; j < measurements.configurations.cols(); ++j) {
        fmt::format_to(
            std::back_inserter(cells), ",{}",
            measurements.configurations(configuration, j) * factors[static_cast<std::size_t>(j)]);
    }
    return cells;
}

/// The observation of a sample, empty where it does not show a target.
std::string observation_cells(const Sensor& sensor, const Measurements& measurements,
                              Index sample) {
    std::string cells;
    Index row = 0;
    for (Index target = 0; target < measurements.is_seen.cols(); ++target) {
        const bool is_seen = measurements.is_seen(sample, target);
        for (; row < sensor.first_row(target + 1); ++row) {
            const bool is_in_rad = detail::quantity_of_row(sensor, row) == detail::Quantity::Angle;
            const double factor = is_in_rad ? 1 : 1e3;
            cells +=
                is_seen ? fmt::format(",{}", factor * measurements.observations(sample, row)) : ",";
        }
    }
    return cells;
}

/// A row for each corner seen: its place in px and its number.
void write_corners(const std::vector<detail::CornerSensor>& sensors,
                   const std::vector<std::string_view>& columns, const Measurements& measurements,
                   Index sample, const std::string& before, std::string& text) {
    const auto has = [&](std::string_view name) {
        return std::ranges::find(columns, name) != columns.end();
    };
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        const detail::CornerSensor& one = sensors[k];
        for (Index own = 0; own < one.sensor->target_count(); ++own) {
            const Index target = one.first_target + own;
            if (!measurements.is_seen(sample, target)) continue;
            const VectorXd place =
                1e3 * measurements.observations.row(sample).segment<2>(2 * target);
            fmt::format_to(std::back_inserter(text), "{},{},{},{}", before, place[0], place[1],
                           first_corner(*one.sensor) + own % one.corners());
            if (has(detail::camera_column)) text += fmt::format(",{}", own / one.corners() + 1);
            if (has(detail::sensor_column)) text += fmt::format(",{}", k + 1);
            text += '\n';
        }
    }
}

bool is_finite(const Sensor& sensor, const Measurements& measurements) {
    if (!measurements.configurations.allFinite()) return false;
    for (Index sample = 0; sample < measurements.is_seen.rows(); ++sample) {
        for (Index target = 0; target < measurements.is_seen.cols(); ++target) {
            if (measurements.is_seen(sample, target) &&
                !measurements.observations.row(sample)
                     .segment(sensor.first_row(target), sensor.rows_of(target))
                     .allFinite()) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace

void write_measurements_csv(const std::string& path, const Campaign& campaign,
                            const Measurements& observed,
                            const std::vector<std::string>& comment_lines) {
    Measurements measurements = observed;
    if (records_inverse(*campaign.sensor)) invert_poses(measurements.observations);
    if (!is_finite(*campaign.sensor, measurements)) {
        throw input_error_at({path},
                             "is not written, since a measurement is not a finite number; the "
                             "campaign's amounts must be smaller");
    }
    std::string text;
    const auto out = std::back_inserter(text);
    for (const std::string& line : comment_lines) {
        fmt::format_to(out, "# {}\n", detail::escape_controls(line));
    }
    text += "config,sample";
    std::vector<double> joint_factors;  // to the unit written
    const bool has_corners = campaign.sensor->has_only_pixels();
    const auto form = has_corners ? detail::Form::RowEachCorner : detail::Form::RowEachSample;
    for (const detail::WantedColumn& column : detail::wanted_columns(campaign, form)) {
        text += ',' + column.example();
        if (column.role == detail::Role::Joint) {
            joint_factors.push_back(column.quantity == detail::Quantity::Length ? 1e3 : 1);
        }
    }
    const bool has_contact = campaign.sensor->has_contacts();
    if (has_contact) fmt::format_to(out, ",{}", detail::contact);
    const auto sensors = detail::corner_sensors(*campaign.sensor);
    const auto corner_columns =
        has_corners ? detail::corner_columns(*campaign.sensor) : std::vector<std::string_view>();
    for (const std::string_view name : corner_columns) fmt::format_to(out, ",{}", name);
    text += '\n';
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        const std::string joints = joint_cells(measurements, i, joint_factors);
        for (Index sample = 0; sample < measurements.sample_count(i); ++sample) {
            const Index row = measurements.first_sample[k] + sample;
            if (has_corners) {
                const std::string before =
                    fmt::format("{},{}{}", detail::csv_field(measurements.ids[k]), sample, joints);
                write_corners(sensors, corner_columns, measurements, row, before, text);
                continue;
            }
            fmt::format_to(
                out, "{},{}{}{}\n", detail::csv_field(measurements.ids[k]), sample, joints,
                has_contact ? ',' + detail::seen_cell(campaign, measurements.is_seen.row(row))
                            : observation_cells(*campaign.sensor, measurements, row));
        }
    }
    detail::write_file(path, text);
}

}  // namespace posewise::io
