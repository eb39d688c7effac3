#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/model/controller.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/planning.hpp"

/// A plan as a robot's controller is sent it: joints in the digits of a program, and the way.
namespace posewise {

/// The plan with every configuration, also vias, at joint values that are whole multiples of
/// `steps` (of each controller joint, rad or m): the nearest ones that keep the joint limits and
/// the cell and show the targets that the pose states, among the two of each joint that are next to
/// the planned value. Measured torques stay. Poses of a choice, which states no way, are put in the
/// order of a short tour, with vias. Throws InputError for a plan of another campaign, a
/// pose without free way, a pose that violates limits or the cell as it is planned or however it is
/// rounded, and where sockets are to be touched, which no program can.
Plan sent_plan(const Plan& plan, const Campaign& campaign, const ControllerJoints& controller,
               const VectorXd& steps);

/// A configuration (rad or m) at whole multiples of `steps` (of each controller joint): the nearest
/// that is not beyond the joint limits and the campaign's joint sums, or no further than
/// `configuration` itself, among the two of each joint that are next to it; if there is none, the
/// nearest. Throws InputError for a step that is not positive.
VectorXd rounded_within_limits(const VectorXd& configuration, const Campaign& campaign,
                               const ControllerJoints& controller, const VectorXd& steps);

/// What rounding costs.
struct RoundingLoss {
    Criterion criterion = Criterion::D;
    double planned = 0;  ///< value of the criterion
    double sent = 0;
    double largest_turn = 0;   ///< by which rounding moved a joint, rad
    double largest_slide = 0;  ///< likewise, m
    /// Predicted RMS position error over the workspace, m; for continuous plans.
    std::optional<double> planned_rms = {};
    std::optional<double> sent_rms = {};
};
/// Compares a continuous plan, made with these options, before and after rounding. Throws
/// InputError as verify().
RoundingLoss rounding_loss(const Plan& plan, const Plan& sent, const Campaign& campaign,
                           const PlanningOptions& options);
/// Compares a choice from configurations that were not measured yet.
RoundingLoss rounding_loss(const Plan& plan, const Plan& sent, const Campaign& campaign,
                           Candidates candidates, const ChoiceOptions& options);

/// The sent plan with one of its poses visited again, as ref1, ref2, ..., after each `every` other
/// poses to calibrate with, and after the last of them: what changes there drifts. The ways to and
/// from these visits are not planned; route_of() finds them if it is asked to. Throws InputError if
/// the plan has no pose to calibrate with of this id, or one that is called like a visit.
Plan with_revisits(const Plan& sent, const std::string& id, Index every);

/// How often a program visits the poses, and in which order.
struct RouteOptions {
    Index repeats = 1;         ///< passes over all poses
    bool is_reversed = false;  ///< every second pass goes back along the way of the one before
    bool finds_ways = false;   ///< where the straight move is not free, instead of refusing it
};

/// One stop on the way.
struct RouteStop {
    enum class Kind { Home, Via, Pose };
    Kind kind = Kind::Pose;
    std::string id;  ///< the pose's; empty for home and vias
    Index times = 1;
    VectorXd configuration;
};

/// The way of a program through a sent plan: home, if the cell has one, then poses and verification
/// poses in the plan's order with their vias, then home. Every move is checked against the cell
/// again, and the way back, which no plan states, is found. Throws InputError for a move that is
/// not free, and for a reversed pass without a home.
std::vector<RouteStop> route_of(const Plan& sent, const Campaign& campaign,
                                const ControllerJoints& controller, const VectorXd& steps,
                                const RouteOptions& options = {});

/// What keeps a robot from taking this way, which perhaps was edited since it was sent: "pose 'p3'
/// is beyond the joint limits (less their margin): q2 is 61 deg, must be from -50 to 60 deg" and
/// the like of joint sums and the cell, targets that poses of the plan are to show and do not, and
/// moves that are not free. Each once. Throws InputError as Constraints.
std::vector<std::string> find_faults(const std::vector<RouteStop>& route, const Campaign& campaign,
                                     const std::optional<Plan>& sent);

}  // namespace posewise
