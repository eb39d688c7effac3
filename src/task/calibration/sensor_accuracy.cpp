#include "sensor_accuracy.hpp"

#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {
namespace {

/// Columns of a part's own residuals among all: its lengths, then its angles.
std::vector<Index> columns_of(const CombinedSensor& combined, const Sensor& part) {
    std::vector<Index> columns;
    for (Index k = 0; k < part.rows_per_target(); ++k) {
        const Index lengths = part.lengths_per_target();
        columns.push_back(k < lengths ? k : combined.lengths_per_target() + k - lengths);
    }
    return columns;
}

Metrics metrics_of(const Sensor& part, const RowMatrixXd& residuals, const std::vector<Index>& rows,
                   const std::vector<Index>& columns) {
    return make_metrics(RowMatrixXd(residuals(rows, columns)), part);
}

}  // namespace

std::vector<SensorAccuracy> accuracy_by_sensor(const Sensor& sensor, const Seen& is_seen,
                                               const RowMatrixXd& nominal, const RowMatrixXd& fit,
                                               const RowMatrixXd& held_out) {
    const auto* const combined = dynamic_cast<const CombinedSensor*>(&sensor);
    if (combined == nullptr) return {};
    std::vector<std::vector<Index>> rows(static_cast<std::size_t>(combined->part_count()));
    Index row = 0;
    for (Index sample = 0; sample < is_seen.rows(); ++sample) {
        for (const Index target : targets_seen(is_seen.row(sample))) {
            rows[static_cast<std::size_t>(combined->part_of(target))].push_back(row++);
        }
    }
    std::vector<SensorAccuracy> all;
    for (Index k = 0; k < combined->part_count(); ++k) {
        const Sensor& part = *combined->part(k).sensor;
        const auto& own = rows[static_cast<std::size_t>(k)];
        const std::vector<Index> columns = columns_of(*combined, part);
        SensorAccuracy& accuracy = all.emplace_back();
        accuracy.readings = part.words().readings;
        accuracy.units = &part.main_units();
        accuracy.nominal = metrics_of(part, nominal, own, columns);
        accuracy.fit = metrics_of(part, fit, own, columns);
        if (held_out.rows() == fit.rows()) {
            accuracy.held_out = metrics_of(part, held_out, own, columns);
        }
    }
    return all;
}

}  // namespace posewise::detail
