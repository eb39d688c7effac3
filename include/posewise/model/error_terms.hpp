#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise {

/// A weight fixed to a link.
struct Load {
    /// As Chain::base_from_links() counts: 0 is the base, j the link after joint j (from 1),
    /// joint_count() + 1 the flange.
    Index link = 0;
    double mass = 0;                     ///< kg
    Vector3d center = Vector3d::Zero();  ///< centre of mass in the frame of the link, m
};

/// A torque divided by its largest value, with derivatives by the joints.
struct TorqueShare {
    double value = 0;
    VectorXd gradient;  ///< joint_count()
    MatrixXd hessian;   ///< joint_count() square; only from evaluate_twice()
};

/// Gravity on a driven element of a robot with known weights: the torque (or force) along its
/// motion, sum_i m_i g . dc_i, with dc_i the rate of load i's centre of mass. Evaluated at the
/// nominal robot, because its errors change the torque far less than the weights are uncertain.
class GravityTorque {
  public:
    class Arm;

    /// `gravity` is the acceleration in the base frame, m/s^2. Throws InputError for an element
    /// that no joint drives, a link that does not exist, or a mass or centre that is not finite or
    /// is negative.
    GravityTorque(const Chain& chain, std::size_t element, const Vector3d& gravity,
                  std::vector<Load> loads);

    /// A torque on an arm that many torques share, so that its motion is computed once for all.
    /// `driven` is the number of the element among the driven ones. Masses may be negative. Values
    /// are divided by `largest`, whatever it is.
    GravityTorque(std::shared_ptr<const Arm> arm, Index driven, const Vector3d& gravity,
                  const std::vector<Load>& loads, double largest);

    /// Largest magnitude within the joint limits, N m (N), over 1000 random configurations that are
    /// always the same.
    double largest() const { return largest_; }

    /// Whether the torque varies, by more than 1e-6 of what the weights could exert.
    bool varies() const { return varies_; }

    /// The torque at a configuration, divided by largest(). Only the joint values of `q` are used.
    TorqueShare evaluate(const VectorXd& q) const;
    /// Only the value.
    double value(const VectorXd& q) const;
    /// As evaluate(), with second derivatives.
    TorqueShare evaluate_twice(const VectorXd& q) const;

  private:
    /// All weights fixed to one link.
    struct LinkWeight {
        Index link = 0;
        Index moved_by = 0;  ///< number of driven elements, from the base, that move it
        double mass = 0;
        Vector3d moment = Vector3d::Zero();  ///< mass times centre, in the frame of the link
    };

    void weigh(const std::vector<Load>& loads);

    /// The torque in N m (N).
    TorqueShare torque(const VectorXd& q, bool is_twice) const;

    /// Moment of all weights if gravity pulled sideways, N m: the scale for rounding.
    double moment_about_base(const VectorXd& q) const;

    std::shared_ptr<const Arm> arm_;
    Index driven_ = 0;  ///< number of the element among the driven ones
    Vector3d gravity_;
    std::vector<LinkWeight> weights_;
    double largest_ = 1;
    bool varies_ = false;
};

/// Places of the nominal robot's links, and how its driven elements (those that joints drive, and
/// others that bend) move them. Each thread
/// remembers the last configuration.
class GravityTorque::Arm {
  public:
    /// `also`: elements that no joint drives, whose torque is asked for, too.
    explicit Arm(const Chain& chain, const std::vector<std::size_t>& also = {});

    struct Motion {
        FlangeMotion flange;            ///< column 6 + e of its twists: by driven element e
        std::vector<Isometry3d> links;  ///< as Chain::base_from_links()
    };
    /// The motion at the joint values that q begins with; valid until this thread asks any arm
    /// again.
    const Motion& at(const VectorXd& q) const;

    const Chain& chain() const { return chain_; }
    Index joint_count() const { return chain_.joint_count(); }
    Index driven_count() const { return chain_.parameter_count(); }
    /// Number of driven elements up to the first one that joint `link` (from 1) drives.
    Index count_driven(Index link) const;
    /// Number of driven elements before this one of all elements.
    Index count_before(std::size_t element) const;
    /// Driven elements x joints: how much each joint moves each element.
    const MatrixXd& driven_by() const { return driven_by_; }

  private:
    Chain chain_;  ///< each such element has one error parameter, for its motion
    MatrixXd driven_by_;
    std::uint64_t number_;  ///< unique to this arm
};

// Error terms that follow from a robot's axes, and a robot without any.

/// The function in words: "sin(q2-q3)", "cos(2q4)", "lin(q3)" for a linear one. In a sine a slide
/// with a pitch is counted in turns of its drive: "sin(2rail)" has two periods a pitch. The phase
/// is added in rad if it is not that of a sine or cosine.
std::string describe_function(const JointFunction& function, const std::vector<Joint>& joints);

