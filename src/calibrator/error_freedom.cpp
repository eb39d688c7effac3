#include <algorithm>
#include <cmath>

#include "measurement/noise.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {
namespace {

/// One configuration's lengths (or angles, where none is measured) of the targets it shows.
struct Visit {
    VectorXd times;             ///< samples that show each, a number a row
    VectorXd residuals;         ///< of the means, m or rad
    std::vector<Index> axes{};  ///< directions of these, alike for all targets; -1: its own
    MatrixXd known;             ///< covariance of one sample by the parameters and by noise
};

/// What single samples at measured configurations are off by, by the estimate.
class Visits {
  public:
    Visits(const Campaign& campaign, const Estimate& estimate, const Measurements& measured)
        : is_angle_(!campaign.sensor->has_lengths()),
          // Without priors the noise is that stated times the variance factor, as in the
          // covariance.
          factor_(campaign.spread.is_prior ? 1 : estimate.variance_of(is_angle_).factor),
          shared_(MatrixXd::Zero(parameter_count(campaign), parameter_count(campaign))) {
        const double model = is_angle_ ? estimate.model_error_orientation : estimate.model_error;
        left_over_ = factor_ * model * model;
        collect(campaign, estimate, measured);
        find_common_part();
    }

    ErrorFreedom freedom() const {
        double mean = 0;
        double mean_squared = 0;
        double variance = 0;
        double numbers = 0;
        for (const Visit& visit : visits_) {
            const MatrixXd all = weighted_covariance(visit);
            mean += all.trace();
            mean_squared += all.trace() * all.trace();
            variance += 2 * all.squaredNorm();
            numbers += static_cast<double>(all.rows());
        }
        const auto count = static_cast<double>(visits_.size());
        mean /= count;
        if (!(mean > 0)) return {numbers, numbers};
        // Of one configuration's sum: by its errors, and by where it is.
        const double by_place = count > 1 ? (mean_squared - count * mean * mean) / (count - 1) : 0;
        const double shared = 2 * shared_.cwiseProduct(shared_.transpose()).sum();
        const double of_visits = std::max(variance / count + by_place - shared, 0.0) / count;
        const auto of_variance = [&](double of_mean) {
            return std::min(2 * mean * mean / of_mean, numbers);
        };
        return {of_variance(of_visits), of_variance(of_visits + shared)};
    }

  private:
    void collect(const Campaign& campaign, const Estimate& estimate, const Measurements& measured) {
        const Sensor& sensor = *campaign.sensor;
        Campaign without = campaign;
        without.model_error = without.model_error_orientation = 0;
        const RowMatrixXd times = times_seen(measured);
        const RowMatrixXd residuals = mean_residuals(campaign, estimate.parameters, measured);
        FlangeMotion motion;
        RowMatrixXd J(sensor.row_count(), parameter_count(campaign));
        Index first = 0;  // of the residuals, which have a row a target
        for (Index i = 0; i < measured.configuration_count(); ++i) {
            const VectorXd seen = (times.row(i).transpose().array() > 0).cast<double>();
            if (seen.sum() == 0) continue;
            const VectorXd q = measured.configurations.row(i).transpose();
            differentiate_pose(campaign, estimate.parameters, q, motion, J);
            const MatrixXd noise =
                detail::mean_covariance(without, motion, estimate.parameters.sensor, seen);
            add(sensor, times.row(i).transpose(), J, factor_ * noise, estimate.covariance,
                residuals.middleRows(first, static_cast<Index>(seen.sum())));
            first += static_cast<Index>(seen.sum());
        }
        shared_ = (estimate.covariance * shared_ / static_cast<double>(visits_.size())).eval();
    }

    /// `noise` and `residuals` are of the targets seen.
    void add(const Sensor& sensor, const VectorXd& times, const RowMatrixXd& J,
             const MatrixXd& noise, const MatrixXd& covariance, const RowMatrixXd& residuals) {
        std::vector<Index> rows;  // of a whole observation
        std::vector<Index> kept;  // of those seen
        const std::vector<Index> seen = seen_rows(sensor, times.array() > 0);
        for (Index k = 0; k < std::ssize(seen); ++k) {
            const Index row = seen[static_cast<std::size_t>(k)];
            if (sensor.is_angle(row) != is_angle_) continue;
            rows.push_back(row);
            kept.push_back(k);
        }
        Visit& visit = visits_.emplace_back();
        const Index size = std::ssize(rows);
        visit.times.resize(size);
        visit.residuals.resize(size);
        for (Index k = 0; k < size; ++k) {
            const Index row = rows[static_cast<std::size_t>(k)];
            const Index target = sensor.target_of(row);
            const Index before = (times.head(target).array() > 0).count();
            const Index column = sensor.column_of(row);
            visit.times[k] = times[target];
            visit.residuals[k] = residuals(before, column);
            visit.axes.push_back(sensor.rows_of(target) == 1 ? -1 : column);
        }
        const RowMatrixXd J_seen = J(rows, Eigen::all);
        visit.known = J_seen * covariance * J_seen.transpose() + noise(kept, kept);
        shared_ += J_seen.transpose() * visit.times.asDiagonal() * J_seen;
    }

    /// Calls visit(a, b) with the numbers of two targets in the same direction. Where each target
    /// has one length there are none: it has its own direction.
    template <typename Action>
    void for_each_pair(const Visit& visit, const Action& action) const {
        for (Index a = 0; a < visit.times.size(); ++a) {
            const Index axis = visit.axes[static_cast<std::size_t>(a)];
            for (Index b = 0; b < visit.times.size() && axis >= 0; ++b) {
                if (a != b && visit.axes[static_cast<std::size_t>(b)] == axis) action(a, b);
            }
        }
    }

    /// How much of what the model leaves over moves the flange, so that all targets are off alike.
    void find_common_part() {
        double found = 0;
        double pairs = 0;
        for (const Visit& visit : visits_) {
            for_each_pair(visit, [&](Index a, Index b) {
                found += visit.residuals[a] * visit.residuals[b] - visit.known(a, b);
                ++pairs;
            });
        }
        if (pairs * left_over_ > 0) common_ = std::clamp(found / (pairs * left_over_), 0.0, 1.0);
    }

    /// Of all samples of a configuration, whose squares add up.
    MatrixXd weighted_covariance(const Visit& visit) const {
        MatrixXd all = visit.known;
        all.diagonal().array() += left_over_;
        for_each_pair(visit, [&](Index a, Index b) { all(a, b) += common_ * left_over_; });
        const VectorXd weights = visit.times.cwiseSqrt();
        return weights.asDiagonal() * all * weights.asDiagonal();
    }

    bool is_angle_;
    double factor_;
    double left_over_ = 0;  ///< variance by the model error
    double common_ = 0;     ///< part of it
    std::vector<Visit> visits_;
    MatrixXd shared_;  ///< covariance of the parameters times the mean J^T J of a configuration
};

}  // namespace

ErrorFreedom error_freedom(const Campaign& campaign, const Estimate& estimate,
                           const Measurements& measured) {
    return Visits(campaign, estimate, measured).freedom();
}

}  // namespace posewise
