#pragma once

#include <functional>
#include <string>
#include <vector>

#include "posewise/task/correction.hpp"

/// Corrections of targets that are places of the tool, not joint values. A controller turns them
/// into joint values as if its robot were the nominal one; so does nominal_configurations(), and
/// correct_poses() corrects these.
namespace posewise {

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
