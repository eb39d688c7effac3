#include "posewise/measurement/sensor.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/format.hpp"
#include "differences.hpp"
#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

constexpr double pose_step = 2e-3;  // m or rad of a joint

/// Of the numbers of an observation, with flange and world in one and all unknowns 0.
VectorXd standard_deviations(const Sensor& sensor) {
    const VectorXd unknowns = VectorXd::Zero(static_cast<Index>(sensor.unknown_names().size()));
    return sensor.covariance(Isometry3d::Identity(), unknowns).diagonal().cwiseSqrt();
}

/// "sigma 0.05 mm and 0.02 mrad": root mean squares over all lengths and over all angles.
std::string describe_sigmas(const Sensor& sensor) {
    const VectorXd sigmas = standard_deviations(sensor);
    std::string text;
    for (const bool of_angles : {false, true}) {
        double squares = 0;
        double count = 0;
        for (Index row = 0; row < sigmas.size(); ++row) {
            if (sensor.is_angle(row) != of_angles) continue;
            squares += sigmas[row] * sigmas[row];
            ++count;
        }
        if (count == 0) continue;
        text += fmt::format("{} {} {}", text.empty() ? "sigma" : " and",
                            detail::format_short(mm_per_m * std::sqrt(squares / count)),
                            sensor.units(of_angles).error);
    }
    return text;
}

}  // namespace

Isometry3d detail::moved(const Isometry3d& flange, const Twist& twist) {
    Isometry3d motion(rotation_from_vector(twist.head<3>()));
    motion.translation() = twist.tail<3>();
    return motion * flange;
}

std::vector<bool> Sensor::unknown_is_angle() const {
    return std::vector<bool>(unknown_names().size(), false);
}

std::vector<const AmountUnits*> Sensor::unknown_units() const {
    std::vector<const AmountUnits*> units;
    for (const bool is_angle : unknown_is_angle()) units.push_back(&units_of(is_angle));
    return units;
}

VectorXd Sensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const {
    VectorXd observation(row_count());
    predict(world_from_flange, unknowns, observation);
    return observation;
}

MatrixXd Sensor::covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns) const {
    MatrixXd of_noise(row_count(), row_count());
    covariance(world_from_flange, unknowns, of_noise);
    return of_noise;
}

VectorXd Sensor::deviation(const ConstNumbers& observation, const ConstNumbers& reference) const {
    VectorXd step(observation.size());
    deviation(observation, reference, step);
    return step;
}

VectorXd Sensor::deviate(const ConstNumbers& reference, const ConstNumbers& deviation) const {
    VectorXd observation(reference.size());
    deviate(reference, deviation, observation);
    return observation;
}

Index Sensor::count_angles() const {
    Index count = 0;
    for (Index row = 0; row < row_count(); ++row) count += is_angle(row) ? 1 : 0;
    return count;
}

void Sensor::differentiate_positions(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                     const VectorXd& unknowns,
                                     Eigen::Ref<RowMatrixXd> J_positions_parameters) const {
    if (J_positions_parameters.rows() == 3 * targets().count()) {
        targets().differentiate(world_from_flange, twists, unknowns, J_positions_parameters);
        return;
    }
    RowMatrixXd J(3 * targets().count(), J_positions_parameters.cols());
    targets().differentiate(world_from_flange, twists, unknowns, J);
    for (Index target = 0; target < target_count(); ++target) {
        J_positions_parameters.middleRows<3>(3 * target) = J.middleRows<3>(3 * point_of(target));
    }
}

void Sensor::differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const Twist& direction, const TwistMatrix& twist_rates,
                                 const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J_rate) const {
    J_rate = detail::slope_at_zero(pose_step, [&](double step) -> MatrixXd {
        RowMatrixXd J(J_rate.rows(), J_rate.cols());
        differentiate(detail::moved(world_from_flange, step * direction),
                      twists + step * twist_rates, unknowns, J);
        return J;
    });
}

MatrixXd Sensor::covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                 const VectorXd& unknowns) const {
    if (has_constant_covariance()) return MatrixXd::Zero(row_count(), row_count());
    return detail::slope_at_zero(pose_step, [&](double step) -> MatrixXd {
        return covariance(detail::moved(world_from_flange, step * direction), unknowns);
    });
}

bool Sensor::observes_targets() const {
    const std::optional<ObservedPoints> observed = observed_points();
    return observed && !has_pixels() && observed->points.count() == target_count() &&
           static_cast<Index>(unknown_names().size()) == targets().unknown_count();
}

std::vector<NoiseNumber> Sensor::noise_numbers() const {
    const VectorXd sigmas = standard_deviations(*this);
    std::vector<NoiseNumber> numbers;
    Index row = 0;
    for (const std::string& name : observation_names()) {
        const std::string unit(units(is_angle(row)).si);
        numbers.push_back({"sigma_" + name + '_' + unit, {sigmas[row]}});
        ++row;
    }
    return numbers;
}

SensorWords Sensor::words() const {
    SensorWords words;
    words.readings = "readings";
    const auto own = static_cast<Index>(unknown_names().size()) - targets().unknown_count();
    if (own > 0) words.unknowns += ", what else of the sensor is unknown";
    words.sentence = fmt::format("{} numbers a pose at {}, {}", row_count(), describe(targets()),
                                 describe_sigmas(*this));
    return words;
}

}  // namespace posewise
