#include "noise_words.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise {

PointSensor::PointSensor(Targets targets, PointNoise noise)
    : targets_(std::move(targets)), noise_(std::move(noise)) {
    check_noise(noise_);
}

PointSensor::PointSensor(const std::vector<std::optional<Vector3d>>& known_targets,
                         PointNoise noise)
    : PointSensor(Targets(known_targets), std::move(noise)) {}

PointSensor::PointSensor(const std::vector<std::optional<Vector3d>>& known_targets, double sigma)
    : PointSensor(Targets(known_targets), IsotropicNoise{sigma}) {}

std::vector<std::string> PointSensor::observation_names() const {
    std::vector<std::string> names;
    for (Index j = 0; j < target_count(); ++j) {
        for (const char axis : {'x', 'y', 'z'}) {
            names.push_back("p" + std::to_string(j + 1) + "_" + axis);
        }
    }
    return names;
}

void PointSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                          Eigen::Ref<VectorXd> observation) const {
    for (Index j = 0; j < targets_.count(); ++j) {
        observation.segment<3>(3 * j) = world_from_flange * targets_.position(j, unknowns);
    }
}

void PointSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                const VectorXd& unknowns,
                                Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    targets_.differentiate(world_from_flange, twists, unknowns, J_measured_parameters);
}

void PointSensor::differentiate_along(const Isometry3d& world_from_flange,
                                      const TwistMatrix& twists, const Twist& direction,
                                      const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                      Eigen::Ref<RowMatrixXd> J_rate) const {
    targets_.differentiate_along(world_from_flange, twists, direction, twist_rates, unknowns,
                                 J_rate);
}

void PointSensor::covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                             Eigen::Ref<MatrixXd> covariance) const {
    covariance.setZero();
    for (Index j = 0; j < targets_.count(); ++j) {
        covariance.block<3, 3>(3 * j, 3 * j) =
            point_covariance(noise_, world_from_flange * targets_.position(j, unknowns));
    }
}

MatrixXd PointSensor::covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                      const VectorXd& unknowns) const {
    MatrixXd rate = MatrixXd::Zero(row_count(), row_count());
    for (Index j = 0; j < target_count(); ++j) {
        const Vector3d x = world_from_flange * targets_.position(j, unknowns);
        rate.block<3, 3>(3 * j, 3 * j) =
            point_covariance_rate(noise_, x, velocity_of(x, direction));
    }
    return rate;
}

bool PointSensor::has_constant_covariance() const {
    return !std::holds_alternative<LaserTrackerNoise>(noise_);
}

std::vector<NoiseNumber> PointSensor::noise_numbers() const {
    return detail::noise_numbers(noise_);
}

SensorWords PointSensor::words() const {
    SensorWords words;
    words.sentence = "points of " + describe(targets_) + ", " + detail::describe(noise_);
    return words;
}

std::optional<ObservedPoints> PointSensor::observed_points() const {
    const auto as_they_are = [](const VectorXd& values) { return values; };
    return ObservedPoints{targets_,
                          [](const VectorXd& values, const SeenTargets&) { return values; },
                          as_they_are,
                          {}};
}

}  // namespace posewise
