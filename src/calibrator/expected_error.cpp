#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/decompositions.hpp"
#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "measurement/noise.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {
namespace {

/// Mean squares (m^2, rad^2) of what one target at one configuration is off by.
struct PointError {
    double parameters = 0;
    double model = 0;
    double noise = 0;
    /// Of the chi squared with the mean and variance of the whole square.
    double degrees_of_freedom = 1;

    double total() const { return parameters + model + noise; }
};

/// Where among these rows the lengths of each target are, or its angles: the first and how many.
std::vector<std::pair<Index, Index>> parts_of_kind(const Sensor& sensor,
                                                   const std::vector<Index>& rows, bool is_angle) {
    std::vector<std::pair<Index, Index>> parts;
    Index target = -1;
    for (Index k = 0; k < std::ssize(rows); ++k) {
        const Index row = rows[static_cast<std::size_t>(k)];
        if (sensor.is_angle(row) != is_angle) continue;
        const Index of_row = sensor.target_of(row);
        if (of_row != target) parts.emplace_back(k, 0);
        target = of_row;
        ++parts.back().second;
    }
    return parts;
}

/// Of the lengths of each target, or of its angles, in the configurations' order; a target of
/// which there are no `repeats` (m x targets) is left out.
std::vector<PointError> point_errors(const Campaign& campaign, const Estimate& estimate,
                                     const RowMatrixXd& configurations, const RowMatrixXd& repeats,
                                     bool is_angle) {
    const Campaign found = with_model_error(campaign, estimate);
    Campaign without = campaign;
    without.model_error = without.model_error_orientation = 0;
    const Sensor& sensor = *campaign.sensor;
    // Without priors the noise is that stated times the variance factor, as in the covariance.
    const double factor = campaign.spread.is_prior ? 1 : estimate.variance_of(is_angle).factor;
    FlangeMotion motion;
    RowMatrixXd J(sensor.row_count(), parameter_count(campaign));
    std::vector<PointError> points;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        const VectorXd times = repeats.row(i).transpose();
        differentiate_pose(campaign, estimate.parameters, q, motion, J);
        const VectorXd& unknowns = estimate.parameters.sensor;
        const MatrixXd noise = factor * detail::mean_covariance(without, motion, unknowns, times);
        const MatrixXd all = factor * detail::mean_covariance(found, motion, unknowns, times);
        const std::vector<Index> rows = seen_rows(sensor, times.array() > 0);
        const RowMatrixXd seen = J(rows, Eigen::all);
        const RowMatrixXd spread = seen * estimate.covariance;
        for (const auto& [row, count] : parts_of_kind(sensor, rows, is_angle)) {
            const MatrixXd parameters =
                spread.middleRows(row, count) * seen.middleRows(row, count).transpose();
            const MatrixXd of_noise = noise.block(row, row, count, count);
            const MatrixXd left_over = all.block(row, row, count, count) - of_noise;
            // What is fitted away altogether may be below 0 by rounding.
            PointError point{std::max(parameters.trace(), 0.0), left_over.trace(), of_noise.trace(),
                             1};
            const double squares = (parameters + left_over + of_noise).squaredNorm();
            if (squares > 0) point.degrees_of_freedom = point.total() * point.total() / squares;
            points.push_back(point);
        }
    }
    return points;
}

ExpectedError average(std::span<const PointError> points) {
    if (points.empty()) return {};
    ExpectedError sum;
    for (const PointError& point : points) {
        sum.parameters += point.parameters;
        sum.model += point.model;
        sum.noise += point.noise;
    }
    const auto count = static_cast<double>(points.size());
    return {std::sqrt(sum.parameters / count), std::sqrt(sum.model / count),
            std::sqrt(sum.noise / count)};
}

/// A log-normal factor on a variance, 1 on average, at equally probable places. One standard
/// deviation of the root is the factor `within`.
std::vector<double> variance_factors(double within) {
    constexpr int count = 12;
    std::vector<double> factors;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double z = detail::normal_quantile((i + 0.5) / count);
        sum += factors.emplace_back(std::pow(within, 2 * z));
    }
    for (double& factor : factors) factor *= count / sum;
    return factors;
}

