#include <algorithm>
#include <utility>

#include "camera_view.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

using detail::BoardFromCamera;
using detail::Projection;

/// Derivatives of one corner's place in the image: by the flange's motion, by position and rotation
/// vector of what is on it, and by the board's size.
struct CornerDerivative {
    Eigen::Matrix<double, 2, 6> by_twist;
    Eigen::Matrix<double, 2, 6> by_place;
    Vector2d by_scale;
    detail::ByValues by_values;
};

/// [-x^, I], by which a point x moves with a twist.
Eigen::Matrix<double, 3, 6> velocity_by_twist(const Vector3d& x) {
    Eigen::Matrix<double, 3, 6> velocity;
    velocity << -cross_matrix(x), Matrix3d::Identity();
    return velocity;
}

/// With P the derivative by the point p = camera X: while the flange moves by a twist (w, v), a
/// board on it moves by v + w x p; a camera on it sees the board move by -R (v + w x X), with its
/// axes R.
CornerDerivative corner_derivative(const BoardFromCamera& pose, const Vector3d& X,
                                   const Vector3d& p, const Projection& projection) {
    const auto& P = projection.by_point;
    const Matrix3d& R = pose.camera.linear();
    CornerDerivative corner;
    corner.by_values = projection.by_values;
    corner.by_scale = P * R * X / pose.factor;
    Eigen::Matrix<double, 2, 3> by_place;
    Vector3d arm;
    if (pose.is_on_flange) {
        corner.by_twist = -P * R * velocity_by_twist(X);
        by_place = -P * pose.place.linear().transpose();
        arm = pose.place.linear() * p;
    } else {
        corner.by_twist = P * velocity_by_twist(p);
        by_place = P * pose.flange;
        arm = pose.place.linear() * X;
    }
    corner.by_place << by_place, -by_place * cross_matrix(arm) * pose.turn_rate;
    return corner;
}

CornerDerivative corner_derivative(const BoardFromCamera& pose, const Vector3d& X) {
    const Vector3d p = pose.camera * X;
    Projection projection;
    detail::differentiate_projection(pose.lens, p, projection);
    return corner_derivative(pose, X, p, projection);
}

/// corner_derivative() and its rate while the flange moves by `direction`.
std::pair<CornerDerivative, CornerDerivative> corner_rate(const BoardFromCamera& pose,
                                                          const Vector3d& X,
                                                          const Twist& direction) {
    const Vector3d p = pose.camera * X;
    const Matrix3d& R = pose.camera.linear();
    const Matrix3d W = cross_matrix(direction.head<3>());
    const Vector3d velocity =
        pose.is_on_flange ? Vector3d(-R * velocity_of(X, direction)) : velocity_of(p, direction);
    const Matrix3d R_rate = pose.is_on_flange ? Matrix3d(-R * W) : Matrix3d(W * R);
    Projection projection;
    detail::ProjectionRate rate;
    detail::differentiate_projection_along(pose.lens, p, velocity, projection, rate);
    const auto& P = projection.by_point;
    const auto& P_rate = rate.by_point;
    CornerDerivative corner;
    corner.by_values = rate.by_values;
    corner.by_scale = (P_rate * R + P * R_rate) * X / pose.factor;
    Eigen::Matrix<double, 2, 3> by_place_rate;
    Eigen::Matrix<double, 2, 3> by_arm_rate;
    if (pose.is_on_flange) {
        corner.by_twist = -(P_rate * R + P * R_rate) * velocity_by_twist(X);
        const Matrix3d to_place = -pose.place.linear().transpose();
        by_place_rate = P_rate * to_place;
        by_arm_rate = by_place_rate * cross_matrix(pose.place.linear() * p) +
                      P * to_place * cross_matrix(pose.place.linear() * velocity);
    } else {
        corner.by_twist = P_rate * velocity_by_twist(p);
        corner.by_twist.leftCols<3>() -= P * cross_matrix(velocity);
        by_place_rate = (P_rate + P * W) * pose.flange;
        by_arm_rate = by_place_rate * cross_matrix(pose.place.linear() * X);
    }
    corner.by_place << by_place_rate, -by_arm_rate * pose.turn_rate;
    return {corner_derivative(pose, X, p, projection), corner};
}

/// The columns of what is unknown: place, intrinsic parameters, size.
void set_unknowns(const CornerDerivative& corner, const std::vector<Index>& intrinsics,
                  Eigen::Ref<RowMatrixXd> rows) {
    const auto count = static_cast<Index>(intrinsics.size());
    const Index place = rows.cols() - count >= 6 ? 6 : 0;
    if (place > 0) rows.leftCols<6>() = corner.by_place;
    for (Index i = 0; i < count; ++i) {
        rows.col(place + i) = corner.by_values.col(intrinsics[static_cast<std::size_t>(i)]);
    }
    if (rows.cols() > place + count) rows.rightCols<1>() = corner.by_scale;
}

}  // namespace

BoardFromCamera detail::board_from_camera(const CameraSensor& sensor,
                                          const Isometry3d& world_from_flange,
                                          const VectorXd& unknowns) {
    const CameraSetup& setup = sensor.setup();
    Lens lens = lens_of(setup.intrinsics);
    const bool is_polynomial = lens.distortion == Distortion::BrownConrady;
    lens.widest = is_polynomial ? std::min(sensor.widest(), 3.0) : sensor.widest();
    Index next = setup.known_place ? 0 : 6;
    for (const Index k : sensor.unknown_intrinsics()) {
        lens.values[static_cast<std::size_t>(k)] = unknowns[next++];
    }
    return {
        setup.is_on_flange,
        sensor.place(unknowns),
        sensor.camera_from_board(world_from_flange, unknowns),
        world_from_flange.linear(),
        lens,
        sensor.board_factor(unknowns),
        setup.known_place ? Matrix3d::Zero().eval() : rotation_vector_rate(unknowns.segment<3>(3))};
}

void CameraSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto& J = J_measured_parameters;
    const BoardFromCamera pose = detail::board_from_camera(*this, world_from_flange, unknowns);
    const Index own = J.cols() - twists.cols();
    for (Index k = 0; k < target_count(); ++k) {
        const Vector3d X = pose.factor * setup_.corners[static_cast<std::size_t>(k)];
        const CornerDerivative corner = corner_derivative(pose, X);
        auto rows = J.middleRows<2>(2 * k);
        rows.leftCols(twists.cols()).noalias() = corner.by_twist.lazyProduct(twists);
        if (own > 0) set_unknowns(corner, unknown_intrinsics_, rows.rightCols(own));
    }
}

void CameraSensor::differentiate_along(const Isometry3d& world_from_flange,
                                       const TwistMatrix& twists, const Twist& direction,
                                       const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                       Eigen::Ref<RowMatrixXd> J_rate) const {
    const BoardFromCamera pose = detail::board_from_camera(*this, world_from_flange, unknowns);
    const Index own = J_rate.cols() - twists.cols();
    for (Index k = 0; k < target_count(); ++k) {
        const Vector3d X = pose.factor * setup_.corners[static_cast<std::size_t>(k)];
        const auto [corner, rate] = corner_rate(pose, X, direction);
        auto rows = J_rate.middleRows<2>(2 * k);
        rows.leftCols(twists.cols()).noalias() =
            rate.by_twist.lazyProduct(twists) + corner.by_twist.lazyProduct(twist_rates);
        if (own > 0) set_unknowns(rate, unknown_intrinsics_, rows.rightCols(own));
    }
}

}  // namespace posewise
