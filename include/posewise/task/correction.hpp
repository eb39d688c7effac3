#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "posewise/calibrator/correction.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// The base frame in which the nominal robot's poses are meant.
enum class CorrectionBase {
    Estimate,  ///< the estimated one: the first joint's axis is where it was measured
    Campaign,  ///< the campaign's stated one: programs refer to the instrument's frame
};

/// Corrected configurations of a program.
struct CorrectedPoses {
    Chain robot;
    std::vector<std::string> ids;
    RowMatrixXd nominal;                  ///< m x joints, as programmed
    std::vector<Correction> corrections;  ///< m
    /// Configurations that are not brought home: joints are held, or the pose is singular, and over
    /// half of the error is left.
    std::vector<Index> not_home{};
    /// Which configurations, nominal and corrected, bring links of the campaign's cell into
    /// obstacles or each other, or are beyond its joint sums, in words; empty: none.
    std::string collisions = {};

    /// Whether at least half are brought home; else these corrections must not be sent to a robot.
    bool are_usable() const { return 2 * not_home.size() <= corrections.size(); }
};

/// Joint values that bring the robot with the errors found to where the nominal one would be at
/// these configurations (m x joints), see correct_configuration(). Throws InputError, with the id,
/// if a configuration is beyond the joint limits; for options out of range; or if the campaign
/// states no base but `base` asks for it.
CorrectedPoses correct_poses(const Campaign& campaign, const Parameters& found,
                             const RowMatrixXd& configurations, const std::vector<std::string>& ids,
                             CorrectionBase base = CorrectionBase::Estimate,
                             const CorrectionOptions& options = {});

// What of an estimate no geometry can express (bending, periodic errors, scales of slides), as a
// table for a cell's own software.

/// A factor of a map's term: q^order, cos(order q) or sin(order q) of one joint (rad or m).
struct MapFactor {
    enum class Shape { Power, Cosine, Sine };
    Index joint = 0;
    Shape shape = Shape::Power;
    double order = 1;
    auto operator<=>(const MapFactor&) const = default;
};

/// Adds `amounts` (rad or m, of each joint) times the product of its factors.
struct MapTerm {
    std::vector<MapFactor> factors;  ///< at most one a joint, by joint; empty: a constant
    VectorXd amounts;
};

/// How far a robot is off at the targets (without: the flange) at configurations that no grid has.
struct MapError {
    double rms = 0;          ///< m
    double p95 = 0;          ///< m
    double largest = 0;      ///< m
    double orientation = 0;  ///< RMS of the angle, rad
};

/// The estimate's robot is at joint values q where its geometry alone would be at q + map(q).
struct CorrectionMap {
    Chain robot;
    std::vector<MapTerm> terms;  ///< largest amounts first
    MapError geometry_alone;     ///< with the estimate's geometry, sent as it says
    MapError with_map;           ///< sent as joints_to_send() says
    Index pose_count = 0;        ///< random ones that both were found at
};

struct MapOptions {
    double negligible = 1e-7;  ///< sum of amounts of a joint that are left out, rad or m
    Index pose_count = 1000;   ///< to find the errors at
    std::uint64_t seed = 1;
};

/// Torques of weights are products of sines and cosines of the joints they turn with. Their values
/// on a grid of five angles a joint (two places of a slide) determine the coefficients: the
/// discrete Fourier transform over all joints. Periodic errors and scales of one joint are terms as
/// they are. Errors that tilt or move an axis as a joint turns are no change of joints and are left
/// out; the errors found say what that leaves. Throws InputError for a robot with measured torques
/// or over seven joints, and if no error found depends on the configuration.
CorrectionMap correction_map(const Campaign& campaign, const Parameters& found,
                             const MapOptions& options = {});

/// The map's sum at q: what the joints seem to be turned or moved by.
VectorXd value_at(const CorrectionMap& map, const VectorXd& q);

/// Joint values that bring the estimate's robot where its geometry is at q: s = q - map(s), by
/// three steps from q.
VectorXd joints_to_send(const CorrectionMap& map, const VectorXd& q);

// Corrections of targets that are places of the tool, not joint values. A controller turns them
// into joint values as if its robot were the nominal one; so does nominal_configurations(), and
// correct_poses() corrects these.

/// Where a tool is to be.
struct CartesianTarget {
    std::string id;
    Isometry3d frame_from_tool = Isometry3d::Identity();
    VectorXd seed = {};  ///< joint values near those that are meant; empty: CartesianFrames::seed
    /// Which joint values are of the configuration that is stated with it; empty: any.
    std::function<bool(const VectorXd&)> is_wanted = {};
};

/// What the numbers of Cartesian targets refer to.
struct CartesianFrames {
    Isometry3d base_from_frame = Isometry3d::Identity();
    Isometry3d flange_from_tool = Isometry3d::Identity();
    VectorXd seed = {};  ///< for targets without one of their own
};

/// The joint values (targets x joints) with which the nominal robot brings its tool there, each
/// nearest to its seed. Throws InputError, with the id, for a target without a seed, one that the
/// nominal robot does not reach within its limits, and one where two branches are about as near to
/// the seed.
RowMatrixXd nominal_configurations(const Campaign& campaign,
                                   const std::vector<CartesianTarget>& targets,
                                   const CartesianFrames& frames);

/// Where a controller must be told that the tool is, so that the nominal robot's joint values are
/// the corrected ones: frame_from_tool of each. Throws InputError, with the id, where a correction
/// passes a singular pose, so that another configuration than the stated one would be needed.
std::vector<Isometry3d> corrected_targets(const CorrectedPoses& corrected,
                                          const CartesianFrames& frames);

}  // namespace posewise
