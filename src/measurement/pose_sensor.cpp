#include <fmt/format.h>

#include <cmath>

#include "core/format.hpp"
#include "noise_words.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "rigid_points.hpp"

namespace posewise {

namespace {

std::vector<std::optional<Vector3d>> origin_of(const std::optional<Isometry3d>& tool) {
    if (!tool) return {std::nullopt};
    return {Vector3d(tool->translation())};
}

VectorXd points_observed(const VectorXd& pose, const SeenTargets&) {
    Isometry3d body = Isometry3d::Identity();
    body.translation() = pose.head<3>();
    body.linear() = rotation_from_vector(pose.tail<3>());
    return detail::points_of(body).reshaped();
}

}  // namespace

PoseSensor::PoseSensor(std::optional<Isometry3d> known_tool, PointNoise position_noise,
                       double sigma_orientation, PoseRecord record)
    : known_tool_(std::move(known_tool)),
      origin_(origin_of(known_tool_)),
      noise_(std::move(position_noise)),
      sigma_orientation_(sigma_orientation),
      record_(record) {
    check_noise(noise_);
    if (record.is_made_at_body && std::holds_alternative<LaserTrackerNoise>(noise_)) {
        throw InputError(
            "the noise of a laser tracker arises at the tracker, not at the body on the flange");
    }
    detail::check_sigma("sigma of the orientation", sigma_orientation, "rad");
    if (known_tool_ && !known_tool_->matrix().allFinite()) {
        throw InputError("the known tool has a value that is not a finite number");
    }
}

Isometry3d PoseSensor::tool(const VectorXd& unknowns) const {
    if (known_tool_) return *known_tool_;
    Isometry3d tool = Isometry3d::Identity();
    tool.translation() = unknowns.head<3>();
    tool.linear() = rotation_from_vector(unknowns.segment<3>(3));
    return tool;
}

std::vector<std::string> PoseSensor::observation_names() const {
    return {"x", "y", "z", "rx", "ry", "rz"};
}

std::vector<std::string> PoseSensor::unknown_names() const {
    if (known_tool_) return {};
    return {"tool.x", "tool.y", "tool.z", "tool.rx", "tool.ry", "tool.rz"};
}

std::vector<bool> PoseSensor::unknown_is_angle() const {
    if (known_tool_) return {};
    return {false, false, false, true, true, true};
}

void PoseSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                         Eigen::Ref<VectorXd> observation) const {
    const Isometry3d body = world_from_flange * tool(unknowns);
    observation << body.translation(), vector_from_rotation(body.linear());
}

void PoseSensor::deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                           Eigen::Ref<VectorXd> deviation) const {
    deviation = observation - reference;
    deviation.tail<3>() =
        vector_from_rotation(rotation_from_vector(observation.tail<3>()) *
                             rotation_from_vector(reference.tail<3>()).transpose());
}

void PoseSensor::deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                         Eigen::Ref<VectorXd> observation) const {
    observation = reference + deviation;
    observation.tail<3>() = vector_from_rotation(rotation_from_vector(deviation.tail<3>()) *
                                                 rotation_from_vector(reference.tail<3>()));
}

void PoseSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                               const VectorXd& unknowns,
                               Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto& J = J_measured_parameters;
    origin_.differentiate(world_from_flange, twists, unknowns, J.topRows(3));
    J.bottomLeftCorner(3, twists.cols()) = twists.topRows<3>();
    auto J_tool = J.bottomRightCorner(3, J.cols() - twists.cols());
    if (J_tool.cols() == 0) return;
    J_tool.leftCols<3>().setZero();
    J_tool.rightCols<3>() =
        world_from_flange.linear() * rotation_vector_rate(unknowns.segment<3>(3));
}

