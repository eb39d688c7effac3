#pragma once

#include <string>
#include <string_view>

namespace posewise {

/// Reports print millimetres for lengths and milliradians (small) or degrees (large) for angles.
inline constexpr double mm_per_m = 1e3;
inline constexpr double mrad_per_rad = 1e3;
double to_degrees(double radians);

/// "mm" or "mrad": the unit small errors of a parameter are printed in. The factor from SI is 1000
/// for both.
std::string_view error_unit(bool is_angle);

/// A number with that many decimals; "-" if it is not finite.
std::string format_fixed(double value, int decimals);
/// A length in m as mm with that many decimals.
std::string format_mm(double metres, int decimals = 4);
/// A number with that many significant digits, without trailing zeros; "inf" and "-inf" as such.
std::string format_short(double value, int digits = 5);

}  // namespace posewise
