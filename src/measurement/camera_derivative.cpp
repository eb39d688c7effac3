#include <algorithm>
#include <utility>

#include "camera_view.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

using detail::BoardFromCamera;
using detail::CameraInFirst;
using detail::Projection;

/// Derivatives of one corner's place in an image: by the flange's motion, by position and rotation
/// vector of what is on it, by those of the camera in the first one's frame, and by the corner's
/// place on the board.
struct CornerDerivative {
    Eigen::Matrix<double, 2, 6> by_twist;
    Eigen::Matrix<double, 2, 6> by_place;
    Eigen::Matrix<double, 2, 6> by_camera;
    Eigen::Matrix<double, 2, 3> by_corner;
    detail::ByValues by_values;
};

/// [-x^, I], by which a point x moves with a twist.
Eigen::Matrix<double, 3, 6> velocity_by_twist(const Vector3d& x) {
    Eigen::Matrix<double, 3, 6> velocity;
    velocity << -cross_matrix(x), Matrix3d::Identity();
    return velocity;
}

/// With P the derivative by the point p = camera X of the first camera's frame: while the flange
/// moves by a twist (w, v), a board on it moves by v + w x p; a camera on it sees the board move by
/// -R (v + w x X), with its axes R. Another camera at T sees T^-1 p.
CornerDerivative corner_derivative(const BoardFromCamera& pose, const CameraInFirst& camera,
                                   const Vector3d& X, const Vector3d& p,
                                   const Projection& projection) {
    const Eigen::Matrix<double, 2, 3> P =
        projection.by_point * camera.in_first.linear().transpose();
    const Matrix3d& R = pose.camera.linear();
    CornerDerivative corner;
    corner.by_values = projection.by_values;
    corner.by_corner = P * R;
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
    const Vector3d from_camera = p - camera.in_first.translation();
    corner.by_camera << -P, P * cross_matrix(from_camera) * camera.turn_rate;
    return corner;
}

CornerDerivative corner_derivative(const BoardFromCamera& pose, const CameraInFirst& camera,
                                   const Vector3d& X) {
    const Vector3d p = pose.camera * X;
    Projection projection;
    detail::differentiate_projection(camera.lens, camera.seen(p), projection);
    return corner_derivative(pose, camera, X, p, projection);
}

/// corner_derivative() and its rate while the flange moves by `direction`.
std::pair<CornerDerivative, CornerDerivative> corner_rate(const BoardFromCamera& pose,
                                                          const CameraInFirst& camera,
                                                          const Vector3d& X,
                                                          const Twist& direction) {
    const Vector3d p = pose.camera * X;
    const Matrix3d& R = pose.camera.linear();
    const Matrix3d W = cross_matrix(direction.head<3>());
    const Vector3d velocity =
        pose.is_on_flange ? Vector3d(-R * velocity_of(X, direction)) : velocity_of(p, direction);
    const Matrix3d R_rate = pose.is_on_flange ? Matrix3d(-R * W) : Matrix3d(W * R);
    const Matrix3d to_camera = camera.in_first.linear().transpose();
    Projection projection;
    detail::ProjectionRate rate;
    detail::differentiate_projection_along(camera.lens, camera.seen(p), to_camera * velocity,
                                           projection, rate);
    const Eigen::Matrix<double, 2, 3> P = projection.by_point * to_camera;
    const Eigen::Matrix<double, 2, 3> P_rate = rate.by_point * to_camera;
    CornerDerivative corner;
    corner.by_values = rate.by_values;
    corner.by_corner = P_rate * R + P * R_rate;
    Eigen::Matrix<double, 2, 3> by_place_rate;
    Eigen::Matrix<double, 2, 3> by_arm_rate;
    if (pose.is_on_flange) {
        corner.by_twist = -corner.by_corner * velocity_by_twist(X);
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
    const Vector3d from_camera = p - camera.in_first.translation();
    corner.by_camera << -P_rate,
        (P_rate * cross_matrix(from_camera) + P * cross_matrix(velocity)) * camera.turn_rate;
    return {corner_derivative(pose, camera, X, p, projection), corner};
}

/// The columns of what is unknown, in the order of the sensor's unknowns.
void set_unknowns(const CameraSensor& sensor, Index camera, Index k, const CornerDerivative& corner,
                  Eigen::Ref<RowMatrixXd> rows) {
    rows.setZero();
    const Index errors = sensor.corner_error_count();
    if (errors > 0) rows.middleCols<3>(3 * k) = corner.by_corner;
    if (!sensor.setup().known_place) {
        rows.middleCols<6>(sensor.first_of_place()) = corner.by_place;
    }
    if (camera > 0) rows.middleCols<6>(sensor.first_unknown(camera)) = corner.by_camera;
    const auto set = [&](Index first, const std::vector<Index>& values) {
        for (const Index value : values) rows.col(first++) = corner.by_values.col(value);
    };
    set(sensor.first_intrinsic(camera), sensor.unknown_intrinsics(camera));
    set(sensor.first_intrinsic_error(camera), sensor.doubtful_intrinsics(camera));
    if (!sensor.setup().is_scale_unknown) return;
    rows.rightCols<1>() = corner.by_corner * sensor.setup().corners[static_cast<std::size_t>(k)];
}

}  // namespace

