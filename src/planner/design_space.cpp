#include "design_space.hpp"

#include "../jacobian/pose_information.hpp"

namespace posewise::detail {
DesignSpace make_design_space(const Campaign& campaign, const Parameters& parameters,
                              double repeats, const Constraints* constraints) {
    const auto pose = std::make_shared<PoseInformation>(campaign, parameters, repeats);
    const Chain& robot = constraints == nullptr ? campaign.robot : constraints->robot();
    DesignSpace space;
    space.parameter_count = pose->parameter_count();
    space.parameter_names = parameter_names(campaign);
    space.lower.resize(robot.joint_count());
    space.upper.resize(robot.joint_count());
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
        space.lower[j] = joint.lower;
        space.upper[j] = joint.upper;
    }
    const auto seen = [constraints](const VectorXd& q) {
        return constraints == nullptr ? SeenTargets() : constraints->seen(q);
    };
    space.information = [pose, seen](const VectorXd& q) { return pose->evaluate(q, seen(q)); };
    space.information_gradient = [pose, seen](const VectorXd& q, const MatrixXd& Z) {
        return pose->differentiate(q, Z, seen(q));
    };
    if (constraints == nullptr) return space;
    for (const auto& [joint, value] : constraints->cell().fixed_joints) {
        space.lower[joint] = space.upper[joint] = value;
    }
    space.least_joint_distance = constraints->cell().least_joint_distance;
    space.margin = [constraints](const VectorXd& q) { return constraints->margin(q); };
    return space;
}

}  // namespace posewise::detail
