#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "../../src/measurement/noise.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"

/// How often what simulated calibrations say is within their 95 % intervals of what is true.
namespace posewise::testing {

/// Part of the predictions that are within their intervals, of campaigns that are independent of
/// each other.
class Share {
  public:
    void add(double error, double deviation) {
        constexpr double quantile = 1.959964;
        covered_ += std::abs(error) <= quantile * deviation ? 1 : 0;
        ++count_;
    }
    void end_campaign() {
        campaigns_.emplace_back(covered_, count_);
        covered_ = count_ = 0;
    }
    double value() const {
        double covered = 0, count = 0;
        for (const auto& [c, n] : campaigns_) covered += c, count += n;
        return covered / count;
    }
    /// Its standard deviation, from how campaigns differ: predictions of one are not independent.
    double deviation() const {
        double squares = 0, count = 0;
        for (const auto& [c, n] : campaigns_) {
            squares += (c - n * value()) * (c - n * value());
            count += n;
        }
        return std::sqrt(squares) / count;
    }

  private:
    double covered_ = 0;
    double count_ = 0;
    std::vector<std::pair<double, double>> campaigns_;
};

struct Coverage {
    Share parameters;  ///< of the robot, that truth and model both have
    /// Coordinates of one target at poses not measured, of positions and orientations: by the
    /// parameters, and as they would be measured, with model error and noise.
    Share positions[2], orientations[2];
};

struct CoverageCase {
    Campaign truth;
    Campaign stated;  ///< with which it is calibrated
    Index pose_count = 12;
    LossKind loss = LossKind::Squares;
};

inline void judge_parameters(const CoverageCase& of, const Parameters& truth,
                             const Estimate& estimate, Coverage& coverage) {
    const auto true_names = of.truth.robot.parameter_names();
    const auto names = of.stated.robot.parameter_names();
    const VectorXd deviations = standard_deviations(estimate).segment(
        base_parameter_count(of.stated), of.stated.robot.parameter_count());
    for (Index k = 0; k < deviations.size(); ++k) {
        const auto found =
            std::find(true_names.begin(), true_names.end(), names[static_cast<std::size_t>(k)]);
        if (found == true_names.end()) continue;
        const double true_value = truth.robot[found - true_names.begin()];
        coverage.parameters.add(estimate.parameters.robot[k] - true_value, deviations[k]);
    }
    coverage.parameters.end_campaign();
}

inline void judge_poses(const CoverageCase& of, const Parameters& truth, const Estimate& estimate,
                        const RowMatrixXd& configurations, std::uint64_t seed, Coverage& coverage) {
    const Measurements measured = simulate_measurements(of.truth, truth, configurations, 1, seed);
    const Campaign found = with_model_error(of.stated, estimate);
    const Sensor& sensor = *found.sensor;
    FlangeMotion motion;
    RowMatrixXd J(sensor.row_count(), parameter_count(found));
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        differentiate_pose(found, estimate.parameters, q, motion, J);
        const VectorXd predicted =
            sensor.predict(motion.world_from_flange, estimate.parameters.sensor);
        const VectorXd true_values =
            sensor.predict(world_from_flange(of.truth, truth, q), truth.sensor);
        const VectorXd error = sensor.deviation(true_values, predicted);
        const VectorXd measured_error =
            sensor.deviation(measured.observations.row(i).transpose(), predicted);
        const VectorXd variances = (J * estimate.covariance).cwiseProduct(J).rowwise().sum();
        const MatrixXd noise = detail::mean_covariance(found, motion, estimate.parameters.sensor,
                                                       VectorXd::Ones(sensor.target_count()));
        for (Index row = 0; row < sensor.rows_per_target(); ++row) {
            auto& shares = sensor.is_angle(row) ? coverage.orientations : coverage.positions;
            // Without priors the noise is that stated times the variance factor.
            const double factor =
                found.spread.is_prior ? 1 : estimate.variance_of(sensor.is_angle(row)).factor;
            shares[0].add(error[row], std::sqrt(variances[row]));
            shares[1].add(measured_error[row],
                          std::sqrt(variances[row] + factor * noise(row, row)));
        }
    }
    for (Share& share : coverage.positions) share.end_campaign();
    for (Share& share : coverage.orientations) share.end_campaign();
}

/// Each campaign has a robot, poses and noise of its own.
inline Coverage simulate_coverage(const CoverageCase& of, Index campaigns, Index fresh_poses) {
    LevenbergMarquardtOptions options;
    options.loss.kind = of.loss;
    Coverage coverage;
    for (Index run = 0; run < campaigns; ++run) {
        const auto seed = 3 * static_cast<std::uint64_t>(run);
        const Simulation simulated = simulate(of.truth, {of.pose_count, 1, seed, seed + 1});
        const Parameters start =
            register_base_and_targets(of.stated, simulated.measurements).parameters;
        const Estimate estimate = identify(of.stated, simulated.measurements, start, options);
        judge_parameters(of, simulated.truth, estimate, coverage);
        judge_poses(of, simulated.truth, estimate,
                    detail::random_configurations(of.truth.robot, fresh_poses, seed + 2), seed + 2,
                    coverage);
    }
    return coverage;
}

}  // namespace posewise::testing
