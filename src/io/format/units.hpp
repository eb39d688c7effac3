#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise::detail {

enum class Quantity { Length, Angle, Torque, Pixel };

/// What a translation or a rotation is measured in.
inline Quantity quantity_of(Motion motion) {
    return motion == Motion::Rotation ? Quantity::Angle : Quantity::Length;
}

/// A unit of files: value * factor / divisor is in m, rad, N m or thousands of pixels. (312 mm /
/// 1000 is 0.312 to the last digit, 312 * 1e-3 is not.)
struct Unit {
    std::string_view name;
    Quantity quantity = Quantity::Length;
    double factor = 1;
    double divisor = 1;

    double to_si(double value) const { return value * factor / divisor; }
    /// The shortest decimal number that to_si() turns into `si`; the nearest one if none does.
    double from_si(double si) const;
};

/// The unit of that name; nullptr if there is none.
const Unit* find_unit(std::string_view name);

/// Names of the units of a quantity, the usual one first.
std::vector<std::string> unit_names(Quantity quantity);

/// Whether m, rad or N m are of a size that occurs: a larger one is a slip, and would overflow
/// later.
bool is_plausible(double si, Quantity quantity);
/// That rule in words and in this unit, "at most 1e+09 mm in magnitude".
std::string plausible(const Unit& unit);

/// A name that carries its unit as a suffix: `q1_rad`, `p1_x_mm`.
struct NameWithUnit {
    std::string_view stem;
    const Unit* unit = nullptr;  ///< nullptr: no suffix is a unit, and the stem is the whole name
};
NameWithUnit split_unit(std::string_view name);

}  // namespace posewise::detail
