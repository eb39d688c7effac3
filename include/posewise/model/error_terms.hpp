#pragma once

#include <string>
#include <vector>

#include "posewise/model/chain.hpp"
#include "posewise/model/gravity_torque.hpp"

/// Error terms that every robot of a kind has, made from its axes; and a robot without any.
namespace posewise {

/// The function in words: "sin(q2-q3)", "cos(2q4)", "lin(q3)" for a linear one, with the phase in
/// rad if it has another than those of sine and cosine.
std::string describe_function(const JointFunction& function, const std::vector<Joint>& joints);

/// The robot with the gravity terms of compliant joints: a weight turned by an angle about a level
/// axis pulls with the sine and cosine of that angle. Concerned are the joints of the first run of
/// consecutive parallel revolute axes that stay perpendicular to `direction` (gravity in the base
/// frame, of any length), because all joints before them slide or turn about `direction`; within
/// 1 deg. With the run's angles added up from its first joint to joint k, signs as the chain turns,
/// joint j gets a sine and a cosine of each of these sums from k = j on: a 6R arm on the floor 4 on
/// joint 2 and 2 on joint 3, a UR 6, 4 and 2. Parameters are named `q2.sin(q2)`, `q2.cos(q2+q3)`.
/// Only `joints` get terms (indices from 0; empty: all); one that an element has already is not
/// added. Throws InputError if there is no such run, if a joint is not in it, or for a zero
/// direction.
Chain with_gravity_terms(const Chain& chain, const Vector3d& direction = -Vector3d::UnitZ(),
                         const std::vector<Index>& joints = {});

/// The robot with a compliance on each of `joints` (empty: all that the weights turn or push, and
/// not always alike): under the torque of gravity on `loads`, which acts in `direction` of the base
/// frame with 9.80665 m/s^2, a joint gives way in proportion. Parameters are named `q2.compliance`
/// and are the joint's yielding (rad or m) under the largest torque that occurs within the limits,
/// GravityTorque::largest(). Throws InputError as GravityTorque does, for no load or a zero
/// direction, and for a joint listed that has no torque, always the same one or already a
/// compliance.
Chain with_compliance(const Chain& chain, const std::vector<Load>& loads,
                      const Vector3d& direction = -Vector3d::UnitZ(),
                      const std::vector<Index>& joints = {});

/// The robot with the shapes of the torque that its own weight and its tool's, neither known, put
/// on every joint that turns: it gives way by a sum of them. A shape is the moment about the
/// joint's axis, with gravity in `direction` of the base frame, of a mass at the origin of a later
/// joint or of the flange (`q2.torque(q3)`), then of one beside the flange along an axis of its
/// frame, as far as a tenth of extent() (`q2.torque(flange.x)`), less what the shapes before it
/// explain over the joints' ranges; what is left below 3 % of the joint's largest is dropped. All
/// are divided so that the joint's largest moment, before anything is taken off, has the RMS of a
/// sine: parameters in rad compare with those of harmonics, and a shape that can do little has
/// little effect. A joint whose moments are always the same (upright axes) gets none. Throws
/// InputError for a zero direction.
Chain with_torque_shapes(const Chain& chain, const Vector3d& direction = -Vector3d::UnitZ());

/// RMS distance (m) of the flange from its mean within the joint limits: how large the robot is.
double extent(const Chain& chain);

/// The robot with a compliance, named and meant as those of with_compliance(), on each joint whose
/// torque is measured with every configuration; these numbers follow its joint values, see
/// Chain::torques(). Throws InputError as Chain does.
Chain with_measured_compliance(const Chain& chain, const std::vector<MeasuredTorque>& torques);

/// A compliance of the robot.
struct Compliance {
    Index parameter = 0;  ///< of the chain
    Index joint = 0;
    double largest = 1;  ///< torque (N m) or force (N) at which the parameter is what gives way
};

/// Those of with_compliance() and with_measured_compliance(), in the order of the parameters.
std::vector<Compliance> compliances(const Chain& chain);

/// The robot with periodic errors of encoders and gears: on each of `joints` (empty: all revolute
/// ones) a sine and a cosine of order * q for each order, in turns of the error per turn of the
/// joint: `q4.sin(q4)`, `q4.cos(2q4)`. Those that the joint has already are not added. Throws
/// InputError for a prismatic joint or an order that is not positive and finite.
Chain with_harmonics(const Chain& chain, const std::vector<double>& orders,
                     const std::vector<Index>& joints = {});

/// The robot with the tilt error motion of axes [ISO 230-7], of bearings and of links that bend:
/// after each of `joints` (empty: all revolute ones) rotations about the two axes perpendicular to
/// its own, each with a sine and a cosine of order * q for each order: `q4.Rx.sin(q4)`,
/// `q4.Ry.cos(2q4)`. Throws InputError as with_harmonics() does.
Chain with_axis_tilt(const Chain& chain, const std::vector<double>& orders,
                     const std::vector<Index>& joints = {});

/// Names of the error terms whose parameters are not zero.
std::vector<std::string> active_terms(const Chain& chain, const VectorXd& parameters);

/// The robot with nothing that depends on the configuration but its joints.
Chain without_terms(const Chain& chain);

}  // namespace posewise
