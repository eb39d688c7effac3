#include <fmt/format.h>

#include <algorithm>

#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "urdf_tree.hpp"

namespace posewise::detail {
namespace {

Isometry3d product_of(const std::vector<Element>& elements, const VectorXd& parameters) {
    return Chain({}, elements).base_from_flange(VectorXd(), parameters);
}

}  // namespace

std::vector<Isometry3d> constants_of(const Chain& robot, const VectorXd& parameters) {
    std::vector<Isometry3d> constants;
    std::vector<Element> elements;
    std::vector<double> values;
    const auto finish = [&] {
        constants.push_back(product_of(
            elements,
            Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()))));
        elements.clear();
        values.clear();
    };
    Index next = 0;
    for (Element element : robot.elements()) {
        const bool is_driven = !element.joints.empty();
        if (!element.parameter.empty()) values.push_back(parameters[next++]);
        next += static_cast<Index>(element.terms.size());
        element.joints.clear();
        element.terms.clear();
        elements.push_back(std::move(element));
        if (is_driven) finish();
    }
    finish();
    return constants;
}

}  // namespace posewise::detail

namespace posewise::io {
namespace {

using namespace detail;
using pugi::xml_node;

/// The turn of a joint's frame that puts its axis on a coordinate axis, see joint_elements(), and
/// what a mimic moves by where the joint that it mimics is at zero.
Isometry3d alignment_of(const UrdfJoint& joint) {
    std::vector<Element> elements = joint_elements(joint_motion(joint), joint.axis, 0);
    const auto driven = std::find_if(elements.begin(), elements.end(), [](const Element& element) {
        return !element.joints.empty();
    });
    elements.erase(driven + 1, elements.end());
    const double sign = elements.back().joints.front().coefficient;
    elements.back().joints.clear();
    elements.back().value = joint.mimic ? sign * joint.mimic->offset : 0;
    return product_of(elements, VectorXd());
}

Isometry3d origin_of(const UrdfJoint& joint) {
    return product_of(origin_elements(joint.xyz, joint.rpy), VectorXd());
}

/// A joint whose origin changes from `origin` to origin * change.
struct Correction {
    std::size_t joint;
    Isometry3d change;
};

/// How the constants change, at the joints that can take it up.
std::vector<Correction> correct_origins(const std::vector<UrdfJoint>& joints,
                                        const std::vector<Isometry3d>& nominal,
                                        const std::vector<Isometry3d>& calibrated) {
    std::vector<Correction> corrections;
    for (std::size_t k = 0; k < joints.size(); ++k) {
        if (joints[k].kind == UrdfJointKind::Fixed) continue;
        const std::size_t j = corrections.size();
        const Isometry3d A = alignment_of(joints[k]);
        corrections.push_back({k, A * nominal[j].inverse() * calibrated[j] * A.inverse()});
    }
    const std::size_t first_after = corrections.back().joint + 1;
    if (first_after < joints.size()) {
        Isometry3d others_after = Isometry3d::Identity();
        for (std::size_t k = first_after + 1; k < joints.size(); ++k) {
            others_after = others_after * origin_of(joints[k]);
        }
        const Isometry3d change = nominal.back().inverse() * calibrated.back();
        corrections.push_back({first_after, others_after * change * others_after.inverse()});
    }
    return corrections;
}

/// A tag with an attribute set: its value replaced, or the attribute put in after the name.
std::string with_attribute(const std::string& tag, const std::string& name,
                           const std::string& value) {
    constexpr const char* blanks = " \t\r\n";
    const std::size_t name_end = tag.find_first_of(" \t\r\n/>");
    std::size_t position = name_end;
    while ((position = tag.find_first_not_of(blanks, position)) != std::string::npos) {
        const std::size_t equals = tag.find('=', position);
        if (equals == std::string::npos) break;
        const std::string found =
            tag.substr(position, tag.find_last_not_of(blanks, equals - 1) + 1 - position);
        const std::size_t quotation = tag.find_first_of("\"'", equals);
        const std::size_t end = tag.find(tag[quotation], quotation + 1);
        if (found == name) {
            return tag.substr(0, quotation + 1) + value + tag.substr(end);
        }
        position = end + 1;
    }
    return tag.substr(0, name_end) + ' ' + name + "=\"" + value + '"' + tag.substr(name_end);
}

/// A part of a text to be replaced.
struct Edit {
    std::size_t begin;
    std::size_t end;
    std::string text;
};

/// The joint's origin at its new place; what does not change keeps its words.
Edit edit_origin(const XmlDocument& document, xml_node element, const UrdfJoint& joint,
                 const Isometry3d& origin) {
    constexpr double same = 1e-15;
    const xml_node stated = find_child(document, element, "origin");
    const std::string& content = document.content();
    const StartTag tag = document.start_tag(stated ? stated : element);
    std::string text = stated ? content.substr(tag.begin, tag.end - tag.begin) : "<origin/>";
    if (!(rotation_from_rpy(joint.rpy) - origin.linear()).isZero(same)) {
        text = with_attribute(text, "rpy", vector_text(rpy_from_rotation(origin.linear())));
    }
    if (!(joint.xyz - origin.translation()).isZero(same)) {
        text = with_attribute(text, "xyz", vector_text(origin.translation()));
    }
    if (stated) return {tag.begin, tag.end, text};
    // A line of its own in front of the first child, if the children stand so.
    const std::size_t first = content.find_first_not_of(" \t\r\n", tag.end);
    return {tag.end, tag.end, content.substr(tag.end, first - tag.end) + text};
}

std::string apply(std::string content, std::vector<Edit> edits) {
    std::sort(edits.begin(), edits.end(),
              [](const Edit& a, const Edit& b) { return a.begin > b.begin; });
    for (const Edit& edit : edits) content.replace(edit.begin, edit.end - edit.begin, edit.text);
    return content;
}

void check_same_robot(const std::vector<UrdfJoint>& joints, std::size_t constant_count,
                      const UrdfSource& source) {
    const auto moving = std::count_if(joints.begin(), joints.end(), [](const UrdfJoint& joint) {
        return joint.kind != UrdfJointKind::Fixed;
    });
    if (static_cast<std::size_t>(moving) + 1 != constant_count) {
        throw input_error_at({source.path}, "has " + std::to_string(moving) +
                                                " joints that move, the robot " +
                                                std::to_string(constant_count - 1) +
                                                "; must be the URDF the robot was made from");
    }
}

/// Names of the parameters after the last joint that are not zero.
std::vector<std::string> errors_after_last_joint(const Chain& robot, const VectorXd& parameters) {
    std::vector<std::string> names;
    Index next = 0;
    for (const Element& element : robot.elements()) {
        if (!element.joints.empty()) names.clear();
        if (!element.parameter.empty()) {
            if (element.joints.empty() && parameters[next] != 0) names.push_back(element.parameter);
            ++next;
        }
        next += static_cast<Index>(element.terms.size());
    }
    return names;
}

}  // namespace

CalibratedUrdf make_calibrated_urdf(const UrdfSource& source, const Chain& robot,
                                    const VectorXd& parameters) {
    constexpr double unchanged = 1e-14;  // of rounding
    const XmlDocument document(source.path);
    const UrdfPath path = find_path(document, source);
    std::vector<UrdfJoint> joints;
    for (const xml_node joint : path.joints) joints.push_back(read_urdf_joint(document, joint));

    const auto nominal = constants_of(make_chain_without_limits({{}, "", joints}), VectorXd());
    const auto calibrated = constants_of(robot, parameters);
    CalibratedUrdf result;
    std::vector<Edit> edits;
    check_same_robot(joints, calibrated.size(), source);
    const auto corrections = correct_origins(joints, nominal, calibrated);
    for (const auto& [k, change] : corrections) {
        if (change.isApprox(Isometry3d::Identity(), unchanged)) continue;
        const Isometry3d origin = origin_of(joints[k]) * change;
        edits.push_back(edit_origin(document, path.joints[k], joints[k], origin));
        result.changes.push_back({joints[k].name, change.translation().norm(),
                                  Eigen::AngleAxisd(change.linear()).angle()});
    }
    if (corrections.size() < nominal.size()) {
        result.not_expressed = errors_after_last_joint(robot, parameters);
    }
    result.terms = active_terms(robot, parameters);
    result.text = apply(document.content(), std::move(edits));
    return result;
}

}  // namespace posewise::io
