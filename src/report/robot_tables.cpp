#include "robot_tables.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/format.hpp"
#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

std::string format_terms(const std::vector<JointTerm>& terms, const Chain& robot) {
    std::string text;
    for (const JointTerm& term : terms) {
        const double size = std::abs(term.coefficient);
        if (term.coefficient < 0) {
            text += text.empty() ? "-" : " - ";
        } else if (!text.empty()) {
            text += " + ";
        }
        if (size != 1) text += format_short(size) + ' ';
        text += robot.joints()[static_cast<std::size_t>(term.joint)].name;
    }
    return text;
}

/// "dq2, q2.sin(q2)".
std::string format_parameters(const Element& element) {
    std::string text = element.parameter;
    for (const ErrorTerm& term : element.terms) text += (text.empty() ? "" : ", ") + term.parameter;
    return text;
}

FlangeMotion motion_at_zero(const Chain& robot) {
    FlangeMotion motion;
    robot.differentiate(Isometry3d::Identity(), VectorXd::Zero(robot.configuration_size()),
                        VectorXd::Zero(robot.parameter_count()), motion);
    return motion;
}

}  // namespace

Table element_table(const Chain& robot) {
    Table table{{"no", "transform", "nominal", "", "joint", "error parameter"}, {}};
    for (const Element& element : robot.elements()) {
        const AmountUnits& units = units_of(element.motion);
        table.rows.push_back({std::to_string(table.rows.size() + 1), transform_name(element),
                              format_short(units.to_reading(element.value), 9),
                              std::string(units.reading), format_terms(element.joints, robot),
                              format_parameters(element)});
    }
    return table;
}

Table joint_table(const Chain& robot) {
    Table table{{"joint", "kind", "lower", "upper", ""}, {}};
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joint(j);
        const AmountUnits& units = units_of(joint.motion);
        const auto limit = [&](double value) { return format_short(units.to_reading(value), 6); };
        const char* const kind = joint.motion == Motion::Rotation ? "revolute" : "prismatic";
        table.rows.push_back(
            {joint.name, kind, limit(joint.lower), limit(joint.upper), std::string(units.reading)});
    }
    return table;
}

Table axis_table(const Chain& robot) {
    Table table{{"joint", "axis x", "y", "z", "through x/mm", "y/mm", "z/mm"}, {}};
    const TwistMatrix twists = motion_at_zero(robot).joint_twists;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const bool turns = robot.joint(j).motion == Motion::Rotation;
        const Vector3d axis = turns ? twists.col(j).head<3>() : twists.col(j).tail<3>();
        const Vector3d direction = axis.normalized();
        std::vector<std::string> row{robot.joints()[static_cast<std::size_t>(j)].name};
        for (const double x : direction) row.push_back(format_fixed(x, 6));
        if (turns) {
            // The point of the line nearest to the base: v = p cross w.
            const Vector3d point = axis.cross(twists.col(j).tail<3>()) / axis.squaredNorm();
            for (const double x : point) row.push_back(format_mm(x));
        }
        table.rows.push_back(std::move(row));
    }
    return table;
}

std::string describe_flange_at_zero(const Chain& robot) {
    const Isometry3d flange = motion_at_zero(robot).world_from_flange;
    const Vector3d p = flange.translation();
    const Vector3d rpy = rpy_from_rotation(flange.linear());
    return fmt::format("position {} {} {} mm, roll pitch yaw {} {} {} deg", format_mm(p.x()),
                       format_mm(p.y()), format_mm(p.z()), format_fixed(to_degrees(rpy.x()), 4),
                       format_fixed(to_degrees(rpy.y()), 4), format_fixed(to_degrees(rpy.z()), 4));
}

}  // namespace posewise::detail