/// The robot with gravity terms for compliant joints: a weight turned by an angle about a level
/// axis pulls with the sine and cosine of that angle. The terms go to the first run of consecutive
/// parallel revolute axes that stay perpendicular to `direction` (gravity in the base frame, of any
/// length) because all joints before them slide, or turn about `direction`; within 1 deg. Add up
/// the run's angles from its first joint to joint k, with the signs of the chain: joint j gets a
/// sine and a cosine of each of these sums for k >= j. A 6R arm on the floor gets 4 on joint 2 and
/// 2 on joint 3, a UR 6, 4 and 2. Parameters are named `q2.sin(q2)`, `q2.cos(q2+q3)`. Only `joints`
/// get terms (indices from 0; empty: all); terms that an element already has are not added. Throws
/// InputError if there is no such run, if a joint is not in it, or for a zero direction.
Chain with_gravity_terms(const Chain& chain, const Vector3d& direction = -Vector3d::UnitZ(),
                         const std::vector<Index>& joints = {});

/// The robot with a compliance on each of `joints` (empty: all on which the weights exert a varying
/// torque or force). Under the torque of gravity on `loads`, with 9.80665 m/s^2 along `direction`
/// in the base frame, a joint deflects in proportion. Parameters are named `q2.compliance`; their
/// value is the joint's deflection (rad or m) under the largest torque within the limits,
/// GravityTorque::largest(). Throws InputError as GravityTorque does, for no load or a zero
/// direction, and for a listed joint whose torque is zero or constant, or that already has a
/// compliance.
Chain with_compliance(const Chain& chain, const std::vector<Load>& loads,
                      const Vector3d& direction = -Vector3d::UnitZ(),
                      const std::vector<Index>& joints = {});

/// The robot with revolute joints that bend under its own weight and its tool's, both unknown: each
/// joint deflects by a sum of torque shapes. A shape is the moment about the joint's axis, with
/// gravity along `direction` in the base frame, of one mass: at the origin of a later joint or the
/// flange (`q2.torque(q3)`), then off the flange along an axis of its frame, by a tenth of extent()
/// (`q2.torque(flange.x)`). What earlier shapes explain over the joint ranges is subtracted; a
/// remainder below 3 % of the joint's largest is dropped. All are scaled so that the joint's
/// largest moment, before subtraction, has the RMS of a sine: their parameters (rad) compare with
/// those of harmonics, and a minor shape has little effect. A joint with constant moments (upright
/// axis) gets none. A slide bends, too, about each axis of its carriage and in proportion to how
/// far it is out of its lower limit, as a beam does: about the middle of what is out
/// (`lift.Rx.torque(q2)`). Throws InputError for a zero direction.
Chain with_torque_shapes(const Chain& chain, const Vector3d& direction = -Vector3d::UnitZ());

/// RMS distance (m) of the flange from its mean within the joint limits: the size of the robot.
double extent(const Chain& chain);

/// The robot with a compliance on each joint whose torque is measured with every configuration;
/// names and meaning are as in with_compliance(). In a configuration the torques follow the joint
/// values, see Chain::torques(). Throws InputError as Chain does.
Chain with_measured_compliance(const Chain& chain, const std::vector<MeasuredTorque>& torques);

/// A compliance of the robot.
struct Compliance {
    Index parameter = 0;  ///< index in the chain
    Index joint = 0;
    double largest = 1;  ///< torque (N m) or force (N) that deflects it by the parameter
};

/// Compliances by with_compliance() and with_measured_compliance(), in parameter order.
std::vector<Compliance> compliances(const Chain& chain);

/// The robot with periodic errors of encoders, gears and the drives of slides. Each of `joints`
/// (empty: all that turn, and slides with a pitch) gets a sine and a cosine for each order, in
/// periods of the error per turn: of order * q for a joint that turns, of order * 2 pi q / pitch
/// for a slide, along which they are lengths (m). Parameters are named `q4.sin(q4)`,
/// `rail.cos(2rail)`. Terms that the joint already has are not added. Throws InputError for a slide
/// without a pitch, or an order that is not positive and finite.
Chain with_harmonics(const Chain& chain, const std::vector<double>& orders,
                     const std::vector<Index>& joints = {});

/// The robot with tilt error motion of its axes [ISO 230-7], from bearings and bending links.
/// Each of `joints` (empty: all revolute ones) is followed by rotations about the two axes
/// perpendicular to its own, each with a sine and a cosine of order * q for each order:
/// `q4.Rx.sin(q4)`, `q4.Ry.cos(2q4)`. Throws InputError for a prismatic joint or an order that is
/// not positive and finite.
Chain with_axis_tilt(const Chain& chain, const std::vector<double>& orders,
                     const std::vector<Index>& joints = {});

/// The robot with the scale of every slide and the ratio of every gear: each axis that joints drive
/// gains its amount, counted from the middle of the limits, times a parameter (`rail.scale` in m/m,
/// `q4.gain` in rad/rad). Axes that only move along with joints of others have their own. Only axes
/// that one of `joints` moves (indices from 0; empty: all).
Chain with_gains(const Chain& chain, const std::vector<Index>& joints = {});

/// Names of the error terms whose parameters are not zero.
std::vector<std::string> active_terms(const Chain& chain, const VectorXd& parameters);

/// The robot without error terms and known terms, nor elements that were there only for them.
Chain without_terms(const Chain& chain);

}  // namespace posewise
