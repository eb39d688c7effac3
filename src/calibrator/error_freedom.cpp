#include <algorithm>
#include <cmath>

#include "../measurement/noise.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {
namespace {

/// Sums over configurations of what their squared errors are: those of all samples together, m^2.
struct SquaresSum {
    double mean = 0;
    double mean_squared = 0;
    double variance = 0;     ///< of normal errors
    MatrixXd parameters_in;  ///< J^T J of all samples
    double numbers = 0;      ///< of the targets seen, one sample each
};

/// The rows of one configuration: lengths (or angles) of the targets it shows.
class Rows {
  public:
    Rows(const Campaign& campaign, const Estimate& estimate)
        : campaign_(campaign),
          estimate_(estimate),
          without_(campaign),
          is_angle_(!campaign.sensor->has_lengths()),
          J_(campaign.sensor->row_count(), parameter_count(campaign)) {
        without_.model_error = without_.model_error_orientation = 0;
    }

    void add_to(SquaresSum& sum, const VectorXd& q, const VectorXd& times) {
        const Sensor& sensor = *campaign_.sensor;
        const Index width = sensor.rows_per_target();
        const Index begin = is_angle_ ? sensor.lengths_per_target() : 0;  // lengths come first
        const Index count = is_angle_ ? width - begin : sensor.lengths_per_target();
        differentiate_pose(campaign_, estimate_.parameters, q, motion_, J_);
        const VectorXd once = (times.array() > 0).cast<double>();
        const MatrixXd noise =
            detail::mean_covariance(without_, motion_, estimate_.parameters.sensor, once);
        const std::vector<Index> seen = seen_rows(times.array() > 0, width);
        std::vector<Index> kept;  // of the rows seen
        for (Index k = 0; k < std::ssize(seen); ++k) {
            if (k % width >= begin && k % width < begin + count) kept.push_back(k);
        }
        VectorXd weights(std::ssize(kept));
        RowMatrixXd J(weights.size(), J_.cols());
        for (Index k = 0; k < weights.size(); ++k) {
            const Index row = seen[static_cast<std::size_t>(kept[static_cast<std::size_t>(k)])];
            weights[k] = std::sqrt(times[row / width]);
            J.row(k) = weights[k] * J_.row(row);
        }
        const MatrixXd of_visit = factor() * (noise(kept, kept) + left_over(weights.size(), count));
        add(sum, J, weights.asDiagonal() * of_visit * weights.asDiagonal());
    }

  private:
    /// Without priors the noise is that stated times the variance factor, as in the covariance.
    double factor() const {
        return campaign_.spread.is_prior ? 1 : estimate_.variance_of(is_angle_).factor;
    }

    /// What the model lacks moves the flange, so that all targets are off alike; lengths in one
    /// direction each are not.
    MatrixXd left_over(Index rows, Index count) const {
        const double model = is_angle_ ? estimate_.model_error_orientation : estimate_.model_error;
        MatrixXd covariance = MatrixXd::Zero(rows, rows);
        for (Index a = 0; a < rows; ++a) {
            for (Index b = 0; b < rows; ++b) {
                if (count == 1 ? a == b : a % count == b % count) covariance(a, b) = model * model;
            }
        }
        return covariance;
    }

    void add(SquaresSum& sum, const RowMatrixXd& J, const MatrixXd& of_visit) const {
        const MatrixXd all = J * estimate_.covariance * J.transpose() + of_visit;
        sum.mean += all.trace();
        sum.mean_squared += all.trace() * all.trace();
        sum.variance += 2 * all.squaredNorm();
        sum.parameters_in += J.transpose() * J;
        sum.numbers += static_cast<double>(J.rows());
    }

    const Campaign& campaign_;
    const Estimate& estimate_;
    Campaign without_;  ///< a model error
    bool is_angle_;
    FlangeMotion motion_;
    RowMatrixXd J_;
};

}  // namespace

ErrorFreedom error_freedom(const Campaign& campaign, const Estimate& estimate,
                           const Measurements& measured) {
    SquaresSum sum;
    sum.parameters_in.setZero(parameter_count(campaign), parameter_count(campaign));
    const RowMatrixXd times = times_seen(measured);
    Rows rows(campaign, estimate);
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        rows.add_to(sum, measured.configurations.row(i).transpose(), times.row(i).transpose());
    }
    const auto count = static_cast<double>(measured.configuration_count());
    const double mean = sum.mean / count;
    if (!(mean > 0)) return {sum.numbers, sum.numbers};
    // Of one configuration's sum: by its errors, and by where it is.
    const double by_place = count > 1 ? (sum.mean_squared - count * mean * mean) / (count - 1) : 0;
    const MatrixXd shared_errors = estimate.covariance * sum.parameters_in / count;
    const double shared = 2 * shared_errors.cwiseProduct(shared_errors.transpose()).sum();
    const double of_visits = std::max(sum.variance / count + by_place - shared, 0.0) / count;
    const auto freedom = [&](double variance) {
        return std::min(2 * mean * mean / variance, sum.numbers);
    };
    return {freedom(of_visits), freedom(of_visits + shared)};
}

}  // namespace posewise
