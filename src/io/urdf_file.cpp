#include "posewise/io/urdf_file.hpp"

#include <algorithm>

#include "posewise/model/transforms.hpp"
#include "robot_parts.hpp"
#include "text.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using pugi::xml_node;

void check_joint_count(const UrdfRobot& robot) {
    const auto count = static_cast<std::size_t>(
        std::count_if(robot.joints.begin(), robot.joints.end(),
                      [](const UrdfJoint& joint) { return joint.kind != UrdfJointKind::Fixed; }));
    const std::string ends = "base link " + quote(robot.source.base_link) + " and tip link " +
                             quote(robot.source.tip_link);
    if (count == 0) {
        throw input_error_at({robot.source.path}, "has no joint that moves between " + ends);
    }
    if (count > most_joints || robot.joints.size() > most_elements) {
        throw input_error_at({robot.source.path}, "has " + std::to_string(robot.joints.size()) +
                                                      " joints between " + ends +
                                                      "; at most 100 of them may move");
    }
}

}  // namespace

UrdfRobot read_urdf(const UrdfSource& source) {
    const XmlDocument document(source.path);
    const UrdfPath path = find_path(document, source);
    UrdfRobot robot;
    robot.source = path.source;
    robot.name = escape_controls(document.root().attribute("name").value());
    for (const xml_node joint : path.joints) {
        robot.joints.push_back(read_urdf_joint(document, joint));
    }
    check_joint_count(robot);
    return robot;
}

Motion joint_motion(const UrdfJoint& joint) {
    return joint.kind == UrdfJointKind::Prismatic ? Motion::Translation : Motion::Rotation;
}

std::string chain_joint_name(const std::string& urdf_name) {
    std::string name;
    for (const char c : urdf_name) {
        name += is_identifier('_' + std::string(1, c)) ? c : '_';
    }
    return is_identifier(name) ? name : '_' + name;
}

Chain make_chain(const UrdfRobot& robot) {
    std::vector<Joint> joints;
    std::vector<Element> elements;
    const auto append = [&](const std::vector<Element>& more) {
        elements.insert(elements.end(), more.begin(), more.end());
    };
    for (const UrdfJoint& joint : robot.joints) {
        append(origin_elements(joint.xyz, joint.rpy));
        if (joint.kind == UrdfJointKind::Fixed) continue;
        append(joint_elements(joint_motion(joint), joint.axis, static_cast<Index>(joints.size())));
        if (!joint.limits) {
            throw input_error_at(joint.location,
                                 "joint " + quote(joint.name) +
                                     " has no limits that leave it room; must have, here or in a "
                                     "campaign under robot.joints");
        }
        joints.push_back({chain_joint_name(joint.name), joint.limits->lower, joint.limits->upper});
    }
    try {
        return Chain(std::move(joints), std::move(elements));
    } catch (const InputError& problem) {
        throw input_error_at({robot.source.path}, problem.what());
    }
}

VectorXd joint_speeds(const UrdfRobot& robot) {
    std::vector<double> speeds;
    for (const UrdfJoint& joint : robot.joints) {
        if (joint.kind == UrdfJointKind::Fixed) continue;
        if (joint.speed == 0) return {};
        speeds.push_back(joint.speed);
    }
    return Eigen::Map<const VectorXd>(speeds.data(), static_cast<Index>(speeds.size()));
}

}  // namespace posewise::io
