#include "posewise/report/units.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace posewise {

double to_degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

std::string_view error_unit(bool is_angle) { return is_angle ? "mrad" : "mm"; }

std::string format_fixed(double value, int decimals) {
    if (!std::isfinite(value)) return "-";
    std::string text = fmt::format("{:.{}f}", value, decimals);
    // "-0.000" says nothing that "0.000" does not.
    const bool is_zero = text.find_first_of("123456789") == std::string::npos;
    return is_zero && text[0] == '-' ? text.substr(1) : text;
}

std::string format_mm(double metres, int decimals) {
    return format_fixed(mm_per_m * metres, decimals);
}

std::string format_short(double value, int digits) { return fmt::format("{:.{}g}", value, digits); }

}  // namespace posewise
