#include <cmath>

#include "../measurement/noise.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {

double ExpectedError::total() const {
    return std::sqrt(parameters * parameters + model * model + noise * noise);
}

Campaign with_model_error(const Campaign& campaign, const Estimate& estimate) {
    Campaign found = campaign;
    found.model_error = estimate.model_error;
    found.model_error_orientation = estimate.model_error_orientation;
    return found;
}

ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured) {
    Campaign without = campaign;
    without.model_error = without.model_error_orientation = 0;
    const Sensor& sensor = *campaign.sensor;
    const Index width = sensor.rows_per_target();
    // Angles count only where no length is measured, as in distances.
    const Index counted = sensor.lengths_per_target() > 0 ? sensor.lengths_per_target() : width;
    const double model_error =
        sensor.lengths_per_target() > 0 ? estimate.model_error : estimate.model_error_orientation;
    const RowMatrixXd repeats = times_seen(measured);
    FlangeMotion motion;
    RowMatrixXd J(sensor.row_count(), parameter_count(campaign));
    Index points = 0;
    double of_parameters = 0;
    double of_noise = 0;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const VectorXd q = measured.configurations.row(i).transpose();
        const VectorXd times = repeats.row(i).transpose();
        differentiate_pose(campaign, estimate.parameters, q, motion, J);
        const MatrixXd noise =
            detail::mean_covariance(without, motion, estimate.parameters.sensor, times);
        const RowMatrixXd seen = J(seen_rows(times.array() > 0, width), Eigen::all);
        const VectorXd variances = (seen * estimate.covariance).cwiseProduct(seen).rowwise().sum();
        for (Index row = 0; row < seen.rows(); row += width) {
            of_parameters += variances.segment(row, counted).sum();
            of_noise += noise.diagonal().segment(row, counted).sum();
            ++points;
        }
    }
    if (points == 0) return {};
    // Without priors the noise is that stated times the variance factor, as in the covariance.
    const double factor = campaign.spread.is_prior ? 1 : estimate.variance_factor;
    const auto count = static_cast<double>(points);
    return {std::sqrt(of_parameters / count),
            std::sqrt(factor * static_cast<double>(counted)) * model_error,
            std::sqrt(factor * of_noise / count)};
}

}  // namespace posewise
