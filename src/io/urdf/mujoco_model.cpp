#include "mujoco_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <sstream>

#include "core/text.hpp"
#include "posewise/model/chain.hpp"
#include "urdf_tree.hpp"

namespace posewise::detail {
namespace {

using pugi::xml_node;

void set(xml_node node, const char* attribute, const std::string& value) {
    node.append_attribute(attribute).set_value(value.c_str());
}

/// A child with a name and a place.
xml_node add(xml_node parent, const char* kind, const std::string& name, const Isometry3d& place) {
    const xml_node node = parent.append_child(kind);
    set(node, "name", name);
    set(node, "pos", vector_text(place.translation()));
    const Eigen::Quaterniond q(place.linear());
    set(node, "quat", fmt::format("{} {}", q.w() + 0.0, vector_text(q.vec())));
    return node;
}

/// Writes the joints of a chain, one after another.
class JointWriter {
  public:
    JointWriter(const Chain& robot, xml_node equality)
        : robot_(robot), equality_(equality), owners_(robot.joints().size()), counts_(owners_) {
        std::size_t place = 0;
        for (const Element& element : robot.elements()) {
            for (const JointTerm& term : element.joints) {
                ++place;
                std::size_t& owner = owners_[static_cast<std::size_t>(term.joint)];
                if (owner == 0 && std::abs(term.coefficient) == 1) owner = place;
            }
        }
        for (std::size_t j = 0; j < owners_.size(); ++j) {
            if (owners_[j] != 0) continue;
            throw InputError("joint " + quote(robot.joints()[j].name) +
                             " drives nothing by a factor of 1, as a joint of MuJoCo does");
        }
        counts_.assign(owners_.size(), 1);
    }

    void write(const Element& element, xml_node body) {
        for (const JointTerm& term : element.joints) write(element, term, body);
    }

  private:
    void write(const Element& element, const JointTerm& term, xml_node body) {
        const auto j = static_cast<std::size_t>(term.joint);
        const Joint& joint = robot_.joints()[j];
        const bool is_owner = ++place_ == owners_[j];
        const std::string name =
            is_owner ? joint.name : fmt::format("{}.{}", joint.name, ++counts_[j]);
        const xml_node node = body.append_child("joint");
        set(node, "name", name);
        set(node, "type", element.motion == Motion::Rotation ? "hinge" : "slide");
        const double sign = is_owner ? term.coefficient : 1;
        set(node, "axis", vector_text(sign * Vector3d::Unit(static_cast<int>(element.axis))));
        if (is_owner) {
            set(node, "limited", "true");
            set(node, "range", fmt::format("{} {}", joint.lower, joint.upper));
            return;
        }
        const xml_node follows = equality_.append_child("joint");
        set(follows, "joint1", name);
        set(follows, "joint2", joint.name);
        set(follows, "polycoef", fmt::format("0 {} 0 0 0", term.coefficient));
    }

    const Chain& robot_;
    xml_node equality_;
    std::vector<std::size_t> owners_;  // place of the term that is the joint itself, from 1
    std::vector<std::size_t> counts_;  // of the joint's names
    std::size_t place_ = 0;
};

void add_targets(xml_node flange, const Geometry& geometry) {
    add(flange, "site", "flange", Isometry3d::Identity());
    if (geometry.tool) {
        add(flange, "site", "tool", *geometry.tool);
        return;
    }
    for (std::size_t k = 0; k < geometry.targets.size(); ++k) {
        const Isometry3d place(Eigen::Translation3d(geometry.targets[k]));
        add(flange, "site", fmt::format("target{}", k + 1), place);
    }
}

/// As many numbers of an attribute.
std::vector<double> read_numbers(const XmlDocument& document, xml_node node, const char* attribute,
                                 std::size_t count) {
    std::istringstream text(node.attribute(attribute).value());
    text.imbue(std::locale::classic());
    std::vector<double> numbers(count);
    for (double& number : numbers) text >> number;
    if (!text) throw document.error(node, fmt::format("has no {} numbers {}", count, attribute));
    return numbers;
}

/// The joints that a model names: those of the robot, and what follows them.
std::map<std::string, JointTerm> read_names(const XmlDocument& document,
                                            const std::vector<Joint>& joints) {
    std::map<std::string, JointTerm> names;
    for (const Joint& joint : joints) {
        names.emplace(joint.name, JointTerm{std::ssize(names), 1});
    }
    for (const xml_node follows : document.root().child("equality").children("joint")) {
        const auto followed = names.find(follows.attribute("joint2").value());
        if (followed == names.end()) throw document.error(follows, "follows no joint");
        names.emplace(
            follows.attribute("joint1").value(),
            JointTerm{followed->second.joint, read_numbers(document, follows, "polycoef", 5)[1]});
    }
    return names;
}

}  // namespace

std::string mujoco_text(const std::string& title, const Geometry& geometry) {
    const Chain& robot = geometry.robot;
    const std::vector<Isometry3d> constants = constants_of(robot, geometry.errors);
    pugi::xml_document document;
    xml_node model = document.append_child("mujoco");
    set(model, "model", title);
    const xml_node compiler = model.append_child("compiler");
    set(compiler, "angle", "radian");
    // Bodies have no masses that are known; MuJoCo takes none without.
    set(compiler, "boundmass", "0.001");
    set(compiler, "boundinertia", "1e-06");
    xml_node body = add(model.append_child("worldbody"), "body", "base", Isometry3d::Identity());
    const xml_node equality = model.append_child("equality");
    JointWriter joints(robot, equality);
    std::size_t k = 0;
    for (const Element& element : robot.elements()) {
        if (element.joints.empty()) continue;
        body = add(body, "body", fmt::format("link{}", k + 1), constants[k]);
        joints.write(element, body);
        ++k;
    }
    add_targets(add(body, "body", "flange", constants.back()), geometry);
    if (!equality.first_child()) model.remove_child(equality);
    std::ostringstream text;
    document.save(text, "  ", pugi::format_indent | pugi::format_no_declaration);
    return text.str();
}

Chain read_mujoco(const std::string& path, const std::vector<Joint>& joints) {
    const XmlDocument document(path);
    const std::map<std::string, JointTerm> names = read_names(document, joints);
    std::vector<Element> elements;
    const auto append = [&](const std::vector<Element>& more) {
        elements.insert(elements.end(), more.begin(), more.end());
    };
    for (xml_node body = document.root().child("worldbody").child("body"); body;
         body = body.child("body")) {
        const std::vector<double> p = read_numbers(document, body, "pos", 3);
        const std::vector<double> q = read_numbers(document, body, "quat", 4);
        const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
        append(origin_elements({p[0], p[1], p[2]},
                               rpy_from_rotation(turn.normalized().toRotationMatrix())));
        for (const xml_node joint : body.children("joint")) {
            const auto named = names.find(joint.attribute("name").value());
            if (named == names.end()) throw document.error(joint, "is none of the robot's joints");
            const bool turns = std::string_view(joint.attribute("type").value()) == "hinge";
            const std::vector<double> axis = read_numbers(document, joint, "axis", 3);
            std::vector<Element> driven =
                joint_elements(turns ? Motion::Rotation : Motion::Translation,
                               {axis[0], axis[1], axis[2]}, named->second.joint);
            for (Element& element : driven) {
                for (JointTerm& term : element.joints)
                    term.coefficient *= named->second.coefficient;
            }
            append(driven);
        }
    }
    return {joints, elements};
}

}  // namespace posewise::detail