/// What is not known about the variances that errors are stated by. With priors the model error is
/// found, within Estimate::model_error_within, and sizes are learned, so few poses know both badly.
/// Both are taken to err alike. Without priors one variance factor is found.
struct VarianceKnowledge {
    std::vector<double> by_model{1};
    std::vector<double> by_sizes{1};  ///< as many
    double degrees_of_freedom = 0;    ///< of the variance factor; 0: none is found
};

VarianceKnowledge variance_knowledge(const Campaign& campaign, const Estimate& estimate,
                                     bool is_angle) {
    // 93 to 97 % of simulated points of robots of each class are within their 95 % then.
    constexpr double size_within = 1.4;
    if (!campaign.spread.is_prior) {
        return {{1}, {1}, estimate.variance_of(is_angle).degrees_of_freedom};
    }
    return {variance_factors(estimate.model_error_within),
            variance_factors(estimate.spread ? size_within : 1)};
}

PredictedError summarise(std::span<const PointError> points, const VarianceKnowledge& known) {
    std::vector<detail::ScaledChiSquared> squares;
    for (const PointError& point : points) {
        for (std::size_t i = 0; i < known.by_model.size(); ++i) {
            squares.push_back({point.noise + known.by_sizes[i] * point.parameters +
                                   known.by_model[i] * point.model,
                               point.degrees_of_freedom});
        }
    }
    return {average(points),
            std::sqrt(detail::mixture_quantile(0.95, squares, known.degrees_of_freedom))};
}

}  // namespace

bool ExpectedError::is_by_few_poses() const {
    return std::sqrt(2) * parameters > std::hypot(model, noise);
}

double ExpectedError::total() const {
    return std::sqrt(parameters * parameters + model * model + noise * noise);
}

Campaign with_model_error(const Campaign& campaign, const Estimate& estimate) {
    Campaign found = campaign;
    found.model_error = estimate.model_error;
    found.model_error_orientation = estimate.model_error_orientation;
    if (estimate.spread) found.spread = *estimate.spread;
    return found;
}

ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured) {
    // Angles count only where no length is measured, as in distances.
    return expected_error(campaign, estimate, measured, !campaign.sensor->has_lengths());
}

ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured, bool is_angle) {
    return average(
        point_errors(campaign, estimate, measured.configurations, times_seen(measured), is_angle));
}

ExpectedError expected_place_error(const Campaign& campaign, const Estimate& estimate,
                                   const RowMatrixXd& configurations) {
    const Campaign found = with_model_error(campaign, estimate);
    const double factor = campaign.spread.is_prior ? 1 : estimate.variance_of(true).factor;
    const Targets& targets = campaign.sensor->targets();
    const VectorXd& unknowns = estimate.parameters.sensor;
    const TwistMatrix along = TwistMatrix::Identity(6, 6);
    FlangeMotion motion;
    RowMatrixXd J(3 * targets.count(), parameter_count(campaign));
    RowMatrixXd P(3 * targets.count(), along.cols());
    PointError sum;
    for (Index i = 0; i < configurations.rows(); ++i) {
        differentiate_flange(campaign, estimate.parameters, configurations.row(i).transpose(),
                             motion);
        targets.differentiate(motion.world_from_flange, motion.twists, unknowns, J);
        targets.differentiate(motion.world_from_flange, along, unknowns, P);
        sum.parameters += (J * estimate.covariance).cwiseProduct(J).sum();
        sum.model +=
            factor * (P * detail::flange_covariance(found, motion, unknowns)).cwiseProduct(P).sum();
    }
    const auto count = static_cast<double>(configurations.rows() * targets.count());
    return {std::sqrt(sum.parameters / count), std::sqrt(sum.model / count), 0};
}

