#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>
#include <string_view>

/// Vector and matrix types shared by all modules. Values are SI doubles: metres and radians.
namespace posewise {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Rows are observations, so one pose's rows are contiguous in memory.
using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Motion of a rigid body: angular velocity w, then velocity v of the point at the world origin. A
/// point x of the body moves with v + w cross x.
using Twist = Eigen::Matrix<double, 6, 1>;

/// Columns are twists, see Chain::differentiate(). Stored row by row, so that loops over columns
/// vectorise.
using TwistMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;

// SI units inside; millimetres and degrees in files and reports, milliradians for small angles.

inline constexpr double mm_per_m = 1e3;
inline constexpr double mrad_per_rad = 1e3;
constexpr double to_degrees(double radians) { return radians * 180 / std::numbers::pi; }
constexpr double to_radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// The units of a length or an angle.
struct AmountUnits {
    std::string_view si;       ///< "m" or "rad"
    std::string_view reading;  ///< "mm" or "deg": for joint values, limits and poses
    std::string_view error;    ///< "mm" or "mrad": for small errors, 1000 per SI unit
    std::string_view load;     ///< "N" or "N m": for the load on a compliant joint
    double factor = 1;         ///< reading = si * factor / divisor
    double divisor = 1;

    constexpr double to_reading(double in_si) const { return in_si * factor / divisor; }
    constexpr double to_si(double reading_value) const { return reading_value * divisor / factor; }
};

inline constexpr AmountUnits length_units{"m", "mm", "mm", "N", mm_per_m, 1};
inline constexpr AmountUnits angle_units{"rad", "deg", "mrad", "N m", 180, std::numbers::pi};

constexpr const AmountUnits& units_of(bool is_angle) {
    return is_angle ? angle_units : length_units;
}

}  // namespace posewise
