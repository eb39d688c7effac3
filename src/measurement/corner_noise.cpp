#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "camera_view.hpp"
#include "core/elementary.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

using detail::BoardFromCamera;
using detail::CameraInFirst;

// Beyond these the noise grows no more: where a camera sees nothing, but a search may begin.
constexpr double least_cosine = 0.05;
constexpr double least_depth = 1e-3;  // m

/// What moves with the flange, in a camera's frame: a corner, and the board's normal.
struct SeenCorner {
    Vector3d place, velocity;
    Vector3d normal, normal_rate;
};

/// By what the variance of a corner is multiplied, and how that changes while it moves.
struct Growth {
    double factor = 1;
    double rate = 0;
};

/// (1 / cos t)^(2 tilt).
Growth by_tilt(double exponent, const SeenCorner& corner) {
    if (exponent == 0) return {};
    const double distance = corner.place.norm();
    const double along = corner.normal.dot(corner.place);
    const double cosine = -along / distance;
    if (!(cosine > least_cosine)) return {detail::power(least_cosine, -2 * exponent), 0};
    const double cosine_rate =
        -(corner.normal_rate.dot(corner.place) + corner.normal.dot(corner.velocity)) / distance +
        along * corner.place.dot(corner.velocity) / std::pow(distance, 3);
    const double factor = detail::power(cosine, -2 * exponent);
    return {factor, -2 * exponent * factor * cosine_rate / cosine};
}

/// 1 + b^2, `focal` in px.
Growth by_blur(const NoiseGrowth& growth, double focal, const SeenCorner& corner) {
    if (!growth.focus) return {};
    const double depth = std::max(corner.place.z(), least_depth);
    const double blur = focal * growth.aperture * (1 / depth - 1 / *growth.focus);
    const double depth_rate = corner.place.z() > least_depth ? corner.velocity.z() : 0;
    const double blur_rate = -focal * growth.aperture * depth_rate / (depth * depth);
    return {1 + blur * blur, 2 * blur * blur_rate};
}

Growth growth_of(const NoiseGrowth& growth, double focal, const SeenCorner& corner) {
    const Growth tilt = by_tilt(growth.tilt, corner), blur = by_blur(growth, focal, corner);
    return {tilt.factor * blur.factor, tilt.rate * blur.factor + tilt.factor * blur.rate};
}

/// A corner X of the board while the flange moves: see corner_derivative().
SeenCorner seen_corner(const BoardFromCamera& pose, const CameraInFirst& camera, const Vector3d& X,
                       const Vector3d& normal, const Twist& direction) {
    const Vector3d p = pose.camera * X;
    const Vector3d n = pose.camera.linear() * normal;
    const Vector3d turn = direction.head<3>();
    const Matrix3d& R = pose.camera.linear();
    const Matrix3d to_camera = camera.in_first.linear().transpose();
    if (pose.is_on_flange) {
        return {camera.seen(p), to_camera * (-R * velocity_of(X, direction)), to_camera * n,
                to_camera * (-R * turn.cross(normal))};
    }
    return {camera.seen(p), to_camera * velocity_of(p, direction), to_camera * n,
            to_camera * turn.cross(n)};
}

/// Sets what covariance() has on its diagonal: sigma^2 of each corner, kpx^2, times what `part`
/// takes of its Growth.
template <typename Part>
void set_variances(const CameraSensor& sensor, const Vector3d& front,
                   const Isometry3d& world_from_flange, const Twist& direction,
                   const VectorXd& unknowns, Part part, Eigen::Ref<MatrixXd> covariance) {
    const BoardFromCamera pose = detail::board_from_camera(sensor, world_from_flange, unknowns);
    Index row = 0;
    for (Index c = 0; c < sensor.camera_count(); ++c) {
        const SingleCamera& camera = sensor.camera(c);
        const double sigma = detail::kpx_per_px * camera.sigma;
        const CameraInFirst one = detail::camera_in_first(sensor, c, unknowns);
        const double focal = one.lens.values[0] / detail::kpx_per_px;
        for (Index k = 0; k < sensor.corner_count(); ++k, row += 2) {
            const SeenCorner corner =
                seen_corner(pose, one, sensor.corner(k, unknowns), front, direction);
            covariance(row, row) = covariance(row + 1, row + 1) =
                sigma * sigma * part(growth_of(camera.growth, focal, corner));
        }
    }
}

}  // namespace

void detail::check_growth(const NoiseGrowth& growth) {
    constexpr double steepest = 4, widest = 1;  // m
    if (!(growth.tilt >= 0 && growth.tilt <= steepest)) {
        throw InputError(
            fmt::format("noise.tilt is {:g}, must be from 0 to {:g}", growth.tilt, steepest));
    }
    if (!growth.focus) return;
    if (!(*growth.focus > 0 && std::isfinite(*growth.focus))) {
        throw InputError(fmt::format("noise.focus is {:g} m, must be above 0", *growth.focus));
    }
    if (!(growth.aperture > 0 && growth.aperture <= widest)) {
        throw InputError(fmt::format("noise.aperture is {:g} m, must be above 0 and at most {:g} m",
                                     growth.aperture, widest));
    }
}

bool CameraSensor::has_constant_covariance() const {
    for (Index c = 0; c < camera_count(); ++c) {
        if (!camera(c).growth.is_none()) return false;
    }
    return true;
}

void CameraSensor::covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                              Eigen::Ref<MatrixXd> covariance) const {
    covariance.setZero();
    if (!has_constant_covariance()) {
        set_variances(
            *this, normal_.value_or(Vector3d::Zero()), world_from_flange, Twist::Zero(), unknowns,
            [](const Growth& growth) { return growth.factor; }, covariance);
        return;
    }
    for (Index c = 0; c < camera_count(); ++c) {
        const double sigma = detail::kpx_per_px * camera(c).sigma;
        covariance.diagonal()
            .segment(2 * c * corner_count(), 2 * corner_count())
            .setConstant(sigma * sigma);
    }
}

MatrixXd CameraSensor::covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                       const VectorXd& unknowns) const {
    MatrixXd rate = MatrixXd::Zero(row_count(), row_count());
    if (has_constant_covariance()) return rate;
    set_variances(
        *this, normal_.value_or(Vector3d::Zero()), world_from_flange, direction, unknowns,
        [](const Growth& growth) { return growth.rate; }, rate);
    return rate;
}

std::vector<NoiseNumber> CameraSensor::noise_numbers() const {
    std::vector<NoiseNumber> numbers;
    for (Index c = 0; c < camera_count(); ++c) {
        const std::string of = c == 0 ? "" : fmt::format("camera{}_", c + 1);
        numbers.push_back({of + "sigma_px", {camera(c).sigma}});
        const NoiseGrowth& growth = camera(c).growth;
        if (growth.tilt > 0) numbers.push_back({of + "noise_tilt", {growth.tilt}});
        if (!growth.focus) continue;
        numbers.push_back({of + "focus_m", {*growth.focus}});
        numbers.push_back({of + "aperture_m", {growth.aperture}});
    }
    return numbers;
}

}  // namespace posewise
