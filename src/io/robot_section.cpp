#include <algorithm>

#include "campaign_sections.hpp"
#include "element_notation.hpp"
#include "text.hpp"

namespace posewise::io {
namespace {

// Far above any robot: what is more is no robot, and would only take memory and time.
constexpr std::size_t most_joints = 100;
constexpr std::size_t most_elements = 1000;

std::vector<std::string> joint_names(const std::vector<YamlEntry>& entries) {
    std::vector<std::string> names;
    for (const auto& [name, location, value] : entries) {
        if (!is_identifier(name) || find_unit(name) != nullptr) {
            throw input_error_at(location, quote(name) +
                                               " cannot name a joint; must be letters, "
                                               "digits and underscores, not a unit");
        }
        names.push_back(name);
    }
    return names;
}

const std::vector<std::string> joint_keys{"limits_<angle>", "limits_<length>",
                                          "repeatability_<angle>", "repeatability_<length>"};

/// Throws InputError if the measure's unit is not of what the joint moves in.
void check_quantity(const YamlMeasure& measure, Motion motion) {
    if (measure.unit->quantity == quantity_of(motion)) return;
    throw measure.value.error("is in '" + std::string(measure.unit->name) +
                              "', but the joint drives a " +
                              (motion == Motion::Rotation ? "rotation" : "translation") +
                              "; must be in " + list_words(unit_names(quantity_of(motion))));
}

Joint read_joint(const YamlEntry& entry, std::optional<Motion> motion) {
    if (!motion) {
        throw input_error_at(entry.key_location,
                             "joint " + quote(entry.key) + " drives no element; must occur in one");
    }
    const YamlMeasure limits = YamlMap(entry.value, joint_keys).require_measure("limits");
    check_quantity(limits, *motion);
    const VectorXd values = limits.list_to_si(2);
    if (values[0] >= values[1]) {
        throw limits.value.error("is not in order; the lower limit must come first");
    }
    return {entry.key, values[0], values[1]};
}

/// Of all joints, 0 where it is not stated; empty if it is stated for none.
VectorXd read_repeatability(const std::vector<YamlEntry>& entries, const Chain& robot) {
    VectorXd repeatability = VectorXd::Zero(robot.joint_count());
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const YamlMap map(entries[static_cast<std::size_t>(j)].value, joint_keys);
        const auto measure = map.find_measure("repeatability");
        if (!measure) continue;
        check_quantity(*measure, robot.joint_motion(j));
        repeatability[j] = read_positive(*measure, true);
    }
    return repeatability.isZero(0) ? VectorXd() : repeatability;
}

ErrorModel read_error_model(const YamlMap& robot, const std::vector<Element>& elements) {
    if (const auto errors = robot.find("errors")) {
        const std::string word = errors->text();
        if (word == "stated") return ErrorModel::Stated;
        if (word == "complete") return ErrorModel::Complete;
        throw errors->error("is " + quote(word) + "; " + suggest(word, {"stated", "complete"}));
    }
    const auto is_stated = [](const Element& element) { return !element.parameter.empty(); };
    return std::any_of(elements.begin(), elements.end(), is_stated) ? ErrorModel::Stated
                                                                    : ErrorModel::Complete;
}

}  // namespace

RobotSection read_robot(const YamlValue& value) {
    const YamlMap robot(value, {"joints", "elements", "errors"});
    const std::vector<YamlEntry> entries = robot.require("joints").entries();
    if (entries.empty()) throw robot.require("joints").error("is empty; must state the joints");
    if (entries.size() > most_joints) {
        throw robot.require("joints").error("states " + std::to_string(entries.size()) +
                                            " joints; must be at most 100");
    }

    ElementParser parser(joint_names(entries));
    const std::vector<YamlValue> lines = robot.require("elements").list();
    if (lines.size() > most_elements) {
        throw robot.require("elements")
            .error("lists " + std::to_string(lines.size()) + " elements; must be at most 1000");
    }
    std::vector<Element> elements;
    for (const YamlValue& line : lines) {
        elements.push_back(parser.parse(line.text(), line.text_location()));
    }
    std::vector<Joint> joints;
    for (const YamlEntry& entry : entries) {
        joints.push_back(read_joint(entry, parser.joint_motion(static_cast<Index>(joints.size()))));
    }
    RobotSection section;
    section.error_model = read_error_model(robot, elements);
    section.declared = Chain(std::move(joints), std::move(elements));
    section.joint_repeatability = read_repeatability(entries, section.declared);
    return section;
}

}  // namespace posewise::io
