#include <algorithm>
#include <cmath>

#include "measurement/noise.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/scene.hpp"
#include "task/doubt/nominal_residuals.hpp"

namespace posewise {
namespace {

/// Variances that the residuals of single readings have at a configuration: that of the reading
/// less what the parameters take up of it, J C J^T, which the reading took part in.
VectorXd residual_variances(const Campaign& campaign, const Estimate& estimate, const VectorXd& q,
                            FlangeMotion& motion) {
    constexpr double least = 0.01;  // of the reading's; less is left of none
    const Sensor& sensor = *campaign.sensor;
    RowMatrixXd J(sensor.row_count(), parameter_count(campaign));
    differentiate_pose(campaign, estimate.parameters, q, motion, J);
    VectorXd variances =
        detail::mean_covariance(campaign, motion, estimate.parameters.sensor, 1.0).diagonal();
    if (!campaign.spread.is_prior) {
        for (Index row = 0; row < variances.size(); ++row) {
            variances[row] *= estimate.variance_of(sensor.is_angle(row)).factor;
        }
    }
    const VectorXd taken_up = (J * estimate.covariance).cwiseProduct(J).rowwise().sum();
    return (variances - taken_up).cwiseMax(least * variances);
}

Direction direction_of(const Vector3d& point) {
    return {point.norm(), std::atan2(point.y(), point.x()),
            std::atan2(point.z(), std::hypot(point.x(), point.y()))};
}

/// A target's numbers, of a row of residuals().
VectorXd own_numbers(const Sensor& sensor, Index target,
                     const Eigen::Ref<const RowMatrixXd>& residual) {
    VectorXd numbers(sensor.rows_of(target));
    for (Index k = 0; k < numbers.size(); ++k) {
        numbers[k] = residual(0, sensor.column_of(sensor.first_row(target) + k));
    }
    return numbers;
}

/// Whether the instrument that observes a target is where the world is: not a further one.
bool is_seen_from_world(const Sensor& sensor, Index target) {
    const auto* const combined = dynamic_cast<const CombinedSensor*>(&sensor);
    return combined == nullptr || combined->part_of(target) == 0;
}

/// What is known of all readings: rows as residuals() has them.
struct Rows {
    RowMatrixXd nominal;
    RowMatrixXd held_out;  ///< empty: none
};

std::vector<ReadingResidual> list(const Campaign& campaign, const Estimate& estimate,
                                  const Measurements& measurements, const Rows& rows) {
    const Sensor& sensor = *campaign.sensor;
    const std::optional<Vector3d> instrument = instrument_position(campaign);
    std::vector<ReadingResidual> listed =
        list_residuals(campaign, estimate.parameters, measurements);
    FlangeMotion motion;
    VectorXd deviations;
    Index configuration = -1;
    Index row = 0;
    for (ReadingResidual& one : listed) {
        if (one.configuration != configuration) {
            configuration = one.configuration;
            const VectorXd q = measurements.configurations.row(configuration).transpose();
            deviations = residual_variances(campaign, estimate, q, motion).cwiseSqrt();
        }
        one.nominal = own_numbers(sensor, one.target, rows.nominal.row(row));
        if (rows.held_out.rows() > 0) {
            const VectorXd held_out = own_numbers(sensor, one.target, rows.held_out.row(row));
            if (held_out.allFinite()) one.held_out = held_out;
        }
        one.standardised = one.calibrated.cwiseQuotient(
            deviations.segment(sensor.first_row(one.target), sensor.rows_of(one.target)));
        if (instrument && is_seen_from_world(sensor, one.target)) {
            one.direction =
                direction_of(motion.world_from_flange *
                                 sensor.target_position(one.target, estimate.parameters.sensor) -
                             *instrument);
        }
        ++row;
    }
    return listed;
}

/// Of the first target that has a number of the kind, each.
std::vector<std::string> axes_of_several(const Sensor& sensor) {
    const std::vector<std::string> names = sensor.observation_names();
    std::vector<std::string> axes(static_cast<std::size_t>(sensor.rows_per_target()));
    for (Index row = 0; row < sensor.row_count(); ++row) {
        std::string& axis = axes[static_cast<std::size_t>(sensor.column_of(row))];
        const std::string& name = names[static_cast<std::size_t>(row)];
        const bool is_single = sensor.rows_of(sensor.target_of(row)) == 1;
        const bool is_known = !axis.empty() && axis != "distance";
        if (!is_known) axis = is_single ? "distance" : name.substr(name.rfind('_') + 1);
    }
    return axes;
}

}  // namespace

std::vector<ReadingResidual> list_residuals(const Campaign& campaign, const Parameters& parameters,
                                            const Measurements& measurements) {
    const RowMatrixXd all = residuals(campaign, parameters, measurements);
    std::vector<ReadingResidual> listed;
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const Index first = measurements.first_sample[static_cast<std::size_t>(i)];
        for (Index sample = first; sample < first + measurements.sample_count(i); ++sample) {
            for (Index target = 0; target < measurements.is_seen.cols(); ++target) {
                if (!measurements.is_seen(sample, target)) continue;
                const Index row = std::ssize(listed);
                ReadingResidual& one = listed.emplace_back();
                one.configuration = i;
                one.sample = sample;
                one.target = target;
                one.calibrated = own_numbers(*campaign.sensor, target, all.row(row));
            }
        }
    }
    return listed;
}

