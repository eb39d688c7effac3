#include "posewise/calibrator/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "residual_lengths.hpp"

namespace posewise {

ResidualVariance Estimate::variance_of(bool is_angle) const {
    if (!variance_by_kind.empty()) return variance_by_kind[is_angle ? 1 : 0];
    return {variance_factor, static_cast<double>(degrees_of_freedom)};
}

VectorXd standard_deviations(const Estimate& estimate) {
    return estimate.covariance.diagonal().cwiseSqrt();
}

std::vector<Correlation> strongest_correlations(const Estimate& estimate, Index count) {
    const VectorXd sigma = standard_deviations(estimate);
    std::vector<Correlation> all;
    for (Index i = 0; i < sigma.size(); ++i) {
        for (Index j = i + 1; j < sigma.size(); ++j) {
            const double product = sigma[i] * sigma[j];
            if (product > 0) all.push_back({i, j, estimate.covariance(i, j) / product});
        }
    }
    std::stable_sort(all.begin(), all.end(), [](const Correlation& a, const Correlation& b) {
        return std::abs(a.coefficient) > std::abs(b.coefficient);
    });
    all.resize(std::min(all.size(), static_cast<std::size_t>(std::max<Index>(count, 0))));
    return all;
}

RowMatrixXd residuals(const Campaign& campaign, const Parameters& parameters,
                      const Measurements& measurements) {
    const Sensor& sensor = *campaign.sensor;
    RowMatrixXd r = RowMatrixXd::Constant(measurements.is_seen.count(), sensor.rows_per_target(),
                                          std::numeric_limits<double>::quiet_NaN());
    VectorXd q(measurements.configurations.cols());
    VectorXd predicted(campaign.sensor->row_count());
    VectorXd deviation(campaign.sensor->row_count());
    Index row = 0;
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        q = measurements.configurations.row(i).transpose();
        campaign.sensor->predict(world_from_flange(campaign, parameters, q), parameters.sensor,
                                 predicted);
        const Index first = measurements.first_sample[static_cast<std::size_t>(i)];
        for (Index sample = first; sample < first + measurements.sample_count(i); ++sample) {
            campaign.sensor->deviation(measurements.observations.row(sample).transpose(), predicted,
                                       deviation);
            for (Index j = 0; j < measurements.is_seen.cols(); ++j) {
                if (!measurements.is_seen(sample, j)) continue;
                for (Index k = sensor.first_row(j); k < sensor.first_row(j + 1); ++k) {
                    r(row, sensor.column_of(k)) = deviation[k];
                }
                ++row;
            }
        }
    }
    return r;
}

RowMatrixXd mean_residuals(const Campaign& campaign, const Parameters& parameters,
                           const Measurements& measurements) {
    return residuals(campaign, parameters, mean_measurements(*campaign.sensor, measurements));
}

namespace {

/// 0 where a target has no such number.
RowMatrixXd without_gaps(const Eigen::Ref<const RowMatrixXd>& residuals) {
    return residuals.array().isNaN().select(0, residuals);
}

/// The rows of targets that have any of these numbers.
RowMatrixXd rows_of_kind(const Eigen::Ref<const RowMatrixXd>& residuals) {
    if (residuals.cols() == 0 || !residuals.hasNaN()) return residuals;
    std::vector<Index> rows;
    for (Index row = 0; row < residuals.rows(); ++row) {
        if (!residuals.row(row).array().isNaN().all()) rows.push_back(row);
    }
    return residuals(rows, Eigen::all);
}

/// Of some columns of the means' residuals, configurations x targets; 0 where a target was not
/// seen.
RowMatrixXd squares_of(const Campaign& campaign, const Parameters& parameters,
                       const Measurements& measurements, Index first, Index count) {
    const Measurements means = mean_measurements(*campaign.sensor, measurements);
    const RowMatrixXd r = residuals(campaign, parameters, means);
    RowMatrixXd squares = RowMatrixXd::Zero(means.is_seen.rows(), means.is_seen.cols());
    Index row = 0;
    for (Index i = 0; i < squares.rows(); ++i) {
        for (Index j = 0; j < squares.cols(); ++j) {
            if (!means.is_seen(i, j)) continue;
            squares(i, j) = without_gaps(r.row(row++).segment(first, count)).squaredNorm();
        }
    }
    return squares;
}

}  // namespace

VectorXd detail::residual_lengths(const Eigen::Ref<const RowMatrixXd>& residuals) {
    return without_gaps(rows_of_kind(residuals)).rowwise().norm();
}

RowMatrixXd squared_distances(const Campaign& campaign, const Parameters& parameters,
                              const Measurements& measurements) {
    const Sensor& sensor = *campaign.sensor;
    const Index count =
        sensor.has_lengths() ? sensor.lengths_per_target() : sensor.rows_per_target();
    return squares_of(campaign, parameters, measurements, 0, count);
}

RowMatrixXd squared_angles(const Campaign& campaign, const Parameters& parameters,
                           const Measurements& measurements) {
    const Index lengths = campaign.sensor->lengths_per_target();
    return squares_of(campaign, parameters, measurements, lengths,
                      campaign.sensor->rows_per_target() - lengths);
}

Metrics make_metrics(const RowMatrixXd& residuals, Index length_count) {
    Metrics metrics;
    metrics.point_count = residuals.rows();
    metrics.coordinate_count = std::min({length_count, residuals.cols(), Index{3}});
    metrics.has_orientation = residuals.cols() > length_count;
    if (metrics.point_count == 0) return metrics;
    const auto points = residuals.leftCols(metrics.coordinate_count);
    VectorXd distances = detail::residual_lengths(points);
    if (distances.size() > 0) {
        std::sort(distances.begin(), distances.end());
        metrics.distance_rms = distances.norm() / std::sqrt(static_cast<double>(distances.size()));
        metrics.distance_max = distances[distances.size() - 1];
        metrics.distance_mean = distances.mean();
        metrics.distance_p95 = quantile(distances, 0.95, detail::QuantileRule::Lower);
    }
    for (Index axis = 0; axis < metrics.coordinate_count; ++axis) {
        const auto i = static_cast<std::size_t>(axis);
        const RowMatrixXd along = rows_of_kind(points.col(axis));
        if (along.rows() == 0) continue;
        metrics.coordinate_rms[i] = along.norm() / std::sqrt(static_cast<double>(along.rows()));
        metrics.coordinate_max[i] = along.cwiseAbs().maxCoeff();
    }
    if (metrics.has_orientation) {
        VectorXd angles =
            detail::residual_lengths(residuals.rightCols(residuals.cols() - length_count));
        if (angles.size() == 0) return metrics;
        std::sort(angles.begin(), angles.end());
        metrics.orientation_rms = angles.norm() / std::sqrt(static_cast<double>(angles.size()));
        metrics.orientation_max = angles[angles.size() - 1];
        metrics.orientation_p95 = quantile(angles, 0.95, detail::QuantileRule::Lower);
    }
    return metrics;
}

Metrics make_metrics(const RowMatrixXd& residuals, const Sensor& sensor) {
    Metrics metrics = make_metrics(residuals, sensor.lengths_per_target());
    metrics.orientation_units = &sensor.units(true);
    return metrics;
}

Metrics make_metrics(const Campaign& campaign, const Parameters& parameters,
                     const Measurements& measurements) {
    return make_metrics(residuals(campaign, parameters, measurements), *campaign.sensor);
}

}  // namespace posewise
