#include "exact_angles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace posewise::detail {
namespace {

/// Whether a number has fewer digits than a computation leaves: then it is rounded.
bool is_short(double value) {
    constexpr auto computed = 16;
    const std::string text = fmt::format("{}", value);
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    return std::count_if(text.begin(), std::find(text.begin(), text.end(), 'e'), is_digit) <
           computed;
}

}  // namespace

ExactAngles with_exact_angles(const Chain& chain) {
    constexpr double quarter = std::numbers::pi / 2;
    constexpr double rounded = 1e-6;  // rad
    constexpr double same = 1e-12;    // below it nothing depends on it
    std::vector<Element> elements = chain.elements();
    Index count = 0;
    for (Element& element : elements) {
        if (element.motion != Motion::Rotation) continue;
        const double exact = quarter * std::round(element.value / quarter);
        const double off = std::abs(element.value - exact);
        if (off <= same || off > rounded || !is_short(element.value)) continue;
        element.value = exact;
        ++count;
    }
    return {chain.with_elements(std::move(elements)), count};
}

}  // namespace posewise::detail
