#pragma once

#include <span>
#include <string>

#include "posewise/core/types.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::detail {

/// What the numbers of an orientation may mean beside what their columns say.
struct OrientationSense {
    const char* words;  ///< "as roll, pitch, yaw about fixed axes"
    const char* cure;   ///< "name the columns roll, pitch, yaw"
    /// The rotation meant, from roll, pitch and yaw where those were read, else from the rotation
    /// vector (rad).
    Matrix3d (*meant)(const Vector3d& read);
};

/// All that are tried for numbers of this notation.
std::span<const OrientationSense> orientation_senses(OrientationNotation notation);

/// The columns of a notation: "rx, ry, rz".
std::string orientation_columns(OrientationNotation notation);

}  // namespace posewise::detail
