#include "posewise/measurement/measurements.hpp"

#include <cmath>

namespace posewise {

RowMatrixXd mean_observations(const Measurements& measurements) {
    RowMatrixXd means(measurements.configuration_count(), measurements.observations.cols());
    for (Index i = 0; i < means.rows(); ++i) {
        means.row(i) = measurements.observations
                           .middleRows(measurements.first_sample[static_cast<std::size_t>(i)],
                                       measurements.sample_count(i))
                           .colwise()
                           .mean();
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
    for (std::size_t k = 0; k < configurations.size(); ++k) {
        const Index i = configurations[k];
        const Index count = measurements.sample_count(i);
        taken.observations.middleRows(taken.first_sample[k], count) =
            measurements.observations.middleRows(
                measurements.first_sample[static_cast<std::size_t>(i)], count);
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
    const RowMatrixXd means = mean_observations(measurements);
    double sum_of_squares = 0;
    Index degrees_of_freedom = 0;
    for (Index i = 0; i < means.rows(); ++i) {
        const Index count = measurements.sample_count(i);
        const auto samples = measurements.observations.middleRows(
            measurements.first_sample[static_cast<std::size_t>(i)], count);
        sum_of_squares += (samples.rowwise() - means.row(i)).squaredNorm();
        degrees_of_freedom += (count - 1) * means.cols();
    }
    if (degrees_of_freedom == 0) return std::nullopt;
    return std::sqrt(sum_of_squares / static_cast<double>(degrees_of_freedom));
}

}  // namespace posewise
