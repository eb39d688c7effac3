#include "posewise/measurement/measurements.hpp"

#include <algorithm>
#include <cmath>

namespace posewise {

namespace {

/// The observations, with row i of `by` where a sample of configuration i does not show a target.
RowMatrixXd fill_unseen(const Measurements& measurements, const RowMatrixXd& by) {
    RowMatrixXd filled = measurements.observations;
    const Index targets = measurements.is_seen.cols();
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const Index first = measurements.first_sample[static_cast<std::size_t>(i)];
        for (Index k = first; k < first + measurements.sample_count(i); ++k) {
            for (Index j = 0; j < targets; ++j) {
                const Index width = filled.cols() / targets;
                if (measurements.is_seen(k, j)) continue;
                filled.row(k).segment(width * j, width) = by.row(i).segment(width * j, width);
            }
        }
    }
    return filled;
}

}  // namespace

RowMatrixXd times_seen(const Measurements& measurements) {
    RowMatrixXd times(measurements.configuration_count(), measurements.is_seen.cols());
    for (Index i = 0; i < times.rows(); ++i) {
        times.row(i) = measurements.is_seen
                           .middleRows(measurements.first_sample[static_cast<std::size_t>(i)],
                                       measurements.sample_count(i))
                           .cast<double>()
                           .colwise()
                           .sum();
    }
    return times;
}

RowMatrixXd share_seen(const Measurements& measurements) {
    RowMatrixXd share = times_seen(measurements);
    for (Index i = 0; i < share.rows(); ++i) {
        share.row(i) /= static_cast<double>(measurements.sample_count(i));
    }
    return share;
}

Measurements mean_measurements(const Measurements& measurements) {
    const RowMatrixXd times = times_seen(measurements);
    Measurements means{measurements.configurations, measurements.ids, {}, times.array() > 0, {0}};
    means.observations.setZero(times.rows(), measurements.observations.cols());
    const RowMatrixXd seen = fill_unseen(measurements, means.observations);
    for (Index i = 0; i < times.rows(); ++i) {
        means.observations.row(i) =
            seen.middleRows(measurements.first_sample[static_cast<std::size_t>(i)],
                            measurements.sample_count(i))
                .colwise()
                .sum();
        for (Index j = 0; j < times.cols(); ++j) {
            const Index width = seen.cols() / times.cols();
            means.observations.row(i).segment(width * j, width) /= std::max(times(i, j), 1.0);
        }
        means.first_sample.push_back(i + 1);
    }
    return means;
}

Measurements take(const Measurements& measurements, const std::vector<Index>& configurations) {
    Measurements taken;
    taken.configurations.resize(static_cast<Index>(configurations.size()),
                                measurements.configurations.cols());
    for (const Index i : configurations) {
        taken.configurations.row(taken.configuration_count()) = measurements.configurations.row(i);
        taken.ids.push_back(measurements.ids[static_cast<std::size_t>(i)]);
        taken.first_sample.push_back(taken.first_sample.back() + measurements.sample_count(i));
    }
    taken.observations.resize(taken.first_sample.back(), measurements.observations.cols());
    taken.is_seen.resize(taken.first_sample.back(), measurements.is_seen.cols());
    for (std::size_t k = 0; k < configurations.size(); ++k) {
        const auto i = static_cast<std::size_t>(configurations[k]);
        const Index first = measurements.first_sample[i];
        const Index count = measurements.sample_count(configurations[k]);
        taken.observations.middleRows(taken.first_sample[k], count) =
            measurements.observations.middleRows(first, count);
        taken.is_seen.middleRows(taken.first_sample[k], count) =
            measurements.is_seen.middleRows(first, count);
    }
    return taken;
}

std::vector<Index> all_but(Index count, const std::vector<Index>& left_out) {
    std::vector<bool> out(static_cast<std::size_t>(count), false);
    for (const Index i : left_out) out[static_cast<std::size_t>(i)] = true;
    std::vector<Index> others;
    for (Index i = 0; i < count; ++i) {
        if (!out[static_cast<std::size_t>(i)]) others.push_back(i);
    }
    return others;
}

std::optional<double> repeatability(const Measurements& measurements) {
    const RowMatrixXd means = mean_measurements(measurements).observations;
    const RowMatrixXd times = times_seen(measurements);
    const RowMatrixXd observations = fill_unseen(measurements, means);  // no deviation there
    double sum_of_squares = 0;
    double degrees_of_freedom = 0;
    for (Index i = 0; i < means.rows(); ++i) {
        const auto samples = observations.middleRows(
            measurements.first_sample[static_cast<std::size_t>(i)], measurements.sample_count(i));
        sum_of_squares += (samples.rowwise() - means.row(i)).squaredNorm();
        const auto width = static_cast<double>(means.cols() / times.cols());
        degrees_of_freedom += width * (times.row(i).array() - 1).max(0).sum();
    }
    if (degrees_of_freedom == 0) return std::nullopt;
    return std::sqrt(sum_of_squares / degrees_of_freedom);
}

}  // namespace posewise
