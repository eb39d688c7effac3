#pragma once

#include <utility>
#include <vector>

#include "../model/joint_limits.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/model/cell.hpp"

/// What Constraints finds out once, when it is made.
namespace posewise::detail {

/// Nominal targets in the flange frame; none if the sensor has no targets. Throws InputError if
/// the cell needs them, or the tracker, and the campaign does not state them.
std::vector<Vector3d> nominal_targets(const Campaign& campaign, const Cell& cell);

/// Throws InputError for all else that is wrong with a cell (see Constraints). `robot` has the
/// margin applied.
void check_cell(const Cell& cell, const Chain& robot, const std::vector<Vector3d>& targets);

/// The limits of a robot, of joints that the cell fixes their value.
JointRange joint_range(const Chain& robot, const Cell& cell);

/// Pairs of links that may collide: the frames links are fixed to, in order along the chain, are
/// neither the same nor next to each other, so that they share no joint.
std::vector<std::pair<std::size_t, std::size_t>> colliding_pairs(const std::vector<Link>& links);

/// How far a unit of each joint moves any point on the axes of the links at most: the sum of
/// lengths between the joint and the link's far end.
VectorXd clearance_rates(const Chain& robot, const std::vector<Link>& links);

}  // namespace posewise::detail
