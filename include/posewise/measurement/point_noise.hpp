#pragma once

#include <variant>

#include "posewise/core/types.hpp"

namespace posewise {

/// The same noise in every direction: standard deviation of one coordinate, m.
struct IsotropicNoise {
    double sigma = 0;
};

/// Standard deviations along the axes of the instrument, whose frame is that of the observations
/// (the world), m.
struct PerAxisNoise {
    Vector3d sigma = Vector3d::Zero();
};

/// Laser tracker: a point at distance d in direction u has covariance
/// range_sigma^2 u u^T + (angle_sigma d)^2 (I - u u^T).
struct LaserTrackerNoise {
    double range_sigma = 0;  ///< m, along the beam
    double angle_sigma = 0;  ///< rad, of each of the two angles
    /// Where the beam starts, in the frame of the observations (the world): its origin, unless the
    /// observations were moved to another frame.
    Vector3d position = Vector3d::Zero();
};

/// How noisy one observed point is.
using PointNoise = std::variant<IsotropicNoise, PerAxisNoise, LaserTrackerNoise>;

/// Throws InputError if a sigma is not finite or below 1e-15 (m or rad), or a position not finite.
void check_noise(const PointNoise& noise);

/// Covariance of an observed point (m, in the world), m^2. Positive definite: a tracker's point
/// nearer than 1 mm counts as 1 mm away.
Matrix3d point_covariance(const PointNoise& noise, const Vector3d& point);

/// Rate of point_covariance() while the point moves with `velocity`.
Matrix3d point_covariance_rate(const PointNoise& noise, const Vector3d& point,
                               const Vector3d& velocity);

/// Standard deviation of one coordinate: root mean square over the axes, at distance `distance` (m)
/// from the instrument.
double coordinate_sigma(const PointNoise& noise, double distance);

}  // namespace posewise
