#include "posewise/io/urdf_file.hpp"

#include <algorithm>
#include <numbers>

#include "posewise/model/transforms.hpp"
#include "robot_parts.hpp"
#include "text.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using pugi::xml_node;

/// Reads one <joint>.
class JointReader {
  public:
    JointReader(const XmlDocument& document, xml_node element)
        : document_(document), element_(element), name_(element.attribute("name").value()) {}

    UrdfJoint read() const {
        refuse_misspelt_children();
        UrdfJoint joint;
        joint.name = name_;
        joint.location = document_.location(element_);
        joint.kind = read_kind();
        if (const xml_node origin = find("origin", {"xyz", "rpy"})) {
            joint.xyz = read_vector(origin, "xyz").value_or(joint.xyz);
            joint.rpy = read_vector(origin, "rpy").value_or(joint.rpy);
        }
        if (joint.kind == UrdfJointKind::Fixed) return joint;
        if (element_.child("mimic")) {
            throw error(element_,
                        "mimics another joint; only joints that move by themselves can "
                        "be part of the chain");
        }
        read_axis(joint);
        read_limit(joint);
        return joint;
    }

  private:
    InputError error(xml_node at, const std::string& problem) const {
        return document_.error(at, "joint " + quote(name_) + ' ' + problem);
    }

    /// A misspelt <origin> would silently be no origin.
    void refuse_misspelt_children() const {
        const std::vector<std::string> known{"origin", "parent",   "child",
                                             "axis",   "limit",    "calibration",
                                             "mimic",  "dynamics", "safety_controller"};
        for (const xml_node child : element_.children()) {
            if (child.type() != pugi::node_element) continue;
            const std::string name = child.name();
            if (std::find(known.begin(), known.end(), name) != known.end()) continue;
            const std::string advice = suggest(name, known);
            if (!advice.starts_with("did you mean")) continue;
            throw error(child, "has an element " + quote(name) + "; " + advice);
        }
    }

    xml_node find(const char* name, const std::vector<std::string>& attributes) const {
        const xml_node found = find_child(document_, element_, name);
        for (const pugi::xml_attribute attribute : found.attributes()) {
            const std::string stated = attribute.name();
            if (std::find(attributes.begin(), attributes.end(), stated) != attributes.end()) {
                continue;
            }
            throw error(found, std::string("has ") + name + " with unknown attribute " +
                                   quote(stated) + "; " + suggest(stated, attributes));
        }
        return found;
    }

    UrdfJointKind read_kind() const {
        const pugi::xml_attribute type = element_.attribute("type");
        if (!type) throw error(element_, "has no type; it must be stated");
        const std::string word = type.value();
        if (word == "fixed") return UrdfJointKind::Fixed;
        if (word == "revolute") return UrdfJointKind::Revolute;
        if (word == "continuous") return UrdfJointKind::Continuous;
        if (word == "prismatic") return UrdfJointKind::Prismatic;
        const std::vector<std::string> known{"revolute", "continuous", "prismatic", "fixed"};
        const bool has_many_freedoms = word == "floating" || word == "planar";
        throw error(element_, "is of type " + quote(word) +
                                  (has_many_freedoms
                                       ? ", which moves in several ways at once; must be one of " +
                                             list_words(known)
                                       : "; " + suggest(word, known)));
    }

    std::optional<Vector3d> read_vector(xml_node element, const char* attribute) const {
        return detail::read_vector(document_, element, attribute, "joint " + quote(name_));
    }

    void read_axis(UrdfJoint& joint) const {
        const xml_node axis = find("axis", {"xyz"});
        if (!axis) return;  // x, says the format
        const Vector3d direction = read_vector(axis, "xyz").value_or(joint.axis);
        constexpr double least = 1e-6;
        if (direction.norm() < least) {
            throw error(axis, "has the axis " + quote(axis.attribute("xyz").value()) +
                                  ", which has no direction; must not be zero");
        }
        joint.axis = direction.normalized();
    }

    void read_limit(UrdfJoint& joint) const {
        const xml_node limit = find("limit", {"lower", "upper", "effort", "velocity",
                                              "acceleration", "deceleration", "jerk"});
        const auto read = [&](const char* attribute) {
            if (!limit) return 0.0;
            return read_number(document_, limit, attribute, "joint " + quote(name_)).value_or(0);
        };
        joint.speed = read("velocity");
        if (joint.speed < 0) throw error(limit, "has a negative velocity; must be positive");
        joint.limits = Interval{read("lower"), read("upper")};
        if (joint.kind == UrdfJointKind::Continuous) {
            joint.limits = Interval{-std::numbers::pi, std::numbers::pi};
        } else if (joint.limits->lower > joint.limits->upper) {
            throw error(limit, "has limits that are not in order; lower must be below upper");
        } else if (joint.limits->lower == joint.limits->upper) {
            joint.limits.reset();
        }
    }

    const XmlDocument& document_;
    const xml_node element_;
    std::string name_;
};

}  // namespace

namespace {

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

UrdfJoint detail::read_urdf_joint(const XmlDocument& document, xml_node element) {
    return JointReader(document, element).read();
}

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
