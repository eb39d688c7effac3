#pragma once

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// Joint values that were read back may differ by this from those sent, rad or m.
inline constexpr double same_pose_tolerance = 2e-3;

/// Whether no joint differs by more; configurations of different sizes are never the same.
template <class A, class B>
bool is_same_pose(const A& a, const B& b, double tolerance = same_pose_tolerance) {
    return a.size() == b.size() && (a - b).cwiseAbs().maxCoeff() <= tolerance;
}

}  // namespace posewise::detail
