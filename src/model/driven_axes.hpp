#pragma once

#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise::detail {

struct Line {
    Vector3d point;
    Vector3d direction;  ///< of length 1
};

/// Sine of the angle between two axes below which their common normal is far away, or nowhere.
inline constexpr double nearly_parallel = 0.1;

/// The point of `line` that is nearest to `other`; they must not be parallel.
Vector3d foot_of_normal(const Line& line, const Line& other);

/// A driven element at joint values zero.
struct DrivenAxis {
    Isometry3d base_from_element;  ///< the frame right before it
    const Element* element;

    Line line() const {
        return {base_from_element.translation(),
                base_from_element.linear().col(static_cast<Index>(element->axis))};
    }
};

struct DrivenAxes {
    std::vector<DrivenAxis> axes;
    Isometry3d base_from_flange;  ///< at joint values zero
};

/// Those of a chain, which they must not outlive; terms of its elements count as zero.
DrivenAxes find_driven_axes(const Chain& chain, const VectorXd& parameters);

}  // namespace posewise::detail
