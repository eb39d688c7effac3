#include <cmath>
#include <vector>

#include "posewise/core/types.hpp"
#include "residual_patterns.hpp"

namespace posewise::detail {
namespace {

bool are_multiples(const VectorXd& values, double step) {
    constexpr double tolerance = 0.01;  // of a step
    const VectorXd steps = values / step;
    return (steps.array() - steps.array().round()).abs().maxCoeff() < tolerance;
}

/// Either may be so many times the other where rounding explains what is left over.
constexpr double alike = 2;

/// The largest of 1, 0.1 and 0.01 deg that all values of joints that turn and move are multiples
/// of; 0: none.
double common_step(const Chain& robot, const RowMatrixXd& q) {
    for (const double degrees : {1.0, 0.1, 0.01}) {
        const double step = to_radians(degrees);
        bool is_common = false;
        for (Index j = 0; j < robot.joint_count(); ++j) {
            if (robot.joint(j).motion != Motion::Rotation) continue;
            const bool is_multiple = are_multiples(q.col(j), step);
            is_common = is_multiple;
            if (!is_multiple) break;
        }
        if (is_common) return step;
    }
    return 0;
}

/// What errors of the joints of this size (rad) do to the distances, RMS over what was seen.
double effect_of(const Campaign& campaign, const Measurements& measured,
                 const Parameters& parameters, double deviation) {
    const Sensor& sensor = *campaign.sensor;
    FlangeMotion motion;
    RowMatrixXd J;
    double squares = 0;
    double readings = 0;
    const RowMatrixXd seen = times_seen(measured);
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const VectorXd q = measured.configurations.row(i).transpose();
        campaign.robot.differentiate(parameters.world_from_base, q, parameters.robot, motion);
        J.resize(sensor.row_count(), campaign.robot.joint_count());
        sensor.differentiate(motion.world_from_flange, motion.joint_twists, parameters.sensor, J);
        for (Index row = 0; row < J.rows(); ++row) {
            const Index target = sensor.target_of(row);
            if (seen(i, target) == 0) continue;
            if (sensor.has_lengths() && sensor.is_angle(row)) continue;
            if (row == sensor.first_row(target)) readings += 1;
            for (Index j = 0; j < J.cols(); ++j) {
                const bool turns = campaign.robot.joint(j).motion == Motion::Rotation;
                if (turns) squares += J(row, j) * J(row, j);
            }
        }
    }
    return deviation * std::sqrt(squares / readings);
}

}  // namespace

std::optional<RoundedJoints> find_rounded_joints(const Fitted& fitted) {
    const Campaign& campaign = fitted.campaign;
    const double step = common_step(campaign.robot, fitted.measured.configurations);
    if (step == 0) return std::nullopt;
    const double deviation = step / std::sqrt(12.0);
    const VectorXd& stated_already = campaign.joint_repeatability;
    if (stated_already.size() > 0 && stated_already.maxCoeff() >= 0.9 * deviation) {
        return std::nullopt;
    }
    RoundedJoints rounded{
        step, effect_of(campaign, fitted.measured, fitted.estimate.parameters, deviation), {}};
    rounded.held_out.before = held_out_rms(fitted);
    const double left = fitted.estimate.fit.rms();
    if (rounded.effect * alike < left || rounded.effect > alike * rounded.held_out.before) {
        return std::nullopt;
    }
    Campaign stated = campaign;
    if (stated.joint_repeatability.size() == 0) {
        stated.joint_repeatability = VectorXd::Zero(campaign.robot.joint_count());
    }
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        if (campaign.robot.joint(j).motion != Motion::Rotation) continue;
        stated.joint_repeatability[j] = std::hypot(stated.joint_repeatability[j], deviation);
    }
    const auto cured = fit_again(stated, fitted.measured, fitted.estimate.loss);
    if (!cured) return std::nullopt;
    rounded.held_out.after = held_out_rms(*cured);
    if (!(rounded.held_out.after < rounded.held_out.before)) return std::nullopt;
    return rounded;
}

std::optional<RoundedReadings> find_rounded_readings(const Fitted& fitted) {
    const Sensor& sensor = *fitted.campaign.sensor;
    if (!tells_lengths(sensor)) return std::nullopt;
    std::vector<double> lengths;
    const Measurements& measured = fitted.measured;
    for (Index sample = 0; sample < measured.observations.rows(); ++sample) {
        for (Index row = 0; row < measured.observations.cols(); ++row) {
            if (sensor.is_angle(row)) continue;
            if (!measured.is_seen(sample, sensor.target_of(row))) continue;
            lengths.push_back(measured.observations(sample, row));
        }
    }
    const auto all = Eigen::Map<const VectorXd>(lengths.data(), std::ssize(lengths));
    for (const double step : {1e-2, 1e-3, 1e-4}) {
        if (!are_multiples(all, step)) continue;
        const double deviation = step / std::sqrt(12.0);
        const auto numbers = static_cast<double>(sensor.lengths_per_target());
        RoundedReadings rounded{step, std::sqrt(numbers) * deviation,
                                fitted.estimate.fit.distance_rms};
        // Nor were they rounded, by a step that leaves more than there is.
        const bool explains = rounded.effect * alike >= rounded.left;
        if (!explains || rounded.effect > alike * rounded.left) return std::nullopt;
        return rounded;
    }
    return std::nullopt;
}

}  // namespace posewise::detail