CameraInFirst detail::camera_in_first(const CameraSensor& sensor, Index camera,
                                      const VectorXd& unknowns) {
    Lens lens = lens_of(sensor.camera(camera).intrinsics);
    const bool is_polynomial = lens.distortion == Distortion::BrownConrady;
    lens.widest = is_polynomial ? std::min(sensor.widest(camera), 3.0) : sensor.widest(camera);
    const Index first = sensor.first_unknown(camera);
    Index next = sensor.first_intrinsic(camera);
    for (const Index k : sensor.unknown_intrinsics(camera)) {
        lens.values[static_cast<std::size_t>(k)] = unknowns[next++];
    }
    next = sensor.first_intrinsic_error(camera);
    for (const Index k : sensor.doubtful_intrinsics(camera)) {
        lens.values[static_cast<std::size_t>(k)] += unknowns[next++];
    }
    if (camera == 0) return {Isometry3d::Identity(), lens, Matrix3d::Zero()};
    return {frame_from(unknowns.segment<6>(first)), lens,
            rotation_vector_rate(unknowns.segment<3>(first + 3))};
}

BoardFromCamera detail::board_from_camera(const CameraSensor& sensor,
                                          const Isometry3d& world_from_flange,
                                          const VectorXd& unknowns) {
    const CameraSetup& setup = sensor.setup();
    const Index turn = sensor.first_of_place() + 3;
    return {setup.is_on_flange, sensor.place(unknowns),
            sensor.camera_from_board(world_from_flange, unknowns), world_from_flange.linear(),
            setup.known_place ? Matrix3d::Zero().eval()
                              : rotation_vector_rate(unknowns.segment<3>(turn))};
}

void CameraSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto& J = J_measured_parameters;
    const BoardFromCamera pose = detail::board_from_camera(*this, world_from_flange, unknowns);
    const Index own = J.cols() - twists.cols();
    Index row = 0;
    for (Index camera = 0; camera < camera_count(); ++camera) {
        const CameraInFirst one = detail::camera_in_first(*this, camera, unknowns);
        for (Index k = 0; k < corner_count(); ++k, row += 2) {
            const CornerDerivative derivative = corner_derivative(pose, one, corner(k, unknowns));
            auto rows = J.middleRows<2>(row);
            rows.leftCols(twists.cols()).noalias() = derivative.by_twist.lazyProduct(twists);
            if (own > 0) set_unknowns(*this, camera, k, derivative, rows.rightCols(own));
        }
    }
}

void CameraSensor::differentiate_along(const Isometry3d& world_from_flange,
                                       const TwistMatrix& twists, const Twist& direction,
                                       const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                       Eigen::Ref<RowMatrixXd> J_rate) const {
    const BoardFromCamera pose = detail::board_from_camera(*this, world_from_flange, unknowns);
    const Index own = J_rate.cols() - twists.cols();
    Index row = 0;
    for (Index camera = 0; camera < camera_count(); ++camera) {
        const CameraInFirst one = detail::camera_in_first(*this, camera, unknowns);
        for (Index k = 0; k < corner_count(); ++k, row += 2) {
            const auto [derivative, rate] = corner_rate(pose, one, corner(k, unknowns), direction);
            auto rows = J_rate.middleRows<2>(row);
            rows.leftCols(twists.cols()).noalias() =
                rate.by_twist.lazyProduct(twists) + derivative.by_twist.lazyProduct(twist_rates);
            if (own > 0) set_unknowns(*this, camera, k, rate, rows.rightCols(own));
        }
    }
}

}  // namespace posewise
