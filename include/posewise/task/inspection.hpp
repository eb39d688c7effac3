#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "posewise/criteria/criterion.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

/// The part of a calibration that a program with a purely geometric robot model can use.
namespace posewise {

/// Distance of targets from where another model of the robot has them, m.
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
    /// For sensors that measure poses: the tool in the flange frame, at the only target.
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

/// The constant errors found, without those that depend on the configuration. Throws InputError if
/// the cell leaves no room, or for a workspace that is not the robot's.
Geometry estimated_geometry(const Campaign& campaign, const Parameters& found,
                            const GeometryOptions& options = {});

/// The geometry whose targets are nearest to those of the robot with all errors found (least
/// squares of positions over the workspace), as if calibrated on all of it: the irreducible
/// constant errors, base and targets, except for what the campaign knows of these. If the sensor
/// has fewer than three targets, points 100 mm from the first one count, too, so that orientations
/// are close as well. Among geometries equally near within a micrometre it is the one nearest to
/// what was found. Throws InputError as estimated_geometry() does.
Geometry nearest_geometry(const Campaign& campaign, const Parameters& found,
                          const GeometryOptions& options = {});

/// Distance of the nominal robot's targets from those of the robot found, with base and targets
/// fitted over the workspace unless they are known: the reference for a geometry's loss. Throws
/// InputError as estimated_geometry() does.
PositionLoss nominal_loss(const Campaign& campaign, const Parameters& found,
                          const GeometryOptions& options = {});

/// A target on the axis of the last joint. That joint does not move it, so no measurement of it
/// determines the joint's zero.
struct OnAxis {
    Index target = 0;
    std::string joint;
};
/// For stated targets, within 1e-4 of extent(); none if others are off the axis.
std::vector<OnAxis> find_on_axis(const Campaign& campaign);

/// Joints whose limits lie within +-2 pi deg although at least half of the others turn ten times as
/// far: these limits seem to be in rad.
std::vector<Index> find_narrow_limits(const Campaign& campaign);

/// Which errors of a robot can be found.
struct Inspection {
    Campaign campaign;
    Campaign complete;  ///< with every error that a rigid link can have
    /// For the parameters that the campaign states; nothing if it states none but has the
    /// irreducible form of its complete model.
    std::optional<Identifiability> stated;
    Identifiability of_complete;
    Index least_pose_count = 0;  ///< for a calibration
    Unknowable unknowable;       ///< for base and sensor
    std::vector<OnAxis> on_axis;
    Index rounded_angle_count = 0;  ///< angles of the robot's file that are taken as exact
};

/// `declared` is the robot as stated, from which the complete model is made. `is_stated`: its error
/// parameters are stated, too.
Inspection inspect(const Campaign& campaign, const Chain& declared, bool is_stated);

/// The parameters that make it unclear what is identifiable: those in the weakest direction kept.
/// Empty if there is a clear gap, or a prior, which holds what the poses hardly show.
std::vector<std::string> find_doubtful_parameters(const Inspection& inspection);

/// How informative configurations are about the parameters, by every index.
struct Indices {
    std::array<double, all_criteria.size()> values{};  ///< in the order of all_criteria
    double condition = 0;  ///< largest / smallest singular value; infinity if that is zero
};

/// Information in measured configurations, before any calibration.
struct Rating {
    Index configurations = 0;
    Index parameters = 0;
    double repeats = 1;                  ///< samples per configuration, on average
    Indices scaled;                      ///< whitened, per expected error, including the prior
    Indices plain;                       ///< in mm and mrad, without a prior
    std::vector<WeakDirection> weakest;  ///< for `scaled`, weakest first
};

/// Rates the measured configurations, with base and targets registered from the measurements. G and
/// V predict the configurations themselves. Names the `directions` weakest directions. Throws
/// InputError if base or targets cannot be registered.
Rating rate(const Campaign& campaign, const Measurements& measurements, Index directions = 3);

/// Rates plain blocks: `plain` without and `scaled` with the prior, if `has_prior`: a standard
/// deviation of 1 of each parameter. Only the candidates `poses`, if any; G and V predict all of
/// them. Throws InputError for poses that are not among the candidates.
Rating rate(const Blocks& candidates, const std::vector<Index>& poses = {}, bool has_prior = false,
            Index directions = 3);

}  // namespace posewise
