#include "posewise/model/joint_limits.hpp"

#include <fmt/format.h>

#include <numbers>

namespace posewise {

std::string describe_limit_violation(const Chain& robot, const VectorXd& q) {
    constexpr double rounding = 1e-6;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
        if (q[j] >= joint.lower - rounding && q[j] <= joint.upper + rounding) continue;
        const bool turns = robot.joint_motion(j) == Motion::Rotation;
        const double factor = turns ? 180 / std::numbers::pi : 1e3;
        return fmt::format("{} is {:.7g} {unit}, must be from {:.7g} to {:.7g} {unit}", joint.name,
                           factor * q[j], factor * joint.lower, factor * joint.upper,
                           fmt::arg("unit", turns ? "deg" : "mm"));
    }
    return "";
}

}  // namespace posewise
