#pragma once

#include <array>

#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {

inline constexpr double kpx_per_px = 1e-3;

/// Intrinsics without memory of their own: Intrinsics::values() and how many coefficients there
/// are.
struct Lens {
    Distortion distortion = Distortion::None;
    Index count = 0;
    std::array<double, 12> values{};
    double widest = 1e3;  ///< widest_tangent(): farther out the image grows with the tangent

    double coefficient(Index k) const {
        return k < count ? values[static_cast<std::size_t>(4 + k)] : 0;
    }
};
Lens lens_of(const Intrinsics& intrinsics);

/// Of a camera: derivatives by up to 12 values.
using ByValues = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 12>;

/// A place in the image and its derivatives, in thousands of pixels.
struct Projection {
    Vector2d place;
    Eigen::Matrix<double, 2, 3> by_point;  ///< by the point in the camera's frame
    ByValues by_values;                    ///< by Intrinsics::values()
};
void differentiate_projection(const Lens& lens, const Vector3d& point, Projection& projection);
/// The same, and how the derivatives change while the point moves.
struct ProjectionRate {
    Eigen::Matrix<double, 2, 3> by_point;
    ByValues by_values;
};
void differentiate_projection_along(const Lens& lens, const Vector3d& point,
                                    const Vector3d& velocity, Projection& projection,
                                    ProjectionRate& rate);
/// project() in thousands of pixels.
Vector2d place_of(const Lens& lens, const Vector3d& point);

/// Up to which x/z (to the side) the image goes outwards with the direction; at most 1e3.
double widest_tangent(Lens lens);

}  // namespace posewise::detail
