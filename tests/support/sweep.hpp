#pragma once

#include <cstdlib>

#include "posewise/core/random.hpp"

namespace posewise::testing {

/// Cases of a random sweep: POSEWISE_SWEEP_COUNT, or 1000.
inline Index sweep_count() {
    const char* const text = std::getenv("POSEWISE_SWEEP_COUNT");
    const long count = text == nullptr ? 0 : std::strtol(text, nullptr, 10);
    return count > 0 ? count : 1000;
}

inline VectorXd random_vector(RandomStream& stream, Index size, double magnitude) {
    VectorXd x(size);
    for (Index k = 0; k < size; ++k) x[k] = stream.uniform(-magnitude, magnitude);
    return x;
}

/// Any rotation, and a translation within a cube of half edge 2 m.
inline Isometry3d random_pose(RandomStream& stream) {
    Eigen::Quaterniond rotation(stream.normal(), stream.normal(), stream.normal(), stream.normal());
    Isometry3d pose(rotation.normalized());
    pose.translation() = random_vector(stream, 3, 2);
    return pose;
}

}  // namespace posewise::testing
