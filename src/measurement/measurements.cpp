#include "posewise/measurement/measurements.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace posewise {

namespace {

/// Calls visit(configuration, target, samples that show it) for each that is seen at all.
template <typename Visit>
void for_each_seen(const Measurements& measurements, const Visit& visit) {
    std::vector<Index> samples;
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const Index first = measurements.first_sample[static_cast<std::size_t>(i)];
        for (Index j = 0; j < measurements.is_seen.cols(); ++j) {
            samples.clear();
            for (Index k = first; k < first + measurements.sample_count(i); ++k) {
                if (measurements.is_seen(k, j)) samples.push_back(k);
            }
            if (!samples.empty()) visit(i, j, samples);
        }
    }
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

Measurements mean_measurements(const Sensor& sensor, const Measurements& measurements) {
    const RowMatrixXd times = times_seen(measurements);
    Measurements means{measurements.configurations, measurements.ids, {}, times.array() > 0, {0}};
    means.observations.setZero(times.rows(), measurements.observations.cols());
    means.notation = measurements.notation;
    // Whole observations, of which only one target's part means anything.
    VectorXd deviation(means.observations.cols());
    VectorXd mean(means.observations.cols());
    for_each_seen(measurements, [&](Index i, Index j, const std::vector<Index>& samples) {
        const auto first = measurements.observations.row(samples.front()).transpose();
        const Index row = sensor.first_row(j);
        const Index width = sensor.rows_of(j);
        auto of_target = means.observations.row(i).segment(row, width);
        if (samples.size() == 1) {
            of_target = first.segment(row, width).transpose();
            return;
        }
        VectorXd sum = VectorXd::Zero(first.size());
        for (const Index k : samples) {
            sensor.deviation(measurements.observations.row(k).transpose(), first, deviation);
            sum += deviation;
        }
        sum /= static_cast<double>(samples.size());
        sensor.deviate(first, sum, mean);
        of_target = mean.segment(row, width).transpose();
    });
    means.first_sample.reserve(static_cast<std::size_t>(times.rows()) + 1);
    for (Index i = 0; i < times.rows(); ++i) means.first_sample.push_back(i + 1);
    return means;
}

std::string Measurements::sample_name(Index configuration, Index sample) const {
    const auto i = static_cast<std::size_t>(configuration);
    return ids[i] + ':' +
           (sample_names.empty() ? std::to_string(sample - first_sample[i] + 1)
                                 : sample_names[static_cast<std::size_t>(sample)]);
}

Measurements take(const Measurements& measurements, const std::vector<Index>& configurations) {
    Measurements taken;
    taken.notation = measurements.notation;
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
        if (measurements.roll_pitch_yaw.rows() > 0) {
            taken.roll_pitch_yaw.conservativeResize(taken.first_sample[k] + count, 3);
            taken.roll_pitch_yaw.bottomRows(count) =
                measurements.roll_pitch_yaw.middleRows(first, count);
        }
        if (measurements.sample_names.empty()) continue;
        const auto begin = measurements.sample_names.begin() + first;
        taken.sample_names.insert(taken.sample_names.end(), begin, begin + count);
    }
    return taken;
}

Measurements put_together(const std::vector<Measurements>& parts) {
    Measurements all;
    const auto append = [](auto& rows, const auto& more) {
        rows.conservativeResize(rows.rows() + more.rows(), more.cols());
        rows.bottomRows(more.rows()) = more;
    };
    const bool has_names = std::ranges::all_of(
        parts, [](const Measurements& part) { return !part.sample_names.empty(); });
    const bool has_angles = std::ranges::all_of(
        parts, [](const Measurements& part) { return part.roll_pitch_yaw.rows() > 0; });
    for (const Measurements& part : parts) {
        append(all.configurations, part.configurations);
        append(all.observations, part.observations);
        append(all.is_seen, part.is_seen);
        all.ids.insert(all.ids.end(), part.ids.begin(), part.ids.end());
        const Index before = all.first_sample.back();
        for (std::size_t i = 1; i < part.first_sample.size(); ++i) {
            all.first_sample.push_back(before + part.first_sample[i]);
        }
        if (has_names) {
            all.sample_names.insert(all.sample_names.end(), part.sample_names.begin(),
                                    part.sample_names.end());
        }
        if (has_angles) {
            append(all.roll_pitch_yaw, part.roll_pitch_yaw);
            all.notation = part.notation;
        }
    }
    return all;
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

std::vector<Index> evenly_spaced(Index count, Index most) {
    const Index taken = std::min(count, most);
    std::vector<Index> indices;
    for (Index k = 0; k < taken; ++k) indices.push_back(k * count / taken);
    return indices;
}

std::optional<Repeatability> repeatability(const Sensor& sensor, const Measurements& measurements) {
    const Measurements means = mean_measurements(sensor, measurements);
    // Of lengths, then of angles.
    std::array<double, 2> sum_of_squares{};
    std::array<double, 2> degrees_of_freedom{};
    for_each_seen(measurements, [&](Index i, Index j, const std::vector<Index>& samples) {
        const auto mean = means.observations.row(i).transpose();
        for (Index row = sensor.first_row(j); row < sensor.first_row(j + 1); ++row) {
            degrees_of_freedom[sensor.is_angle(row)] += static_cast<double>(samples.size()) - 1;
        }
        for (const Index k : samples) {
            const VectorXd d = sensor.deviation(measurements.observations.row(k).transpose(), mean);
            for (Index row = sensor.first_row(j); row < sensor.first_row(j + 1); ++row) {
                sum_of_squares[sensor.is_angle(row)] += d[row] * d[row];
            }
        }
    });
    if (degrees_of_freedom[0] == 0) return std::nullopt;
    Repeatability result{std::sqrt(sum_of_squares[0] / degrees_of_freedom[0])};
    if (degrees_of_freedom[1] > 0) {
        result.orientation = std::sqrt(sum_of_squares[1] / degrees_of_freedom[1]);
    }
    return result;
}

}  // namespace posewise
