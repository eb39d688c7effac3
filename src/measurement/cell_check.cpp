#include "cell_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/elementary.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

void require(bool is_met, const std::string& problem) {
    if (!is_met) throw InputError("cell: " + problem);
}

void check_interval(const Interval& interval, const char* name) {
    require(interval.lower <= interval.upper,
            fmt::format("tracker.{} is {:g} to {:g} (m or rad); the lower end must come first",
                        name, interval.lower, interval.upper));
}

bool is_direction(const Vector3d& normal) { return std::abs(normal.norm() - 1) < 1e-9; }

constexpr double upright = std::numbers::pi / 2 * (1 + 1e-12);
constexpr const char* elevation_rule =
    "tracker.elevation must lie from -90 to 90 deg: straight down to straight up";

void check_sight(const Sight& sight, std::size_t target_count) {
    check_interval(sight.range, "range");
    check_interval(sight.azimuth, "azimuth");
    check_interval(sight.elevation, "elevation");
    require(std::abs(sight.elevation.lower) <= upright || std::isinf(sight.elevation.lower),
            elevation_rule);
    require(std::abs(sight.elevation.upper) <= upright || std::isinf(sight.elevation.upper),
            elevation_rule);
    const bool is_turn = std::isinf(sight.azimuth.upper - sight.azimuth.lower) ||
                         sight.azimuth.upper - sight.azimuth.lower <= 2 * std::numbers::pi + 1e-9;
    require(is_turn, "tracker.azimuth is wider than a full turn");
    require(
        sight.acceptance_half_angle > 0 && sight.acceptance_half_angle <= std::numbers::pi,
        fmt::format("reflectors.acceptance_half_angle is {:g} rad, must be above 0 and at most pi",
                    sight.acceptance_half_angle));
    require(sight.normals.empty() || sight.normals.size() == target_count,
            "reflectors.normals are " + std::to_string(sight.normals.size()) + ", must be " +
                std::to_string(target_count) + ", one a target");
    require(std::all_of(sight.normals.begin(), sight.normals.end(), is_direction),
            "reflectors.normals must have length 1");
    const Index most = static_cast<Index>(target_count);
    const Index needed = sight.least_visible.value_or(most);
    require(needed >= 0 && needed <= most, "reflectors.at_least_visible is " +
                                               std::to_string(needed) + ", must be from 0 to " +
                                               std::to_string(most) + ", the number of targets");
}

void check_links(const Cell& cell, const Chain& robot, const std::vector<Vector3d>& targets) {
    for (const Link& link : cell.links) {
        check_shape(link.solid);
        require(link.frame >= 0 && link.frame <= robot.joint_count() + 1,
                "link '" + link.name + "' is fixed to frame " + std::to_string(link.frame) +
                    ", must be from 0 (base) to " + std::to_string(robot.joint_count() + 1) +
                    " (flange)");
        if (!cell.sight || !cell.sight->is_line_required) continue;
        if (link.frame != robot.joint_count() + 1) continue;
        for (std::size_t j = 0; j < targets.size(); ++j) {
            require(!contains(link.solid, targets[j]),
                    "target " + std::to_string(j + 1) + " lies within link '" + link.name +
                        "', so it can never be seen; make the link smaller");
        }
    }
}

void check_fixed(const Cell& cell, const Chain& robot) {
    for (const auto& [index, value] : cell.fixed_joints) {
        require(index >= 0 && index < robot.joint_count(),
                "fixed joint index " + std::to_string(index) + " is none of the robot's " +
                    std::to_string(robot.joint_count()) + " joints");
        const Joint& joint = robot.joints()[static_cast<std::size_t>(index)];
        require(value >= joint.lower && value <= joint.upper,
                fmt::format("fixed joint '{}' is {:g}, must lie within its limits and margin, {:g} "
                            "to {:g} (rad or m)",
                            joint.name, value, joint.lower, joint.upper));
    }
}

