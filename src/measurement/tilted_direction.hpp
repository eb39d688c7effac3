#pragma once

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// A direction stated, turned by a rotation vector across it (rad, about two axes at right angles),
/// and its derivatives by the two tilts.
struct TiltedDirection {
    Vector3d value;
    Vector3d by_tilt1;
    Vector3d by_tilt2;
};

/// `stated` is of length 1.
TiltedDirection tilt(const Vector3d& stated, double tilt1, double tilt2);

}  // namespace posewise::detail
