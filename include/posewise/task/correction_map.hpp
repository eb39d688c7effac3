#pragma once

#include <cstdint>
#include <vector>

#include "posewise/measurement/campaign.hpp"

/// What of an estimate no geometry can express (bending, periodic errors, scales of slides), as a
/// table for a cell's own software.
namespace posewise {

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

}  // namespace posewise
