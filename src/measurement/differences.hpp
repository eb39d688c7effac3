#pragma once

#include "posewise/core/types.hpp"

/// Derivatives of sensors by differences.
namespace posewise::detail {

/// The flange after a motion by this twist.
Isometry3d moved(const Isometry3d& flange, const Twist& twist);

/// Slope of f at 0 by central differences at h and h / 2, extrapolated [Richardson 1911].
template <typename Function>
MatrixXd slope_at_zero(double h, const Function& f) {
    const auto slope = [&](double step) -> MatrixXd { return (f(step) - f(-step)) / (2 * step); };
    return (4 * slope(h / 2) - slope(h)) / 3;
}

}  // namespace posewise::detail
