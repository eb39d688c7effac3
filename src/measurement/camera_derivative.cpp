#include <utility>

#include "camera_model.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace detail {

/// What a camera's pose is and how what it sees moves, the same for every corner.
struct CameraPose {
    bool is_on_flange;
    Isometry3d place;   ///< of what is on the flange, in its frame
    Isometry3d camera;  ///< camera_from_board
    Matrix3d flange;    ///< the flange's axes in the world
    Lens lens;
    double factor;       ///< of the board's size
    Matrix3d turn_rate;  ///< of the place, by its rotation vector
};

/// Derivatives of one corner's place in the image: by the flange's motion, by position and rotation
/// vector of what is on it, and by the board's size.
struct CornerDerivative {
    Eigen::Matrix<double, 2, 6> by_twist;
    Eigen::Matrix<double, 2, 6> by_place;
    Vector2d by_scale;
    ByValues by_values;
};

}  // namespace detail

namespace {

using detail::CameraPose;
using detail::CornerDerivative;
using detail::Projection;

/// [-x^, I], by which a point x moves with a twist.
Eigen::Matrix<double, 3, 6> velocity_by_twist(const Vector3d& x) {
    Eigen::Matrix<double, 3, 6> velocity;
    velocity << -cross_matrix(x), Matrix3d::Identity();
    return velocity;
}

/// With P the derivative by the point p = camera X: while the flange moves by a twist (w, v), a
/// board on it moves by v + w x p; a camera on it sees the board move by -R (v + w x X), with its
/// axes R.
CornerDerivative corner_derivative(const CameraPose& pose, const Vector3d& X, const Vector3d& p,
                                   const Projection& projection) {
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

CornerDerivative corner_derivative(const CameraPose& pose, const Vector3d& X) {
    const Vector3d p = pose.camera * X;
    Projection projection;
    detail::differentiate_projection(pose.lens, p, projection);
    return corner_derivative(pose, X, p, projection);
}

/// corner_derivative() and its rate while the flange moves by `direction`.
std::pair<CornerDerivative, CornerDerivative> corner_rate(const CameraPose& pose, const Vector3d& X,
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

}  // namespace

CameraPose CameraSensor::pose_with(const Isometry3d& world_from_flange,
                                   const VectorXd& unknowns) const {
    const Matrix3d turn_rate =
        has_unknown_place() ? rotation_vector_rate(unknowns.segment<3>(3)) : Matrix3d::Zero();
    return {setup_.is_on_flange,
            place(unknowns),
            camera_from_board(world_from_flange, unknowns),
            world_from_flange.linear(),
            lens_with(unknowns),
            board_factor(unknowns),
            turn_rate};
}

void CameraSensor::set_unknowns(const detail::CornerDerivative& corner,
                                Eigen::Ref<RowMatrixXd> rows) const {
    if (has_unknown_place()) rows.leftCols<6>() = corner.by_place;
    for (Index i = 0; i < intrinsics_count(); ++i) {
        rows.col(place_count() + i) =
            corner.by_values.col(unknown_intrinsics_[static_cast<std::size_t>(i)]);
    }
    if (setup_.is_scale_unknown) rows.rightCols<1>() = corner.by_scale;
}

void CameraSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto& J = J_measured_parameters;
    const CameraPose pose = pose_with(world_from_flange, unknowns);
    const Index own = J.cols() - twists.cols();
    for (Index k = 0; k < target_count(); ++k) {
        const Vector3d X = pose.factor * setup_.corners[static_cast<std::size_t>(k)];
        const CornerDerivative corner = corner_derivative(pose, X);
        auto rows = J.middleRows<2>(2 * k);
        rows.leftCols(twists.cols()).noalias() = corner.by_twist.lazyProduct(twists);
        if (own > 0) set_unknowns(corner, rows.rightCols(own));
    }
}

void CameraSensor::differentiate_along(const Isometry3d& world_from_flange,
                                       const TwistMatrix& twists, const Twist& direction,
                                       const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                       Eigen::Ref<RowMatrixXd> J_rate) const {
    const CameraPose pose = pose_with(world_from_flange, unknowns);
    const Index own = J_rate.cols() - twists.cols();
    for (Index k = 0; k < target_count(); ++k) {
        const Vector3d X = pose.factor * setup_.corners[static_cast<std::size_t>(k)];
        const auto [corner, rate] = corner_rate(pose, X, direction);
        auto rows = J_rate.middleRows<2>(2 * k);
        rows.leftCols(twists.cols()).noalias() =
            rate.by_twist.lazyProduct(twists) + corner.by_twist.lazyProduct(twist_rates);
        if (own > 0) set_unknowns(rate, rows.rightCols(own));
    }
}

}  // namespace posewise
