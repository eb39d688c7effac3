#include "units.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "text.hpp"

namespace posewise::detail {
namespace {

constexpr std::array<Unit, 9> units{{
    {"mm", Quantity::Length, 1, 1e3},
    {"m", Quantity::Length, 1, 1},
    {"um", Quantity::Length, 1, 1e6},
    {"deg", Quantity::Angle, std::numbers::pi, 180},
    {"rad", Quantity::Angle, 1, 1},
    {"mrad", Quantity::Angle, 1, 1e3},
    {"urad", Quantity::Angle, 1, 1e6},
    {"Nm", Quantity::Torque, 1, 1},
    {"px", Quantity::Pixel, 1, 1e3},
}};

double largest_plausible(Quantity quantity) { return quantity == Quantity::Angle ? 1e4 : 1e6; }

}  // namespace

double Unit::from_si(double si) const {
    const double nearest = si * divisor / factor;
    for (int digits = 1; digits < 17; ++digits) {
        const double value = parse_number(fmt::format("{:.{}e}", nearest, digits - 1)).value;
        if (to_si(value) == si) return value;
    }
    return nearest;
}

const Unit* find_unit(std::string_view name) {
    for (const Unit& unit : units) {
        if (unit.name == name) return &unit;
    }
    return nullptr;
}

std::vector<std::string> unit_names(Quantity quantity) {
    std::vector<std::string> names;
    for (const Unit& unit : units) {
        if (unit.quantity == quantity) names.emplace_back(unit.name);
    }
    return names;
}

bool is_plausible(double si, Quantity quantity) {
    return std::abs(si) <= largest_plausible(quantity);
}

std::string plausible(const Unit& unit) {
    return fmt::format("at most {:g} {} in magnitude",
                       unit.from_si(largest_plausible(unit.quantity)), unit.name);
}

NameWithUnit split_unit(std::string_view name) {
    const auto underscore = name.rfind('_');
    if (underscore == std::string_view::npos) return {name, nullptr};
    const Unit* const unit = find_unit(name.substr(underscore + 1));
    return unit != nullptr ? NameWithUnit{name.substr(0, underscore), unit}
                           : NameWithUnit{name, nullptr};
}

}  // namespace posewise::detail
