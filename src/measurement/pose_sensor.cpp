#include "posewise/measurement/pose_sensor.hpp"

#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/model/transforms.hpp"

namespace posewise {

namespace {

std::vector<std::optional<Vector3d>> origin_of(const std::optional<Isometry3d>& tool) {
    if (!tool) return {std::nullopt};
    return {Vector3d(tool->translation())};
}

}  // namespace

PoseSensor::PoseSensor(std::optional<Isometry3d> known_tool, PointNoise position_noise,
                       double sigma_orientation)
    : known_tool_(std::move(known_tool)),
      origin_(origin_of(known_tool_)),
      noise_(position_noise),
      sigma_orientation_(sigma_orientation) {
    check_noise(noise_);
    if (!(sigma_orientation >= 1e-15) || !std::isfinite(sigma_orientation)) {
        throw InputError("sigma of the orientation is " + std::to_string(sigma_orientation) +
                         " rad, must be finite and at least 1e-15");
    }
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

VectorXd PoseSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const {
    const Isometry3d body = world_from_flange * tool(unknowns);
    VectorXd pose(6);
    pose << body.translation(), vector_from_rotation(body.linear());
    return pose;
}

VectorXd PoseSensor::deviation(const VectorXd& observation, const VectorXd& reference) const {
    VectorXd deviation = observation - reference;
    deviation.tail<3>() =
        vector_from_rotation(rotation_from_vector(observation.tail<3>()) *
                             rotation_from_vector(reference.tail<3>()).transpose());
    return deviation;
}

VectorXd PoseSensor::deviate(const VectorXd& reference, const VectorXd& deviation) const {
    VectorXd observation = reference + deviation;
    observation.tail<3>() = vector_from_rotation(rotation_from_vector(deviation.tail<3>()) *
                                                 rotation_from_vector(reference.tail<3>()));
    return observation;
}

void PoseSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                               const VectorXd& unknowns,
                               Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto& J = J_measured_parameters;
    differentiate_positions(world_from_flange, twists, unknowns, J.topRows(3));
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

Vector3d PoseSensor::target_position(Index target, const VectorXd& unknowns) const {
    return origin_.position(target, unknowns);
}

void PoseSensor::differentiate_positions(const Isometry3d& world_from_flange,
                                         const TwistMatrix& twists, const VectorXd& unknowns,
                                         Eigen::Ref<RowMatrixXd> J_positions_parameters) const {
    origin_.differentiate(world_from_flange, twists, unknowns, J_positions_parameters);
}

MatrixXd PoseSensor::covariance(const Isometry3d& world_from_flange,
                                const VectorXd& unknowns) const {
    MatrixXd covariance = MatrixXd::Zero(6, 6);
    covariance.topLeftCorner<3, 3>() =
        point_covariance(noise_, world_from_flange * target_position(0, unknowns));
    covariance.diagonal().tail<3>().setConstant(sigma_orientation_ * sigma_orientation_);
    return covariance;
}

MatrixXd PoseSensor::covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                     const VectorXd& unknowns) const {
    const Vector3d x = world_from_flange * target_position(0, unknowns);
    MatrixXd rate = MatrixXd::Zero(6, 6);
    rate.topLeftCorner<3, 3>() = point_covariance_rate(noise_, x, velocity_of(x, direction));
    return rate;
}

bool PoseSensor::has_constant_covariance() const {
    return !std::holds_alternative<LaserTrackerNoise>(noise_);
}

VectorXd tool_unknowns(const Isometry3d& flange_from_tool) {
    VectorXd unknowns(6);
    unknowns << flange_from_tool.translation(), vector_from_rotation(flange_from_tool.linear());
    return unknowns;
}

}  // namespace posewise
