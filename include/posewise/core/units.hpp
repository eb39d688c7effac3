#pragma once

#include <numbers>
#include <string_view>

/// SI inside; where people read or write, millimetres and degrees, and milliradians for small
/// angles.
namespace posewise {

inline constexpr double mm_per_m = 1e3;
inline constexpr double mrad_per_rad = 1e3;
constexpr double to_degrees(double radians) { return radians * 180 / std::numbers::pi; }
constexpr double to_radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// What a length or an angle is stated in.
struct AmountUnits {
    std::string_view si;       ///< "m" or "rad"
    std::string_view reading;  ///< "mm" or "deg": joint values, limits, poses
    std::string_view error;    ///< "mm" or "mrad": small errors, a thousand of them to the SI unit
    std::string_view load;     ///< "N" or "N m": what gives way by this amount gives way to it
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
