#include <algorithm>
#include <cmath>

#include "measurement/noise.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

/// The targets' rows that a sample shows, less those of the mean, whitened by the instrument's
/// noise alone.
RowMatrixXd whitened_deviation(const Campaign& instrument, const Parameters& parameters,
                               const Measurements& measured, Index sample, const VectorXd& q,
                               const VectorXd& mean) {
    const Sensor& sensor = *instrument.sensor;
    const std::vector<Index> rows = seen_rows(sensor, measured.is_seen.row(sample));
    VectorXd observed = mean;
    observed(rows) = measured.observations.row(sample).transpose()(rows);
    FlangeMotion motion;
    motion.world_from_flange = world_from_flange(instrument, parameters, q);
    const VectorXd seen = measured.is_seen.row(sample).cast<double>().transpose();
    RowMatrixXd deviation = sensor.deviation(observed, mean);
    const Index count =
        detail::PoseNoise(instrument).whiten_seen(motion, parameters.sensor, seen, deviation);
    return deviation.topRows(count);
}

}  // namespace

std::optional<ScatterDoubt> find_scatter_doubt(const Campaign& campaign,
                                               const Measurements& measured,
                                               const Parameters& parameters) {
    constexpr double gross = 3;
    Campaign instrument = campaign;
    instrument.model_error = instrument.model_error_orientation = 0;
    instrument.joint_repeatability.resize(0);
    const Measurements means = mean_measurements(*campaign.sensor, measured);
    const RowMatrixXd times = times_seen(measured);
    double squares = 0;
    double freedom = 0;
    double farthest = 0;
    ScatterDoubt doubt;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        for (Index j = 0; j < times.cols(); ++j) {
            freedom +=
                static_cast<double>(campaign.sensor->rows_of(j)) * std::max(0.0, times(i, j) - 1);
        }
        if (measured.sample_count(i) < 2) continue;
        const VectorXd q = measured.configurations.row(i).transpose();
        const VectorXd mean = means.observations.row(i).transpose();
        const Index first = measured.first_sample[static_cast<std::size_t>(i)];
        for (Index k = first; k < first + measured.sample_count(i); ++k) {
            const double square =
                whitened_deviation(instrument, parameters, measured, k, q, mean).squaredNorm();
            squares += square;
            if (square <= farthest) continue;
            farthest = square;
            doubt.sample = measured.sample_name(i, k);
        }
    }
    if (freedom == 0) return std::nullopt;
    doubt.ratio = std::sqrt(squares / freedom);
    if (doubt.ratio < gross) return std::nullopt;
    return doubt;
}

}  // namespace posewise
