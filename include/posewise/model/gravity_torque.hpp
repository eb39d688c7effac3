#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise {

/// A weight fixed to a link.
struct Load {
    Index link = 0;   ///< 0: the base, j: the link behind joint j (from 1), joint_count() + 1: the
                      ///< flange, as Chain::base_from_links() counts
    double mass = 0;  ///< kg
    Vector3d center = Vector3d::Zero();  ///< centre of mass in the frame of the link, m
};

/// A torque as a share of its largest, with its derivatives by the joints.
struct TorqueShare {
    double value = 0;
    VectorXd gradient;  ///< joint_count()
    MatrixXd hessian;   ///< joint_count() square; of evaluate_twice() only
};

/// What known weights do to one of a robot's driven elements: the torque (or force) of gravity in
/// the direction of its motion, sum_i m_i g . dc_i, with dc_i the rate of load i's centre of mass.
/// Taken at the nominal robot: its errors change the torque by far less than the weights are known
/// to.
class GravityTorque {
  public:
    class Arm;

    /// `gravity` is the acceleration in the base frame, m/s^2. Throws InputError for an element
    /// that no joint drives, a link that does not exist, or a mass or centre that is not finite or
    /// is negative.
    GravityTorque(const Chain& chain, std::size_t element, const Vector3d& gravity,
                  std::vector<Load> loads);

    /// The same of an arm that many torques share, so that its motion is found once for all of
    /// them; `driven` is the number of the element among the driven ones, masses may be negative,
    /// and values are shares of `largest`, whatever that is.
    GravityTorque(std::shared_ptr<const Arm> arm, Index driven, const Vector3d& gravity,
                  const std::vector<Load>& loads, double largest);

    /// Largest magnitude within the joint limits, N m (N): of 1000 random configurations, the same
    /// ones every time.
    double largest() const { return largest_; }

    /// Whether it depends on the configuration, by more than 1e-6 of what the weights could do.
    bool varies() const { return varies_; }

    /// At a configuration (joint values, what follows them does not matter), divided by largest().
    TorqueShare evaluate(const VectorXd& q) const;
    /// The value alone.
    double value(const VectorXd& q) const;
    /// The same with the second derivatives.
    TorqueShare evaluate_twice(const VectorXd& q) const;

  private:
    /// All that is fixed to one link.
    struct LinkWeight {
        Index link = 0;
        Index moved_by = 0;  ///< how many of the driven elements, from the base, move it
        double mass = 0;
        Vector3d moment = Vector3d::Zero();  ///< mass times centre, in the frame of the link
    };

    void weigh(const std::vector<Load>& loads);

    /// The same in N m (N).
    TorqueShare torque(const VectorXd& q, bool is_twice) const;

    /// Of all weights if gravity pulled across: what rounding is measured by, N m.
    double moment_about_base(const VectorXd& q) const;

    std::shared_ptr<const Arm> arm_;
    Index driven_ = 0;  ///< number of the element among the driven ones
    Vector3d gravity_;
    std::vector<LinkWeight> weights_;
    double largest_ = 1;
    bool varies_ = false;
};

/// Where the links of the nominal robot are and how its driven elements move them. The last
/// configuration asked for is remembered, by each thread.
class GravityTorque::Arm {
  public:
    explicit Arm(const Chain& chain);

    struct Motion {
        FlangeMotion flange;            ///< column 6 + e of its twists: by driven element e
        std::vector<Isometry3d> links;  ///< as Chain::base_from_links()
    };
    /// At the joint values that q begins with; valid until this thread asks again, of any arm.
    const Motion& at(const VectorXd& q) const;

    const Chain& chain() const { return chain_; }
    Index joint_count() const { return chain_.joint_count(); }
    Index driven_count() const { return chain_.parameter_count(); }
    /// How many driven elements are up to the first one that joint `link` (from 1) drives.
    Index count_driven(Index link) const;
    /// Driven elements x joints: how much each joint moves each of them.
    const MatrixXd& driven_by() const { return driven_by_; }

  private:
    Chain chain_;  ///< every driven element has one error parameter, which tells its motion
    MatrixXd driven_by_;
    std::uint64_t number_;  ///< no other arm has it
};

}  // namespace posewise
