#include <algorithm>
#include <filesystem>

#include "io/campaign/keys.hpp"
#include "io/campaign/robot_parts.hpp"
#include "io/format/text.hpp"

namespace posewise::detail {
namespace {

/// A path of the campaign file is one from its folder.
std::string resolve(const YamlValue& path) {
    if (path.text().empty()) throw path.error("is empty; must be the path of a URDF file");
    const auto folder = std::filesystem::path(path.location().path).parent_path();
    return (folder / path.text()).lexically_normal().string();
}

/// Empty: the reader finds it.
std::string read_link_name(const YamlMap& robot, const char* key) {
    const auto link = robot.find(key);
    if (!link) return "";
    if (link->text().empty()) throw link->error("is empty; must be the name of a link");
    return link->text();
}

/// The joints that move, by the names the campaign calls them.
std::vector<io::UrdfJoint*> moving_joints(io::UrdfRobot& robot) {
    std::vector<io::UrdfJoint*> joints;
    for (io::UrdfJoint& joint : robot.joints) {
        if (io::is_driven(joint)) joints.push_back(&joint);
    }
    return joints;
}

std::size_t find_joint(const std::vector<io::UrdfJoint*>& joints, const YamlEntry& entry) {
    std::vector<std::string> names;
    for (const io::UrdfJoint* joint : joints) names.push_back(io::chain_joint_name(joint->name));
    const auto found = std::find(names.begin(), names.end(), entry.key);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    throw input_error_at(
        entry.key_location,
        quote(entry.key) + " is no moving joint of the URDF; " + suggest(entry.key, names));
}

}  // namespace

RobotSection read_urdf_robot(const YamlMap& map) {
    io::UrdfRobot robot =
        io::read_urdf({resolve(map.require("urdf")), read_link_name(map, "base_link"),
                       read_link_name(map, "tip_link")});
    const std::vector<io::UrdfJoint*> joints = moving_joints(robot);
    RobotSection section;
    section.joint_repeatability = VectorXd::Zero(static_cast<Index>(joints.size()));
    if (const auto stated = map.find("joints")) {
        for (const YamlEntry& entry : stated->entries()) {
            const std::size_t j = find_joint(joints, entry);
            const YamlMap settings(entry.value, keys::joint);
            const Motion motion = joint_motion(*joints[j]);
            if (const auto joint = find_limited_joint(settings, entry.key, motion)) {
                joints[j]->limits = Interval{joint->lower, joint->upper};
            }
            joints[j]->pitch = read_pitch(settings, motion);
            section.joint_repeatability[static_cast<Index>(j)] =
                read_repeatability(settings, motion);
        }
    }
    section.declared = make_chain(robot);
    for (const io::UrdfJoint& joint : robot.joints) {
        section.warnings.insert(section.warnings.end(), joint.warnings.begin(),
                                joint.warnings.end());
    }
    section.urdf = robot.source;
    section.speed = joint_speeds(robot);
    return section;
}

}  // namespace posewise::detail
