#include <algorithm>

#include "campaign_sections.hpp"
#include "element_notation.hpp"
#include "text.hpp"

namespace posewise::io {
namespace {

std::vector<std::string> joint_names(const std::vector<YamlEntry>& entries) {
    std::vector<std::string> names;
    for (const auto& [name, location, value] : entries) {
        if (!is_identifier(name) || find_unit(name) != nullptr) {
            throw input_error_at(location, "'" + name +
                                               "' cannot name a joint; must be letters, "
                                               "digits and underscores, not a unit");
        }
        names.push_back(name);
    }
    return names;
}

Joint read_joint(const YamlEntry& entry, std::optional<Motion> motion) {
    if (!motion) {
        throw input_error_at(entry.key_location,
                             "joint '" + entry.key + "' drives no element; must occur in one");
    }
    const YamlMap map(entry.value, {"limits_<angle>", "limits_<length>"});
    const YamlMeasure limits = map.require_measure("limits");
    if (limits.unit->quantity != quantity_of(*motion)) {
        throw limits.value.error("is in '" + std::string(limits.unit->name) +
                                 "', but the joint drives a " +
                                 (*motion == Motion::Rotation ? "rotation" : "translation") +
                                 "; must be in " + list_words(unit_names(quantity_of(*motion))));
    }
    const std::vector<double> values = limits.value.numbers(2);
    if (values[0] >= values[1]) {
        throw limits.value.error("is not in order; the lower limit must come first");
    }
    return {entry.key, limits.unit->to_si(values[0]), limits.unit->to_si(values[1])};
}

ErrorModel read_error_model(const YamlMap& robot, const std::vector<Element>& elements) {
    if (const auto errors = robot.find("errors")) {
        const std::string word = errors->text();
        if (word == "stated") return ErrorModel::Stated;
        if (word == "complete") return ErrorModel::Complete;
        throw errors->error("is '" + word + "'; " + suggest(word, {"stated", "complete"}));
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

    ElementParser parser(joint_names(entries));
    std::vector<Element> elements;
    for (const YamlValue& line : robot.require("elements").list()) {
        elements.push_back(parser.parse(line.text(), line.text_location()));
    }
    std::vector<Joint> joints;
    for (const YamlEntry& entry : entries) {
        joints.push_back(read_joint(entry, parser.joint_motion(static_cast<Index>(joints.size()))));
    }
    RobotSection section;
    section.error_model = read_error_model(robot, elements);
    section.declared = Chain(std::move(joints), std::move(elements));
    return section;
}

}  // namespace posewise::io
