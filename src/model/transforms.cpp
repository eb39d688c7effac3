#include <Eigen/SVD>
#include <cmath>

#include "core/elementary.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

void add_fixed(std::vector<Element>& elements, Motion motion, Index axis, double value) {
    if (value != 0) elements.push_back({motion, static_cast<Axis>(axis), value, {}, ""});
}

}  // namespace

Matrix3d rotation_from_rpy(const Vector3d& rpy) {
    return rotation_from_vector(rpy.z() * Vector3d::UnitZ()) *
           rotation_from_vector(rpy.y() * Vector3d::UnitY()) *
           rotation_from_vector(rpy.x() * Vector3d::UnitX());
}

Matrix3d rotation_from_vector(const Vector3d& vector) {
    const double angle = vector.norm();
    if (angle == 0) return Matrix3d::Identity();
    const auto [sine, cosine] = detail::sine_and_cosine(angle);
    const Vector3d axis = vector / angle;
    return cosine * Matrix3d::Identity() + sine * cross_matrix(axis) +
           (1 - cosine) * axis * axis.transpose();
}

Vector3d vector_from_rotation(const Matrix3d& R) {
    const Eigen::AngleAxisd turn(R);
    return turn.angle() * turn.axis();
}

Matrix3d nearest_rotation(const Matrix3d& X) {
    const Eigen::JacobiSVD<Matrix3d> svd(X, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d D = Matrix3d::Identity();
    D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixU() * D * svd.matrixV().transpose();
}

Matrix3d rotation_between(const Vector3d& from, const Vector3d& to) {
    const Vector3d a = from.normalized(), b = to.normalized();
    const Vector3d middle = a + b;
    constexpr double opposite = 1e-8;
    if (middle.norm() < opposite) {
        const Vector3d axis = a.unitOrthogonal();
        return 2 * axis * axis.transpose() - Matrix3d::Identity();
    }
    // By 180 deg about a, then about the middle of both.
    const Vector3d half = middle.normalized();
    return (2 * half * half.transpose() - Matrix3d::Identity()) *
           (2 * a * a.transpose() - Matrix3d::Identity());
}

Matrix3d rotation_vector_rate(const Vector3d& vector) {
    const double angle = vector.norm();
    const Matrix3d X = cross_matrix(vector);
    // (1 - cos t) / t^2 and (t - sin t) / t^3, by their series where the differences cancel.
    double a = 0.5 - angle * angle / 24;
    double b = 1.0 / 6 - angle * angle / 120;
    if (angle > 1e-3) {
        const double half = detail::sine_and_cosine(angle / 2).sine;
        a = 2 * half * half / (angle * angle);
        b = (angle - detail::sine_and_cosine(angle).sine) / (angle * angle * angle);
    }
    return Matrix3d::Identity() + a * X + b * X * X;
}

Matrix3d cross_matrix(const Vector3d& vector) {
    Matrix3d X;
    X << 0, -vector.z(), vector.y(), vector.z(), 0, -vector.x(), -vector.y(), vector.x(), 0;
    return X;
}

Vector3d rpy_from_rotation(const Matrix3d& R) {
    const double cos_pitch = std::hypot(R(2, 1), R(2, 2));
    const double roll = cos_pitch > 1e-15 ? detail::arc_tangent(R(2, 1), R(2, 2)) : 0;
    // Near upright the roll is mostly rounding; a yaw of what is left makes up for it.
    const Matrix3d rest = R * Eigen::AngleAxisd(-roll, Vector3d::UnitX());
    return {roll, detail::arc_tangent(-R(2, 0), cos_pitch),
            detail::arc_tangent(-rest(0, 1), rest(1, 1))};
}

std::vector<Element> origin_elements(const Vector3d& xyz, const Vector3d& rpy) {
    std::vector<Element> elements;
    for (Index axis = 0; axis < 3; ++axis) {
        add_fixed(elements, Motion::Translation, axis, xyz[axis]);
    }
    for (Index axis = 2; axis >= 0; --axis) {
        add_fixed(elements, Motion::Rotation, axis, rpy[axis]);
    }
    return elements;
}

std::vector<Element> joint_elements(Motion motion, const Vector3d& axis, Index joint) {
    Index k = 0;
    axis.cwiseAbs().maxCoeff(&k);
    const Index i = (k + 1) % 3;
    const Index j = (k + 2) % 3;
    const double sign = axis[k] < 0 ? -1 : 1;
    // Ri(alpha) Rj(beta) e_k = sin(beta) e_i - sin(alpha) cos(beta) e_j + cos(alpha) cos(beta) e_k.
    const double alpha = detail::arc_tangent(-sign * axis[j], sign * axis[k]);
    const double beta = detail::arc_tangent(sign * axis[i], std::hypot(axis[j], axis[k]));
    std::vector<Element> elements;
    add_fixed(elements, Motion::Rotation, i, alpha);
    add_fixed(elements, Motion::Rotation, j, beta);
    elements.push_back({motion, static_cast<Axis>(k), 0, {{joint, sign}}, ""});
    add_fixed(elements, Motion::Rotation, j, -beta);
    add_fixed(elements, Motion::Rotation, i, -alpha);
    return elements;
}

}  // namespace posewise
