#include "posewise/model/controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/decompositions.hpp"
#include "joint_limits.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr double largest_condition = 1e6;

std::vector<std::string> names_of(const Chain& robot) {
    std::vector<std::string> names;
    for (const Joint& joint : robot.joints()) names.push_back(joint.name);
    return names;
}

void check_names(const std::vector<std::string>& names) {
    std::set<std::string> known;
    for (const std::string& name : names) {
        if (name.empty()) throw InputError("a controller joint has no name; must have one");
        if (!known.insert(name).second) {
            throw InputError(fmt::format("controller joint '{}' occurs twice; must be once", name));
        }
    }
}

/// What turns is no sum with what slides.
void check_motions(const Chain& robot, const MatrixXd& from_model) {
    for (Index i = 0; i < from_model.rows(); ++i) {
        for (Index j = 0; j < from_model.cols(); ++j) {
            if (from_model(i, j) == 0 || robot.joint(i).motion == robot.joint(j).motion) continue;
            throw InputError(fmt::format(
                "controller joint {} adds '{}', which {}; must {}", i + 1, robot.joint(j).name,
                robot.joint(j).motion == Motion::Rotation ? "turns" : "slides",
                robot.joint(i).motion == Motion::Rotation ? "turn" : "slide"));
        }
    }
}

/// The inverse; rows are scaled first, which a controller's units do.
MatrixXd checked_inverse_of(const MatrixXd& matrix) {
    const VectorXd values = detail::singular_values_of(matrix);
    if (values.size() > 0 && !(values[values.size() - 1] * largest_condition >= values[0])) {
        throw InputError(
            "the controller's joints do not tell the model's: their matrix is singular; must be "
            "independent sums");
    }
    return detail::inverse_of(matrix);
}

/// Direction of a joint's axis in the base frame with all joints at zero.
Vector3d axis_at_zero(const Chain& robot, Index joint) {
    FlangeMotion motion;
    robot.differentiate(Isometry3d::Identity(), VectorXd::Zero(robot.configuration_size()),
                        VectorXd::Zero(robot.parameter_count()), motion);
    return motion.joint_twists.col(joint).head<3>();
}

}  // namespace

ControllerJoints::ControllerJoints(const Chain& robot)
    : ControllerJoints(robot, names_of(robot),
                       MatrixXd::Identity(robot.joint_count(), robot.joint_count()),
                       VectorXd::Zero(robot.joint_count())) {}

ControllerJoints::ControllerJoints(const Chain& robot, std::vector<std::string> names,
                                   MatrixXd from_model, VectorXd offset, VectorXd pulses_per_unit)
    : names_(std::move(names)),
      from_model_(std::move(from_model)),
      offset_(std::move(offset)),
      pulses_per_unit_(std::move(pulses_per_unit)) {
    const Index n = robot.joint_count();
    if (static_cast<Index>(names_.size()) != n || from_model_.rows() != n ||
        from_model_.cols() != n || offset_.size() != n ||
        (pulses_per_unit_.size() != 0 && pulses_per_unit_.size() != n)) {
        throw InputError(fmt::format("the controller's joints must be {}, as the robot's", n));
    }
    if (!from_model_.allFinite() || !offset_.allFinite()) {
        throw InputError("a number of the controller's joints is not finite");
    }
    if (pulses_per_unit_.size() != 0 &&
        !(pulses_per_unit_.minCoeff() > 0 && pulses_per_unit_.allFinite())) {
        throw InputError("pulses of a controller joint are not positive; a reversed joint is -q");
    }
    check_names(names_);
    check_motions(robot, from_model_);
    to_model_ = checked_inverse_of(from_model_);
    for (const Joint& joint : robot.joints()) motions_.push_back(joint.motion);
}

VectorXd ControllerJoints::to_controller(const VectorXd& q) const {
    return from_model_ * q + offset_;
}

VectorXd ControllerJoints::to_model(const VectorXd& c) const { return to_model_ * (c - offset_); }

std::vector<Joint> ControllerJoints::limited(const Chain& robot) const {
    const auto [lower, upper] = detail::limits_of(robot);
    const VectorXd middle = to_controller((lower + upper) / 2);
    const VectorXd reach = from_model_.cwiseAbs() * (upper - lower) / 2;
    std::vector<Joint> joints = robot.joints();
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const auto joint = static_cast<Index>(i);
        joints[i].name = names_[i];
        joints[i].lower = middle[joint] - reach[joint];
        joints[i].upper = middle[joint] + reach[joint];
    }
    return joints;
}

ControllerJoints fanuc_joints(const Chain& robot, int j23_factor) {
    constexpr Index joints = 6;
    if (j23_factor < -1 || j23_factor > 1) {
        throw InputError(fmt::format("j23_factor is {}; must be -1, 0 or 1", j23_factor));
    }
    if (robot.joint_count() != joints || !std::ranges::all_of(robot.joints(), [](const Joint& one) {
            return one.motion == Motion::Rotation;
        })) {
        throw InputError(
            "maker fanuc is known of robots with 6 joints that turn; state the controller's joints "
            "instead");
    }
    const double along = axis_at_zero(robot, 1).dot(axis_at_zero(robot, 2));
    if (!(along < -0.99)) {
        throw InputError(
            "maker fanuc is known of models whose joint 3 turns about the opposite of joint 2's "
            "axis, as FANUC's own URDFs have it; state the controller's joints instead, like J3: "
            "-q3 - q2");
    }
    MatrixXd from_model = MatrixXd::Identity(joints, joints);
    from_model(2, 1) = -j23_factor;
    return {robot, {"J1", "J2", "J3", "J4", "J5", "J6"}, from_model, VectorXd::Zero(joints)};
}

}  // namespace posewise
