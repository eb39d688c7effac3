#include "length_units.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace posewise::detail {
namespace {

constexpr std::array<LengthUnitMistake, 8> mistakes{{
    {1e-3, "mm", "m"},
    {1e3, "m", "mm"},
    {25.4, "inches", "mm"},
    {0.0254, "inches", "m"},
    {304.8, "feet", "mm"},
    {0.3048, "feet", "m"},
    {10, "cm", "mm"},
    {0.01, "cm", "m"},
}};

/// How far apart two factors are.
double distance(double factor, double other) { return std::abs(std::log(factor / other)); }

}  // namespace

std::span<const LengthUnitMistake> length_unit_mistakes() { return mistakes; }

const LengthUnitMistake& mistake_of(double factor) {
    return *std::ranges::min_element(
        mistakes, {}, [&](const auto& mistake) { return distance(factor, mistake.factor); });
}

double nearest_length_factor(double factor) {
    const double nearest = mistake_of(factor).factor;
    return distance(factor, nearest) < distance(factor, 1) ? nearest : 1;
}

}  // namespace posewise::detail
