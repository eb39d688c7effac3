#pragma once

#include <string>
#include <utility>
#include <vector>

#include "model/joint_limits.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/model/cell.hpp"

/// What Constraints finds out once, when it is made.
namespace posewise::detail {

/// Whether the joints of a sum turn or slide.
Motion motion_of(const JointSum& sum, const Chain& robot);

/// The limits of a sum less the cell's margin.
Interval within_margin(const JointSum& sum, const Cell& cell, const Chain& robot);

/// By which a pose at its bound may be beyond it, since it was read from a file, m or rad.
inline constexpr double pose_rounding = 1e-9;

/// How far a value is from leaving an interval; negative: it did.
double interval_clearance(const Interval& interval, double value);

/// "q3 - q2 is 95 deg, must be from -80 to 88 deg": of the sum farthest beyond its limits, less the
/// margin; empty if none is, to rounding.
std::string describe_sums(const Cell& cell, const Chain& robot, const VectorXd& q);

/// Angle between two vectors, exact also where it is small; 0 if one has no length.
double angle_between(const Vector3d& a, const Vector3d& b);

/// Where an instrument finds a point of its frame, rad.
struct Sighting {
    double azimuth = 0;
    double elevation = 0;  ///< above its xy plane
};
Sighting sighting_of(const Vector3d& point);

/// Nominal targets in the flange frame; none if the sensor has no targets. Throws InputError if
/// the cell needs them, or the tracker, and the campaign does not state them.
std::vector<Vector3d> nominal_targets(const Campaign& campaign, const Cell& cell);

/// Throws InputError for all else that is wrong with a cell (see Constraints). `robot` has the
/// margin applied.
void check_cell(const Cell& cell, const Chain& robot, const std::vector<Vector3d>& targets);

/// The limits of a robot, of joints that the cell fixes their value.
JointRange joint_range(const Chain& robot, const Cell& cell);

/// All that is a body of the robot: the cell's links, then the balls at the targets, if they are
/// balls and the campaign states where they are.
std::vector<Link> bodies_of(const Campaign& campaign, const Cell& cell);

/// Pairs of bodies that may collide. Links: the frames they are fixed to, in order along the chain,
/// are neither the same nor next to each other, so that they share no joint. A ball, which is on
/// the flange, and a link: two joints part them at least.
std::vector<std::pair<std::size_t, std::size_t>> colliding_pairs(const std::vector<Link>& links,
                                                                 const std::vector<Link>& bodies,
                                                                 Index joint_count);

/// How far a unit of each joint moves any point on the axes of the bodies at most: the sum of
/// lengths between the joint and the body's far end.
VectorXd clearance_rates(const Chain& robot, const std::vector<Link>& bodies);

}  // namespace posewise::detail
