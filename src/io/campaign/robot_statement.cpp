#include "robot_statement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "posewise/model/error_terms.hpp"

namespace posewise::detail {
namespace {

constexpr double alike = 1e-9;

/// Where torque shapes are compared: any configuration would do that is no multiple of pi.
VectorXd comparison_configuration(const Chain& robot) {
    return VectorXd::LinSpaced(robot.configuration_size(), 0.3, 1.1);
}

Json joints_statement(const Chain& robot, const std::vector<JointTerm>& terms) {
    Json json = Json::object();
    for (const JointTerm& term : terms) {
        const std::string name = term.joint < robot.joint_count()
                                     ? robot.joint(term.joint).name
                                     : fmt::format("torque {}", term.joint - robot.joint_count());
        json[name] = term.coefficient;
    }
    return json;
}

Json term_statement(const Chain& robot, const ErrorTerm& term) {
    const JointFunction& f = term.function;
    Json json = {{"name", term.parameter}};
    if (term.kind == TermKind::Gravity) return json;  // in proportion to the payload, which changes
    if (f.shape == JointFunction::Shape::Torque) {
        json["value"] = f.torque->value(comparison_configuration(robot));
        if (!f.joints.empty()) json["times"] = joints_statement(robot, f.joints);
        return json;
    }
    const bool is_linear = f.shape == JointFunction::Shape::Linear;
    json[is_linear ? "of" : "sine_of"] = joints_statement(robot, f.joints);
    if (f.phase != 0) json["phase"] = f.phase;
    return json;
}

Json element_statement(const Chain& robot, const Element& element) {
    Json json = {{"motion", transform_name(element)}};
    if (element.value != 0)
        json["amount" + si_suffix(element.motion == Motion::Rotation)] = element.value;
    if (!element.joints.empty()) json["joints"] = joints_statement(robot, element.joints);
    if (!element.parameter.empty()) json["error"] = element.parameter;
    return json;
}

bool is_alike(const Json& a, const Json& b) {
    if (a.is_number() && b.is_number()) {
        return std::abs(a.get<double>() - b.get<double>()) <= alike;
    }
    if (a.type() != b.type() || a.size() != b.size()) return false;
    if (!a.is_structured()) return a == b;
    if (a.is_array()) return std::equal(a.begin(), a.end(), b.begin(), is_alike);
    return std::all_of(a.items().begin(), a.items().end(), [&](const auto& item) {
        return b.contains(item.key()) && is_alike(item.value(), b.at(item.key()));
    });
}

/// Throws where two lists differ first.
void compare(const JsonValue& stated, const Json& here, const char* what, const char* advice) {
    const Json& there = stated.json();
    for (std::size_t k = 0; there.is_array() && k < here.size() && k < there.size(); ++k) {
        if (is_alike(there[k], here[k])) continue;
        throw stated.error(fmt::format("{} {} is {}, the campaign's robot has {}; {}", what, k + 1,
                                       there[k].dump(), here[k].dump(), advice));
    }
    if (there.is_array() && there.size() == here.size()) return;
    throw stated.error(fmt::format("has {} {}s, the campaign's robot {}; {}", there.size(), what,
                                   here.size(), advice));
}

}  // namespace

Json robot_statement(const Chain& robot) {
    Json elements = Json::array();
    Json terms = Json::array();
    for (const Element& element : robot.elements()) {
        elements.push_back(element_statement(robot, element));
        for (const ErrorTerm& term : element.terms) terms.push_back(term_statement(robot, term));
    }
    return {{"elements", std::move(elements)}, {"terms", std::move(terms)}};
}

void check_is_of_robot(const JsonValue& stated, const Chain& robot) {
    const Json here = robot_statement(robot);
    compare(stated["elements"], here["elements"], "element",
            "the estimate is of another robot, or of this one before its nominal values were "
            "changed (a robot that it has corrected, for one)");
    compare(stated["terms"], here["terms"], "term",
            "the estimate is of other errors, or the joint limits and pitches, from which their "
            "shapes follow, were others");
}

void check_is_same_robot(const std::string& path, const Chain& other, const Chain& robot) {
    const Json there = robot_statement(other);
    const Json here = robot_statement(robot);
    const JsonValue stated(there, path);
    constexpr const char* advice = "both campaigns must state the same robot and its errors";
    compare(stated["elements"], here["elements"], "element", advice);
    compare(stated["terms"], here["terms"], "term", advice);
}

}  // namespace posewise::detail