std::vector<ReadingResidual> list_residuals(const Calibration& calibration,
                                            const Measurements& measurements) {
    Rows rows{calibration.nominal_residuals, {}};
    if (calibration.held_out) rows.held_out = calibration.held_out->residuals;
    return list(calibration.campaign, calibration.estimate, measurements, rows);
}

std::vector<ReadingResidual> list_residuals(const Campaign& campaign, const Estimate& estimate,
                                            const Measurements& measurements,
                                            const ResidualOptions& options) {
    LevenbergMarquardtOptions fitting;
    fitting.loss = options.loss;
    fitting.finds_model_error = false;
    Rows rows;
    rows.nominal = detail::nominal_residuals(
        campaign, campaign.robot, measurements,
        determined(register_base_and_targets(campaign, measurements)), fitting);
    if (options.folds > 0) {
        rows.held_out =
            cross_validate(campaign, measurements, estimate.parameters, options.folds, fitting)
                .residuals;
    }
    return list(campaign, estimate, measurements, rows);
}

std::vector<std::string> residual_axes(const Campaign& campaign) {
    const Index width = campaign.sensor->rows_per_target();
    if (campaign.sensor->is_combined()) return axes_of_several(*campaign.sensor);
    if (width == 1) return {"distance"};
    std::vector<std::string> names = campaign.sensor->observation_names();
    names.resize(static_cast<std::size_t>(width));
    for (std::string& name : names) name = name.substr(name.rfind('_') + 1);
    return names;
}

namespace detail {

NominalRobot fit_nominal_robot(const Campaign& campaign, const Chain& robot,
                               const Measurements& measurements, Parameters registered,
                               const LevenbergMarquardtOptions& options) {
    registered.robot.resize(0);
    Campaign nominal = with_robot(campaign, without_parameters(robot));
    Estimate fitted = identify(nominal, measurements, registered, options);
    return {std::move(nominal), std::move(registered), std::move(fitted)};
}

RowMatrixXd nominal_residuals(const Campaign& campaign, const Chain& robot,
                              const Measurements& measurements, Parameters registered,
                              const LevenbergMarquardtOptions& options) {
    const NominalRobot nominal =
        fit_nominal_robot(campaign, robot, measurements, std::move(registered), options);
    return residuals(nominal.campaign, nominal.parameters(), measurements);
}

}  // namespace detail
}  // namespace posewise
