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

std::string describe_range(const std::string& name, Motion motion, double value, double lower,
                           double upper) {
    const AmountUnits& units = units_of(motion);
    return fmt::format("{} is {:.9g} {unit}, must be from {:.9g} to {:.9g} {unit}", name,
                       units.to_reading(value), units.to_reading(lower), units.to_reading(upper),
                       fmt::arg("unit", units.reading));
}

std::string describe_limit_violation(const Chain& robot, const VectorXd& q) {
    constexpr double rounding = 1e-6;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joint(j);
        if (q[j] >= joint.lower - rounding && q[j] <= joint.upper + rounding) continue;
        return describe_range(joint.name, joint.motion, q[j], joint.lower, joint.upper);
    }
    return "";
}

}  // namespace posewise::detail
