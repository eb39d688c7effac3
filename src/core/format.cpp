#include "format.hpp"

#include <fmt/format.h>

#include <cmath>

#include "posewise/core/types.hpp"

namespace posewise::detail {

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

}  // namespace posewise::detail
