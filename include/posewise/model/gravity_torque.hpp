#pragma once

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
    /// `gravity` is the acceleration in the base frame, m/s^2. Throws InputError for an element
    /// that no joint drives, a link that does not exist, or a mass or centre that is not finite or
    /// is negative.
    GravityTorque(const Chain& chain, std::size_t element, const Vector3d& gravity,
                  std::vector<Load> loads);

    /// Largest magnitude within the joint limits, N m (N): of 1000 random configurations, the same
    /// ones every time.
    double largest() const { return largest_; }

    /// Whether it depends on the configuration, by more than 1e-6 of what the weights could do.
    bool varies() const { return varies_; }

    /// At a configuration (joint values, what follows them does not matter), divided by largest().
    TorqueShare evaluate(const VectorXd& q) const;
    /// The same with the second derivatives.
    TorqueShare evaluate_twice(const VectorXd& q) const;

  private:
    /// The same in N m (N).
    TorqueShare torque(const VectorXd& q, bool is_twice) const;

    /// Of all weights if gravity pulled across: what rounding is measured by, N m.
    double moment_about_base(const VectorXd& q) const;

    Chain chain_;       ///< every driven element has one error parameter, which tells its motion
    Index driven_ = 0;  ///< number of the element among the driven ones
    Vector3d gravity_;
    std::vector<Load> loads_;
    MatrixXd driven_by_;           ///< how much each joint moves each driven element
    std::vector<Index> moved_by_;  ///< of each load, how many of them, from the base, move it
    double largest_ = 1;
    bool varies_ = false;
};

}  // namespace posewise