void PoseSensor::differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                     const Twist& direction, const TwistMatrix& twist_rates,
                                     const VectorXd& unknowns,
                                     Eigen::Ref<RowMatrixXd> J_rate) const {
    origin_.differentiate_along(world_from_flange, twists, direction, twist_rates, unknowns,
                                J_rate.topRows(3));
    J_rate.bottomLeftCorner(3, twists.cols()) = twist_rates.topRows<3>();
    auto J_tool = J_rate.bottomRightCorner(3, J_rate.cols() - twists.cols());
    if (J_tool.cols() == 0) return;
    J_tool.leftCols<3>().setZero();
    J_tool.rightCols<3>() = cross_matrix(direction.head<3>()) * world_from_flange.linear() *
                            rotation_vector_rate(unknowns.segment<3>(3));
}

void PoseSensor::covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                            Eigen::Ref<MatrixXd> covariance) const {
    const double variance = sigma_orientation_ * sigma_orientation_;
    const Vector3d position = world_from_flange * target_position(0, unknowns);
    covariance.setZero();
    covariance.topLeftCorner<3, 3>() = point_covariance(noise_, position);
    covariance.diagonal().tail<3>().setConstant(variance);
    if (!record_.is_made_at_body) return;
    // The body sees the world at R^T (x - p), with errors d of the position and t of the rotation
    // vector along its axes: those of the observation are -R d + p x R t and -R t.
    const Matrix3d R = world_from_flange.linear() * tool(unknowns).linear();
    const Matrix3d across = cross_matrix(position);
    const Matrix3d own = covariance.topLeftCorner<3, 3>();
    covariance.topLeftCorner<3, 3>() =
        R * own * R.transpose() + variance * across * across.transpose();
    covariance.topRightCorner<3, 3>() = -variance * across;
    covariance.bottomLeftCorner<3, 3>() = covariance.topRightCorner<3, 3>().transpose();
}

MatrixXd PoseSensor::covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                     const VectorXd& unknowns) const {
    if (record_.is_made_at_body) {
        return Sensor::covariance_rate(world_from_flange, direction, unknowns);
    }
    const Vector3d x = world_from_flange * target_position(0, unknowns);
    MatrixXd rate = MatrixXd::Zero(6, 6);
    rate.topLeftCorner<3, 3>() = point_covariance_rate(noise_, x, velocity_of(x, direction));
    return rate;
}

bool PoseSensor::has_constant_covariance() const {
    return !record_.is_made_at_body && !std::holds_alternative<LaserTrackerNoise>(noise_);
}

std::vector<NoiseNumber> PoseSensor::noise_numbers() const {
    std::vector<NoiseNumber> numbers = detail::noise_numbers(noise_);
    numbers.push_back({"sigma_orientation_rad", {sigma_orientation_}});
    return numbers;
}

SensorWords PoseSensor::words() const {
    return {"poses",
            "tool",
            "tool in the flange frame",
            "sensor.tool",
            {"base.known", "sensor.tool.known"},
            fmt::format("poses of a tool ({}), {} and {} mrad in orientation{}",
                        known_tool_ ? "known" : "to be identified", detail::describe(noise_),
                        detail::format_short(mrad_per_rad * sigma_orientation_),
                        record_.is_made_at_body ? ", seen from the tool, a camera" : "")};
}

std::optional<ObservedPoints> PoseSensor::observed_points() const {
    const auto unknowns = [is_known = known_tool_.has_value()](const VectorXd& coordinates) {
        return is_known ? coordinates : tool_unknowns(detail::frame_of(coordinates));
    };
    return ObservedPoints{detail::rigid_targets(known_tool_), points_observed, unknowns, {}};
}

void invert_poses(RowMatrixXd& poses) {
    for (Index k = 0; k < poses.rows(); ++k) {
        const Matrix3d R = rotation_from_vector(poses.row(k).tail<3>().transpose());
        poses.row(k).head<3>() = -poses.row(k).head<3>() * R;
        poses.row(k).tail<3>() *= -1;
    }
}

bool records_inverse(const Sensor& sensor) {
    const auto* const poses = dynamic_cast<const PoseSensor*>(&sensor);
    return poses != nullptr && poses->record().is_inverse;
}

VectorXd tool_unknowns(const Isometry3d& flange_from_tool) {
    VectorXd unknowns(6);
    unknowns << flange_from_tool.translation(), vector_from_rotation(flange_from_tool.linear());
    return unknowns;
}

}  // namespace posewise
