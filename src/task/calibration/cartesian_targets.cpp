#include <fmt/format.h>

#include <Eigen/LU>

#include "core/text.hpp"
#include "posewise/calibrator/correction.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/task/correction.hpp"

namespace posewise {
namespace {

std::string describe_joints(const Chain& robot, const VectorXd& q) {
    std::string text;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const AmountUnits& units = units_of(robot.joint(j).motion);
        text += fmt::format("{}{} {:.1f} {}", text.empty() ? "" : ", ", robot.joint(j).name,
                            units.to_reading(q[j]), units.reading);
    }
    return text;
}

VectorXd nominal_configuration(const Campaign& campaign, const CartesianTarget& target,
                               const CartesianFrames& frames) {
    const Chain& robot = campaign.robot;
    const VectorXd& seed = target.seed.size() > 0 ? target.seed : frames.seed;
    if (seed.size() == 0) {
        throw InputError(
            "has no joint values to begin at; `frames.seed` must state joints near those that are "
            "meant");
    }
    InverseOptions options;
    options.is_wanted = target.is_wanted;
    const Isometry3d flange =
        frames.base_from_frame * target.frame_from_tool * frames.flange_from_tool.inverse();
    const InverseSolution solution =
        inverse_kinematics(robot, VectorXd::Zero(robot.parameter_count()), flange, seed, options);
    if (solution.joints.size() == 0) {
        throw InputError(fmt::format(
            "is not reached by the nominal robot within its joint limits{}; are frame and tool "
            "right?",
            target.is_wanted ? " in the configuration that is stated with it" : ""));
    }
    if (solution.rival.size() > 0) {
        throw InputError(fmt::format(
            "is reached at {}, and at {}, which is about as near to the joint values that the "
            "search begins at; `frames.seed` must state joints nearer to those that are meant",
            describe_joints(robot, solution.joints), describe_joints(robot, solution.rival)));
    }
    return solution.joints;
}

InputError target_error(const std::string& id, const std::string& problem) {
    return InputError("target " + detail::quote(id) + ' ' + problem);
}

/// Which of the two sides of a singular pose a configuration is on: of six joints the sign of the
/// determinant of the joint twists.
double side_of(const Chain& robot, const VectorXd& q) {
    if (robot.joint_count() != 6) return 1;
    FlangeMotion motion;
    robot.differentiate(Isometry3d::Identity(), q, VectorXd::Zero(robot.parameter_count()), motion);
    return MatrixXd(motion.joint_twists.leftCols(6)).determinant() < 0 ? -1 : 1;
}

}  // namespace

RowMatrixXd nominal_configurations(const Campaign& campaign,
                                   const std::vector<CartesianTarget>& targets,
                                   const CartesianFrames& frames) {
    RowMatrixXd configurations(std::ssize(targets), campaign.robot.joint_count());
    for (std::size_t k = 0; k < targets.size(); ++k) {
        try {
            configurations.row(static_cast<Index>(k)) =
                nominal_configuration(campaign, targets[k], frames).transpose();
        } catch (const InputError& error) {
            throw target_error(targets[k].id, error.what());
        }
    }
    return configurations;
}

std::vector<Isometry3d> corrected_targets(const CorrectedPoses& corrected,
                                          const CartesianFrames& frames) {
    const Chain& robot = corrected.robot;
    const VectorXd no_errors = VectorXd::Zero(robot.parameter_count());
    std::vector<Isometry3d> targets;
    for (std::size_t k = 0; k < corrected.corrections.size(); ++k) {
        const VectorXd& q = corrected.corrections[k].joints;
        const VectorXd nominal = corrected.nominal.row(static_cast<Index>(k)).transpose();
        if (side_of(robot, q) != side_of(robot, nominal)) {
            throw target_error(
                corrected.ids[k],
                "is at a singular pose, where its configuration would change; must be "
                "moved away, or be stated by joint values");
        }
        targets.push_back(frames.base_from_frame.inverse() * robot.base_from_flange(q, no_errors) *
                          frames.flange_from_tool);
    }
    return targets;
}

}  // namespace posewise