void check_sums(const Cell& cell, const Chain& robot) {
    for (const JointSum& sum : cell.joint_sums) {
        require(sum.coefficients.size() == robot.joint_count() && sum.coefficients.allFinite() &&
                    !sum.coefficients.isZero(0),
                "joint sum '" + sum.name + "' must have one finite coefficient a joint, not all 0");
        const Motion motion = motion_of(sum, robot);
        for (Index j = 0; j < robot.joint_count(); ++j) {
            require(sum.coefficients[j] == 0 || robot.joint(j).motion == motion,
                    "joint sum '" + sum.name + "' adds a joint that turns to one that slides");
        }
        const Interval limits = within_margin(sum, cell, robot);
        require(limits.lower < limits.upper, "the limits of joint sum '" + sum.name +
                                                 "' must be in order, and wider than the margin");
    }
}

void check_motion(const Cell& cell, const Chain& robot) {
    const Index joints = robot.joint_count();
    require(cell.acceleration.size() == 0 ||
                (cell.acceleration.size() == joints && cell.acceleration.allFinite() &&
                 (cell.acceleration.array() > 0).all()),
            "acceleration must have one positive value a joint");
    require(cell.home.size() == 0 || (cell.home.size() == joints && cell.home.allFinite()),
            "home must have one finite value a joint");
    require(cell.speed.size() == 0 || (cell.speed.size() == joints && cell.speed.allFinite() &&
                                       (cell.speed.array() > 0).all()),
            "speed must have one positive value a joint");
}

/// Length of the arm up to the frame right after each element (index + 1; 0 is the base):
/// translations, prismatic ones at their longest.
std::vector<double> lengths_along(const Chain& robot) {
    std::vector<double> lengths{0};
    for (const Element& element : robot.elements()) {
        double length = 0;
        if (element.motion == Motion::Translation) {
            length = std::abs(element.value);
            for (const JointTerm& term : element.joints) {
                const Joint& joint = robot.joints()[static_cast<std::size_t>(term.joint)];
                length += std::abs(term.coefficient) *
                          std::max(std::abs(joint.lower), std::abs(joint.upper));
            }
        }
        lengths.push_back(lengths.back() + length);
    }
    return lengths;
}

/// Number of elements in front of a frame of Chain::base_from_links().
std::size_t elements_before(const Chain& robot, Index frame) {
    if (frame == 0) return 0;
    const auto drives = [frame](const Element& element) {
        return std::any_of(element.joints.begin(), element.joints.end(),
                           [frame](const JointTerm& term) { return term.joint == frame - 1; });
    };
    const auto& elements = robot.elements();
    if (frame > robot.joint_count()) return elements.size();
    return static_cast<std::size_t>(std::find_if(elements.begin(), elements.end(), drives) -
                                    elements.begin()) +
           1;
}

}  // namespace

double interval_clearance(const Interval& interval, double value) {
    return std::min(value - interval.lower, interval.upper - value);
}

std::string describe_sums(const Cell& cell, const Chain& robot, const VectorXd& q) {
    double least = -pose_rounding;
    std::string text;
    for (const JointSum& sum : cell.joint_sums) {
        const double amount = sum.amount(q);
        const Interval limits = within_margin(sum, cell, robot);
        const double clearance = interval_clearance(limits, amount);
        if (!(clearance < least)) continue;
        least = clearance;
        text = describe_range(sum.name, motion_of(sum, robot), amount + sum.offset,
                              limits.lower + sum.offset, limits.upper + sum.offset);
    }
    return text;
}

double angle_between(const Vector3d& a, const Vector3d& b) {
    return arc_tangent(a.cross(b).norm(), a.dot(b));
}

Sighting sighting_of(const Vector3d& point) {
    return {arc_tangent(point.y(), point.x()), arc_tangent(point.z(), point.head<2>().norm())};
}

Motion motion_of(const JointSum& sum, const Chain& robot) {
    Index joint = 0;
    sum.coefficients.cwiseAbs().maxCoeff(&joint);
    return robot.joint(joint).motion;
}

Interval within_margin(const JointSum& sum, const Cell& cell, const Chain& robot) {
    const JointMargin& margin = cell.limit_margin;
    const double kept = motion_of(sum, robot) == Motion::Rotation ? margin.angle : margin.length;
    return {sum.limits.lower + kept, sum.limits.upper - kept};
}

