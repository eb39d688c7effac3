#include "joint_limits.hpp"

#include <fmt/format.h>

namespace posewise::detail {

JointRange limits_of(const Chain& robot) {
    JointRange range{VectorXd(robot.joint_count()), VectorXd(robot.joint_count())};
    for (Index j = 0; j < robot.joint_count(); ++j) {
        range.lower[j] = robot.joint(j).lower;
        range.upper[j] = robot.joint(j).upper;
    }
    return range;
}

std::string describe_limit_violation(const Chain& robot, const VectorXd& q) {
    constexpr double rounding = 1e-6;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joint(j);
        if (q[j] >= joint.lower - rounding && q[j] <= joint.upper + rounding) continue;
        const AmountUnits& units = units_of(joint.motion);
        return fmt::format("{} is {:.7g} {unit}, must be from {:.7g} to {:.7g} {unit}", joint.name,
                           units.to_reading(q[j]), units.to_reading(joint.lower),
                           units.to_reading(joint.upper), fmt::arg("unit", units.reading));
    }
    return "";
}

}  // namespace posewise::detail
