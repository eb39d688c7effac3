#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

/// How the joints that a robot's controller shows and takes follow from the model's:
/// c = from_model * q + offset. Reversed joints, other zeros and couplings: a FANUC's third joint
/// is measured against the ground, J3 = q3 - q2.
class ControllerJoints {
  public:
    /// No joints.
    ControllerJoints() = default;
    /// The model's own joints.
    explicit ControllerJoints(const Chain& robot);
    /// Joint c[i] turns or slides as `robot` has it for joint i. Throws InputError if sizes do not
    /// fit the robot, if a number is not finite, if a row adds a turning joint to a sliding one, if
    /// names are empty or equal, if the matrix is singular (beyond a condition of 1e6), or if
    /// pulses are stated that are not positive.
    ControllerJoints(const Chain& robot, std::vector<std::string> names, MatrixXd from_model,
                     VectorXd offset, VectorXd pulses_per_unit = {});

    Index count() const { return offset_.size(); }
    const std::vector<std::string>& names() const { return names_; }
    Motion motion(Index joint) const { return motions_[static_cast<std::size_t>(joint)]; }
    const MatrixXd& from_model() const { return from_model_; }  ///< joints x joints
    const VectorXd& offset() const { return offset_; }          ///< rad or m
    /// Encoder pulses of each controller joint, per rad or m; empty: not stated.
    const VectorXd& pulses_per_unit() const { return pulses_per_unit_; }
    bool is_identity() const { return from_model_.isIdentity(0) && offset_.isZero(0); }

    /// Both in rad and m. Sizes must be count().
    VectorXd to_controller(const VectorXd& q) const;
    VectorXd to_model(const VectorXd& c) const;

    /// The controller's joints with limits as wide as those of `robot` allow for each.
    std::vector<Joint> limited(const Chain& robot) const;

  private:
    std::vector<std::string> names_;
    std::vector<Motion> motions_;
    MatrixXd from_model_;
    MatrixXd to_model_;
    VectorXd offset_;
    VectorXd pulses_per_unit_;
};

/// A FANUC's joints from those of a model without coupling whose joint 3 turns against joint 2:
/// J3 = q3 - factor q2 with factor -1, 0 or 1 [ros-industrial/fanuc, fanuc_utils.cpp]. Others are
/// the model's. Throws InputError for another factor, for a robot with other than 6 turning joints,
/// and where the axes of joints 2 and 3 are not opposite to each other at zero.
ControllerJoints fanuc_joints(const Chain& robot, int j23_factor);

}  // namespace posewise
