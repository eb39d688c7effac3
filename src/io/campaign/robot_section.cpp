#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "element_notation.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "robot_parts.hpp"

namespace posewise::detail {

void check_joint_name(const std::string& name, const FileLocation& location) {
    if (!is_identifier(name) || find_unit(name) != nullptr) {
        throw input_error_at(location, quote(name) +
                                           " cannot name a joint; must be letters, "
                                           "digits and underscores, not a unit");
    }
}

namespace {

std::vector<std::string> joint_names(const std::vector<YamlEntry>& entries) {
    std::vector<std::string> names;
    for (const auto& [name, location, value] : entries) {
        check_joint_name(name, location);
        names.push_back(name);
    }
    return names;
}

/// Throws InputError if the measure's unit is not of what the joint moves in.
void check_quantity(const YamlMeasure& measure, Motion motion) {
    if (measure.unit->quantity == quantity_of(motion)) return;
    throw measure.value.error("is in '" + std::string(measure.unit->name) +
                              "', but the joint drives a " +
                              (motion == Motion::Rotation ? "rotation" : "translation") +
                              "; must be in " + list_words(unit_names(quantity_of(motion))));
}

constexpr double full_turn = 2 * std::numbers::pi;

/// Degrees read as rad, by the look of them.
void check_turns(const YamlMeasure& limits, const VectorXd& values) {
    const double turns = values.cwiseAbs().maxCoeff() / full_turn;
    if (turns <= most_turns) return;
    throw limits.value.error(fmt::format(
        "reaches {:.3g} turns; must be within three either way{}", turns,
        limits.unit->name == "rad" ? ": are they degrees? Then the key is limits_deg" : ""));
}

/// Rad read as degrees, by the look of them: no robot turns so little in every joint.
void check_has_room(const YamlValue& robot, const Chain& chain) {
    constexpr double least = full_turn * std::numbers::pi / 180;  // a turn in rad, read as degrees
    double largest = 0;
    for (Index j = 0; j < chain.joint_count(); ++j) {
        if (chain.joint(j).motion != Motion::Rotation) continue;
        const Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
        largest = std::max({largest, -joint.lower, joint.upper});
    }
    if (largest == 0 || largest > least) return;
    throw robot.error(fmt::format(
        "has no joint that turns beyond {:.3g} deg; must have room to turn: are the limits rad? "
        "Then their key is limits_rad",
        largest * 180 / std::numbers::pi));
}

Joint to_joint(const YamlMeasure& limits, const std::string& name, Motion motion) {
    check_quantity(limits, motion);
    const VectorXd values = limits.list_to_si(2);
    if (motion == Motion::Rotation) check_turns(limits, values);
    if (values[0] >= values[1]) {
        throw limits.value.error("is not in order; the lower limit must come first");
    }
    return {name, values[0], values[1]};
}

/// A list names some of all errors.
io::ErrorModel find_error_model(const YamlMap& robot, const std::vector<Element>& elements,
                                std::vector<YamlValue>& free) {
    if (const auto errors = robot.find("errors")) {
        if (!errors->is_list()) return read_error_model(*errors);
        free = errors->list();
        if (free.empty()) throw errors->error("is empty; must name errors, or be none");
        return io::ErrorModel::Full;
    }
    const auto is_stated = [](const Element& element) { return !element.parameter.empty(); };
    return std::any_of(elements.begin(), elements.end(), is_stated) ? io::ErrorModel::Stated
                                                                    : io::ErrorModel::Full;
}

}  // namespace

std::optional<Joint> find_limited_joint(const YamlMap& map, const std::string& name,
                                        Motion motion) {
    const auto limits = map.find_measure("limits");
    return limits ? std::optional(to_joint(*limits, name, motion)) : std::nullopt;
}

Joint read_limited_joint(const YamlMap& map, const std::string& name, Motion motion) {
    Joint joint = to_joint(map.require_measure("limits"), name, motion);
    joint.pitch = read_pitch(map, motion);
    return joint;
}

double read_repeatability(const YamlMap& map, Motion motion) {
    const auto measure = map.find_measure("repeatability");
    if (!measure) return 0;
    check_quantity(*measure, motion);
    return read_positive(*measure, true);
}

double read_pitch(const YamlMap& map, Motion motion) {
    constexpr double least = 1e-6;  // m: that of gratings; positions say no less
    constexpr double most = 1;      // m: of the largest pinions
    const auto pitch = map.find_measure("pitch");
    if (!pitch) return 0;
    if (motion == Motion::Rotation) {
        throw pitch->value.error("is stated, but the joint turns; must be of one that slides");
    }
    const double value = pitch->unit->to_si(pitch->value.number());
    if (value >= least && value <= most) return value;
    throw pitch->value.error(fmt::format("is {}; must be from {:g} to {:g} {}",
                                         quote(pitch->value.text()), pitch->unit->from_si(least),
                                         pitch->unit->from_si(most), pitch->unit->name));
}

RobotSection read_elements(const YamlMap& robot) {
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
    RobotSection section;
    section.joint_repeatability.resize(static_cast<Index>(entries.size()));
    std::vector<Joint> joints;
    for (const YamlEntry& entry : entries) {
        const auto j = static_cast<Index>(joints.size());
        const auto motion = parser.joint_motion(j);
        if (!motion) {
            throw input_error_at(entry.key_location, "joint " + quote(entry.key) +
                                                         " drives no element; must occur in one");
        }
        const YamlMap map(entry.value, keys::joint);
        joints.push_back(read_limited_joint(map, entry.key, *motion));
        section.joint_repeatability[j] = read_repeatability(map, *motion);
    }
    section.declared = Chain(std::move(joints), std::move(elements));
    return section;
}

namespace {

/// What the robot is stated by: elements, dh or urdf. Throws InputError unless it is one of them.
YamlValue find_description(const YamlValue& value, const YamlMap& robot) {
    std::vector<YamlValue> stated;
    for (const char* const key : {"elements", "dh", "urdf"}) {
        if (const auto found = robot.find(key)) stated.push_back(*found);
    }
    if (stated.empty()) {
        throw value.error("has no key elements, dh or urdf; one of them must be stated");
    }
    if (stated.size() > 1) {
        throw stated[1].error("is stated beside " + stated[0].name() + "; must be one of them");
    }
    return stated.front();
}

void refuse(const YamlMap& robot, std::string_view key, const YamlValue& beside,
            const char* advice) {
    if (const auto found = robot.find(key)) {
        throw found->error("is stated beside " + beside.name() + "; " + advice);
    }
}

/// What `parse` makes of a word; its error gets the word's place.
template <typename Parse>
auto parse_word(const YamlValue& value, Parse parse) {
    const std::string word = value.text();
    try {
        return parse(word);
    } catch (const InputError& problem) {
        throw value.error(problem.what());
    }
}

RobotSection read_described(const YamlMap& robot, const YamlValue& description) {
    if (description.name() == "robot.urdf") return read_urdf_robot(robot);
    for (const char* const link : {"base_link", "tip_link"}) {
        refuse(robot, link, description, "only a URDF has links");
    }
    if (description.name() == "robot.elements") return read_elements(robot);
    refuse(robot, "joints", description, "limits must stand in the rows of the table");
    return read_dh(description);
}

}  // namespace

io::ErrorModel read_error_model(const YamlValue& errors) {
    return parse_word(errors, io::parse_error_model);
}

RobotSection read_robot(const YamlValue& value, std::optional<io::ErrorModel> errors) {
    const YamlMap robot(value, keys::robot);
    RobotSection section = read_described(robot, find_description(value, robot));
    check_has_room(value, section.declared);
    if (const auto kind = robot.find("class"))
        section.robot_class = parse_word(*kind, parse_robot_class);
    section.error_model =
        errors ? *errors : find_error_model(robot, section.declared.elements(), section.free);
    if (section.error_model == io::ErrorModel::None) {
        section.declared = without_parameters(section.declared);
    } else {
        add_stated_terms(robot, section);
    }
    if (section.joint_repeatability.isZero(0)) section.joint_repeatability.resize(0);
    return section;
}

}  // namespace posewise::detail
