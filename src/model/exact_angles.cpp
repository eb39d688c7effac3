#include "exact_angles.hpp"

#include <cmath>
#include <numbers>

namespace posewise::detail {

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
        if (off <= same || off > rounded) continue;
        element.value = exact;
        ++count;
    }
    return {chain.with_elements(std::move(elements)), count};
}

}  // namespace posewise::detail