RobotError expected_robot_error(const Campaign& campaign, const Estimate& estimate,
                                const RowMatrixXd& configurations) {
    const Targets& targets = campaign.sensor->targets();
    const VectorXd& unknowns = estimate.parameters.sensor;
    const Index rows = 3 * targets.count();
    const Index of_base = base_parameter_count(campaign);
    const Index of_robot = campaign.robot.parameter_count();
    RowMatrixXd J(rows, parameter_count(campaign));
    RowMatrixXd all(rows * configurations.rows(), of_robot);
    RowMatrixXd refitted = RowMatrixXd::Zero(all.rows(), 6 + rows);
    FlangeMotion motion;
    for (Index i = 0; i < configurations.rows(); ++i) {
        differentiate_flange(campaign, estimate.parameters, configurations.row(i).transpose(),
                             motion);
        targets.differentiate(motion.world_from_flange, motion.twists, unknowns, J);
        all.middleRows(rows * i, rows) = J.middleCols(of_base, of_robot);
        auto of_pose = refitted.middleRows(rows * i, rows);
        targets.differentiate(motion.world_from_flange, TwistMatrix::Identity(6, 6), unknowns,
                              of_pose.leftCols<6>());
        for (Index k = 0; k < targets.count(); ++k) {
            of_pose.block<3, 3>(3 * k, 6 + 3 * k) = motion.world_from_flange.linear();
        }
    }
    const MatrixXd Q = detail::orthogonal_factors(refitted).Q;
    all -= Q * (Q.transpose() * all);
    const auto count = static_cast<double>(configurations.rows() * targets.count());
    const double model =
        expected_place_error(campaign, estimate, configurations).model;  // hardly refitted
    const double parameters =
        (all * estimate.covariance.block(of_base, of_base, of_robot, of_robot))
            .cwiseProduct(all)
            .sum() /
        count;
    const double found = (all * estimate.parameters.robot).squaredNorm() / count;
    const double unknown = parameters + model * model;
    return {std::sqrt(found + unknown), std::sqrt(unknown)};
}

ExpectedError expected_sample_error(const Campaign& campaign, const Estimate& estimate,
                                    const Measurements& measured) {
    RowMatrixXd configurations(measured.observations.rows(), measured.configurations.cols());
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const Index first = measured.first_sample[static_cast<std::size_t>(i)];
        configurations.middleRows(first, measured.sample_count(i)).rowwise() =
            measured.configurations.row(i);
    }
    return average(point_errors(campaign, estimate, configurations, measured.is_seen.cast<double>(),
                                !campaign.sensor->has_lengths()));
}

std::vector<ErrorPrediction> predict_errors(const Campaign& campaign, const Estimate& estimate,
                                            const RowMatrixXd& configurations,
                                            const StopSignal& stop) {
    constexpr Index at_once = 64;
    const Sensor& sensor = *campaign.sensor;
    for (Index i = 0; i < configurations.rows(); ++i) {
        campaign.robot.check_configuration(configurations.row(i).transpose());
    }
    const RowMatrixXd once = RowMatrixXd::Ones(configurations.rows(), sensor.target_count());
    std::vector<ErrorPrediction> predictions;
    for (const bool is_angle : {false, true}) {
        if (!(is_angle ? sensor.has_angles() : sensor.has_lengths())) continue;
        const auto points = point_errors(campaign, estimate, configurations, once, is_angle);
        const VarianceKnowledge known = variance_knowledge(campaign, estimate, is_angle);
        ErrorPrediction& prediction = predictions.emplace_back();
        prediction.is_angle = is_angle;
        prediction.units = &sensor.units(is_angle);
        prediction.each.resize(static_cast<std::size_t>(configurations.rows()));
        const std::size_t width = points.size() / std::max<std::size_t>(1, prediction.each.size());
        detail::for_each_range(configurations.rows(), at_once, [&](Index first, Index last) {
            stop.check("predicting errors");
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last);
                 ++i) {
                prediction.each[i] = summarise(std::span(points).subspan(i * width, width), known);
            }
        });
        prediction.overall = summarise(points, known);
    }
    return predictions;
}

}  // namespace posewise
