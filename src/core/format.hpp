#pragma once

#include <string>

/// Numbers in messages and tables.
namespace posewise::detail {

/// A number with that many decimals; "-" if it is not finite.
std::string format_fixed(double value, int decimals);
/// A length in m as mm with that many decimals.
std::string format_mm(double metres, int decimals = 4);
/// A number with that many significant digits, without trailing zeros; "inf" and "-inf" as such.
std::string format_short(double value, int digits = 5);

}  // namespace posewise::detail