std::vector<Vector3d> nominal_targets(const Campaign& campaign, const Cell& cell) {
    if (cell.sight || !cell.target_boxes.empty()) {
        require(campaign.has_nominal_targets,
                "sight and target_boxes need to know where the targets are; the sensor must state "
                "targets.position_mm");
        require(!cell.sight || campaign.has_nominal_base,
                "sight needs to know where the tracker is; the campaign must state its base");
    }
    std::vector<Vector3d> targets;
    if (!campaign.has_nominal_targets) return targets;
    for (Index j = 0; j < campaign.sensor->target_count(); ++j) {
        targets.push_back(campaign.sensor->target_position(j, campaign.nominal.sensor));
    }
    return targets;
}

void check_cell(const Cell& cell, const Chain& robot, const std::vector<Vector3d>& targets) {
    for (const Box& box : cell.target_boxes) check_shape(box);
    for (const KeepOut& keep_out : cell.keep_outs) check_shape(keep_out.solid);
    check_links(cell, robot, targets);
    require(std::isfinite(cell.safety_distance) && cell.safety_distance >= 0,
            fmt::format("safety_distance is {:g} m, must be finite and not negative",
                        cell.safety_distance));
    require(std::isfinite(cell.least_joint_distance) && cell.least_joint_distance >= 0,
            fmt::format("least_joint_distance is {:g} rad or m, must be finite and not negative",
                        cell.least_joint_distance));
    if (cell.sight) check_sight(*cell.sight, targets.size());
    check_sums(cell, robot);
    check_fixed(cell, robot);
    check_motion(cell, robot);
}

JointRange joint_range(const Chain& robot, const Cell& cell) {
    JointRange range = limits_of(robot);
    for (const auto& [joint, value] : cell.fixed_joints) {
        range.lower[joint] = range.upper[joint] = value;
    }
    return range;
}

std::vector<Link> bodies_of(const Campaign& campaign, const Cell& cell) {
    std::vector<Link> bodies = cell.links;
    const std::optional<double> radius = campaign.sensor->target_radius();
    if (!radius || !campaign.has_nominal_targets) return bodies;
    const Targets& targets = campaign.sensor->targets();
    const Index flange = campaign.robot.joint_count() + 1;
    for (Index k = 0; k < targets.count(); ++k) {
        const Vector3d center = targets.position(k, campaign.nominal.sensor);
        bodies.push_back({"target " + std::to_string(k + 1), flange, {center, center, *radius}});
    }
    return bodies;
}

std::vector<std::pair<std::size_t, std::size_t>> colliding_pairs(const std::vector<Link>& links,
                                                                 const std::vector<Link>& bodies,
                                                                 Index joint_count) {
    std::set<Index> frames;
    for (const Link& link : links) frames.insert(link.frame);
    const auto rank = [&frames](const Link& link) {
        return std::distance(frames.begin(), frames.find(link.frame));
    };
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (std::size_t j = 0; j < links.size(); ++j) {
        for (std::size_t i = 0; i < j; ++i) {
            if (std::abs(rank(links[i]) - rank(links[j])) > 1) pairs.emplace_back(i, j);
        }
    }
    for (std::size_t ball = links.size(); ball < bodies.size(); ++ball) {
        for (std::size_t i = 0; i < links.size(); ++i) {
            if (links[i].frame <= joint_count - 2) pairs.emplace_back(i, ball);
        }
    }
    return pairs;
}

VectorXd clearance_rates(const Chain& robot, const std::vector<Link>& bodies) {
    const std::vector<double> lengths = lengths_along(robot);
    VectorXd rates = VectorXd::Zero(robot.joint_count());
    for (const Link& link : bodies) {
        if (link.frame < 0 || link.frame > robot.joint_count() + 1) continue;  // check_cell() tells
        const std::size_t end = elements_before(robot, link.frame);
        const double reach = std::max(link.solid.from.norm(), link.solid.to.norm());
        VectorXd of_link = VectorXd::Zero(robot.joint_count());
        for (std::size_t k = 0; k < end; ++k) {
            const Element& element = robot.elements()[k];
            const bool turns = element.motion == Motion::Rotation;
            const double lever = turns ? lengths[end] - lengths[k] + reach : 1;
            for (const JointTerm& term : element.joints) {
                of_link[term.joint] += std::abs(term.coefficient) * lever;
            }
        }
        rates = rates.cwiseMax(of_link);
    }
    return rates;
}

}  // namespace posewise::detail
