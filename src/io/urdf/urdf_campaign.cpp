#include <fmt/format.h>

#include <filesystem>
#include <numbers>

#include "core/text.hpp"
#include "io/format/json.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/robot_files.hpp"

namespace posewise::io {
namespace {

namespace fs = std::filesystem;

/// The URDF as seen from the folder of the campaign file.
std::string path_from(const std::string& campaign, const std::string& urdf) {
    std::error_code error;
    const fs::path folder = fs::weakly_canonical(fs::absolute(campaign), error).parent_path();
    if (error) return fs::absolute(urdf).string();
    const fs::path target = fs::weakly_canonical(fs::absolute(urdf), error);
    const fs::path relative = error ? fs::path() : target.lexically_relative(folder);
    return relative.empty() ? fs::absolute(urdf).string() : relative.string();
}

/// A text of a URDF as YAML in double quotes, which are those of JSON.
std::string quote_for_yaml(const std::string& text, const std::string& urdf) {
    try {
        return nlohmann::json(text).dump();
    } catch (const nlohmann::json::exception&) {
        throw input_error_at({urdf},
                             "the name '" + detail::escape_controls(text) + "' must be UTF-8");
    }
}

/// Room for a joint that has no limits, until its user states them.
Interval limits_of(const UrdfJoint& joint) {
    if (joint.limits) return *joint.limits;
    if (joint_motion(joint) == Motion::Translation) return {0, 1};
    return {-std::numbers::pi, std::numbers::pi};
}

std::string joint_line(const UrdfJoint& joint) {
    const AmountUnits& units = units_of(joint_motion(joint));
    const Interval limits = limits_of(joint);
    const bool is_continuous = joint.kind == UrdfJointKind::Continuous;
    return fmt::format("    {}: {{limits_{}: [{:.9g}, {:.9g}]}}{}\n", chain_joint_name(joint.name),
                       units.reading, units.to_reading(limits.lower),
                       units.to_reading(limits.upper),
                       !joint.limits   ? "  # FILL IN: none in the URDF"
                       : is_continuous ? "  # continuous in the URDF"
                                       : "");
}

/// A list as YAML has it, in mm.
std::string millimetres_list(const Vector3d& point) {
    const Vector3d mm = mm_per_m * point;
    return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", mm.x(), mm.y(), mm.z());
}

/// The cell, as far as a URDF knows it: the robot's own solids.
std::string cell_text(const UrdfRobot& robot) {
    const UrdfBodies bodies = read_urdf_bodies(robot);
    if (bodies.links.empty() && bodies.skipped.empty()) return "";
    std::vector<std::string> frames{"base"};
    for (const UrdfJoint& joint : robot.joints) {
        if (is_driven(joint)) frames.push_back(chain_joint_name(joint.name));
    }
    std::string text = "\n# FILL IN: obstacles (keep_out), the floor, what the instrument sees.\n";
    text += bodies.links.empty()
                ? "# cell:\n"
                : "cell:\n  links:  # capsules around the URDF's collision shapes\n";
    for (const Link& link : bodies.links) {
        text += fmt::format(
            "    - {{name: {}, after: {}, from_mm: {}, to_mm: {}, radius_mm: {:.6g}}}\n",
            quote_for_yaml(link.name, robot.source.path),
            frames[static_cast<std::size_t>(link.frame)], millimetres_list(link.solid.from),
            millimetres_list(link.solid.to), mm_per_m * link.solid.radius);
    }
    for (const std::string& sentence : bodies.skipped) text += "  # " + sentence + '\n';
    return text;
}

constexpr const char* rest = R"(
sensor:
  kind: points           # the instrument returns the positions of targets fixed to the tip link
  sigma_mm: 0.05         # FILL IN: standard deviation of one coordinate of one reading
  targets: {count: 3}    # FILL IN: how many targets, or where they are expected on the tip link:
                         #   position_mm: [[100, 0, 50], [0, 100, 50], [-80, -80, 60]]

# FILL IN for plans and simulations: where the instrument is expected to see the base link.
# base: {position_mm: [2500, 0, 0], rpy_deg: [0, 0, 180]}

model_error_mm: 0.1      # what a rigid robot cannot express (gears, gravity), at your guess
# spread: {length_mm: 1, angle_mrad: 1}  # expected size of the robot's errors, if not as others have
)";

}  // namespace

std::string make_campaign_text(const UrdfRobot& robot, const std::string& path) {
    UrdfRobot limited = robot;
    for (UrdfJoint& joint : limited.joints) joint.limits = limits_of(joint);
    make_chain(limited);  // throws if there is none
    const fs::path urdf = robot.source.path;
    const auto quoted = [&](const std::string& text) {
        return quote_for_yaml(text, urdf.string());
    };
    std::string text =
        "# A campaign for posewise. What is marked FILL IN is not known from the URDF.\n";
    text += "name: " + quoted(robot.name.empty() ? urdf.stem().string() : robot.name);
    text += "\n\nrobot:\n  urdf: " + quoted(path_from(path, robot.source.path));
    text += "    # a path from the folder of this file\n";
    text += "  base_link: " + quoted(robot.source.base_link) + '\n';
    text += "  tip_link: " + quoted(robot.source.tip_link) + '\n';
    text +=
        "  # Limits of the URDF. FILL IN: narrower ones where the cell needs them.\n  joints:\n";
    for (const UrdfJoint& joint : robot.joints) {
        if (is_driven(joint)) text += joint_line(joint);
    }
    return text + rest + cell_text(robot);
}

}  // namespace posewise::io
