#include <algorithm>

#include "io/campaign/robot_parts.hpp"
#include "io/format/text.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/model/chain.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using pugi::xml_node;

constexpr const char* no_limits =
    " has no limits that leave it room; must have, here or in a campaign under robot.joints";

std::string ends_of(const UrdfSource& source) {
    return "base link " + quote(source.base_link) + " and tip link " + quote(source.tip_link);
}

[[noreturn]] void refuse_so_many(const UrdfSource& source, std::size_t count, const char* rule) {
    throw input_error_at({source.path}, "has " + std::to_string(count) + " joints between " +
                                            ends_of(source) + "; " + rule);
}

/// The joint of the chain that moves it; nothing if it mimics none on the way.
std::optional<Index> find_driver(const UrdfRobot& robot, const UrdfJoint& joint) {
    Index index = 0;
    for (const UrdfJoint& other : robot.joints) {
        if (!is_driven(other)) continue;
        if (joint.mimic ? other.name == joint.mimic->joint : &other == &joint) return index;
        ++index;
    }
    return std::nullopt;
}

/// What a joint that moves does, as the elements it drives.
std::vector<Element> driven_elements(const UrdfRobot& robot, const UrdfJoint& joint) {
    std::vector<Element> elements =
        joint_elements(joint_motion(joint), joint.axis, *find_driver(robot, joint));
    if (!joint.mimic) return elements;
    for (Element& element : elements) {
        if (element.joints.empty()) continue;
        const double sign = element.joints.front().coefficient;
        element.value = sign * joint.mimic->offset;
        element.joints.front().coefficient = sign * joint.mimic->factor;
    }
    return elements;
}

void check_joint_count(const UrdfRobot& robot) {
    const auto count = static_cast<std::size_t>(std::ranges::count_if(robot.joints, io::is_driven));
    if (count == 0) {
        throw input_error_at({robot.source.path},
                             "has no joint that moves between " + ends_of(robot.source));
    }
    if (count > most_joints) {
        refuse_so_many(robot.source, robot.joints.size(), "at most 100 of them may move");
    }
}

/// A mimic moves as a joint on the way does, or its place is not known.
void check_mimics(const UrdfRobot& robot) {
    for (const UrdfJoint& joint : robot.joints) {
        if (!joint.mimic || find_driver(robot, joint)) continue;
        throw input_error_at(
            joint.location,
            "joint " + quote(joint.name) + " mimics " + quote(joint.mimic->joint) +
                ", which is no joint between " + ends_of(robot.source) +
                " that moves by itself; choose links that hold both or neither, or make it fixed");
    }
}

/// A joint turns no farther than what mimics it may.
void limit_by_mimics(UrdfRobot& robot) {
    for (const UrdfJoint& mimic : robot.joints) {
        if (!mimic.mimic || !mimic.limits || mimic.kind == UrdfJointKind::Continuous) continue;
        const auto [name, factor, offset] = *mimic.mimic;
        const auto [a, b] = std::minmax(
            {(mimic.limits->lower - offset) / factor, (mimic.limits->upper - offset) / factor});
        const auto driver = std::ranges::find(robot.joints, name, &UrdfJoint::name);
        Interval range{a, b};
        if (driver->limits && driver->kind != UrdfJointKind::Continuous) {
            range = {std::max(a, driver->limits->lower), std::min(b, driver->limits->upper)};
        }
        if (!(range.lower < range.upper)) {
            throw input_error_at(mimic.location, "joint " + quote(mimic.name) +
                                                     " has limits that leave joint " + quote(name) +
                                                     ", which it mimics, no room; are multiplier "
                                                     "and offset right?");
        }
        if (driver->kind == UrdfJointKind::Continuous) driver->kind = UrdfJointKind::Revolute;
        driver->limits = range;
    }
}

}  // namespace

UrdfRobot read_urdf(const UrdfSource& source) {
    const XmlDocument document(source.path);
    const UrdfPath path = find_path(document, source);
    UrdfRobot robot;
    robot.source = path.source;
    robot.name = escape_controls(document.root().attribute("name").value());
    if (path.joints.size() > most_elements) {
        refuse_so_many(path.source, path.joints.size(), "must be at most 1000");
    }
    for (const xml_node joint : path.joints) {
        robot.joints.push_back(read_urdf_joint(document, joint));
    }
    check_mimics(robot);
    check_joint_count(robot);
    limit_by_mimics(robot);
    return robot;
}

bool is_driven(const UrdfJoint& joint) {
    return joint.kind != UrdfJointKind::Fixed && !joint.mimic;
}

std::vector<std::string> describe_doubts(const UrdfRobot& robot) {
    std::vector<std::string> sentences;
    for (const UrdfJoint& joint : robot.joints) {
        sentences.insert(sentences.end(), joint.warnings.begin(), joint.warnings.end());
        if (!is_driven(joint) || joint.limits) continue;
        sentences.emplace_back(
            input_error_at(joint.location, "joint " + quote(joint.name) + no_limits).what());
    }
    return sentences;
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
        append(driven_elements(robot, joint));
        if (joint.mimic) continue;
        if (!joint.limits) {
            throw input_error_at(joint.location, "joint " + quote(joint.name) + no_limits);
        }
        joints.push_back({chain_joint_name(joint.name), joint.limits->lower, joint.limits->upper,
                          joint_motion(joint), joint.pitch});
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
        if (!is_driven(joint)) continue;
        if (joint.speed == 0) return {};
        speeds.push_back(joint.speed);
    }
    return Eigen::Map<const VectorXd>(speeds.data(), static_cast<Index>(speeds.size()));
}

}  // namespace posewise::io

namespace posewise::detail {

Chain make_chain_without_limits(io::UrdfRobot robot) {
    for (io::UrdfJoint& joint : robot.joints) joint.limits = Interval{-1, 1};
    return io::make_chain(robot);
}

}  // namespace posewise::detail
