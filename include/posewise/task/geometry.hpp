#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posewise/measurement/campaign.hpp"

/// What of a calibrated robot a program can use that knows geometry only.
namespace posewise {

/// How far targets are from where another model of the robot has them, m.
struct PositionLoss {
    double rms = 0;
    double largest = 0;
};

/// A robot whose errors are all constant.
struct Geometry {
    Chain robot;
    VectorXd errors;  ///< error parameters of `robot`, m and rad
    Isometry3d world_from_base = Isometry3d::Identity();
    std::vector<Vector3d> targets;  ///< in the flange frame, m
    /// Of sensors that measure poses: the tool in the flange frame, at the only target.
    std::optional<Isometry3d> tool;
    /// Against the robot with all its errors, at the targets over the workspace.
    PositionLoss lost;
};

struct GeometryOptions {
    /// Where the robot works (configurations x joints). Empty: configuration_count of a
    /// low-discrepancy sequence within its limits, and its cell if one is stated.
    RowMatrixXd workspace = {};
    Index configuration_count = 1000;
    std::uint64_t seed = 1;
};

/// The constant errors found, those that depend on the configuration left out. Throws InputError if
/// the cell leaves no room, or for a workspace that is not the robot's.
Geometry estimated_geometry(const Campaign& campaign, const Parameters& found,
                            const GeometryOptions& options = {});

/// The geometry that has the targets nearest to where the robot with all errors found has them
/// (least squares of positions over the workspace), as if it were calibrated on all of that: the
/// irreducible constant errors, base and targets, but for what the campaign knows of these. Where
/// the sensor has less than three targets, points 100 mm beside the first one count as others do,
/// so that orientations are near, too. Of geometries as near within a micrometre it is the one
/// nearest to what was found. Throws InputError as estimated_geometry() does.
Geometry nearest_geometry(const Campaign& campaign, const Parameters& found,
                          const GeometryOptions& options = {});

/// How far the targets of the robot as its maker says are from those of the one found, base and
/// targets fitted to them over the workspace as far as they are not known: what a geometry's loss
/// is to be compared with. Throws InputError as estimated_geometry() does.
PositionLoss nominal_loss(const Campaign& campaign, const Parameters& found,
                          const GeometryOptions& options = {});

}  // namespace posewise
