#pragma once

#include <optional>

#include "posewise/measurement/sensor.hpp"

/// A body as four points, for registration: its origin and one on each axis.
namespace posewise::detail {

Eigen::Matrix3Xd points_of(const Isometry3d& frame);
/// The frame of four points, one after another.
Isometry3d frame_of(const VectorXd& points);
/// The points as targets, known or not.
Targets rigid_targets(const std::optional<Isometry3d>& known);

}  // namespace posewise::detail
