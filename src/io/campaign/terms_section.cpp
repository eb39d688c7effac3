#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/format/text.hpp"
#include "keys.hpp"
#include "posewise/model/error_terms.hpp"
#include "robot_parts.hpp"

namespace posewise::detail {
namespace {

constexpr std::size_t most_orders = 100;
constexpr Index most_parameters = 2000;  // far above any robot

/// The chain that `make` gives. Throws InputError at `value` if there is none, or of too many
/// terms.
template <typename Make>
Chain add(const YamlValue& value, const Make& make) {
    Chain chain;
    try {
        chain = make();
    } catch (const InputError& problem) {
        throw value.error(std::string("is not possible: ") + problem.what());
    }
    if (chain.parameter_count() > most_parameters) {
        throw value.error("makes " + std::to_string(chain.parameter_count()) +
                          " error parameters; must be at most 2000");
    }
    return chain;
}

/// The index of the joint called `name`. Throws InputError at `location` if there is none.
Index find_joint(const Chain& chain, const std::string& name, const FileLocation& location) {
    std::vector<std::string> names;
    for (const Joint& joint : chain.joints()) names.push_back(joint.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) return found - names.begin();
    throw input_error_at(location,
                         quote(name) + " is no joint of the robot; " + suggest(name, names));
}

/// Indices of the joints listed under `joints`; empty if the key is not there.
std::vector<Index> read_joints(const YamlMap& map, const Chain& chain) {
    std::vector<Index> joints;
    const auto listed = map.find("joints");
    if (!listed) return joints;
    for (const YamlValue& item : listed->list()) {
        joints.push_back(find_joint(chain, item.text(), item.location()));
        if (std::count(joints.begin(), joints.end(), joints.back()) > 1) {
            throw item.error("lists " + quote(item.text()) + " twice; keep one");
        }
    }
    if (joints.empty()) throw listed->error("is empty; must list joints, or be left out for all");
    return joints;
}

/// Down, unless it is stated.
Vector3d read_direction(const YamlMap& map) {
    const auto stated = map.find("direction");
    if (!stated) return -Vector3d::UnitZ();
    const std::vector<double> numbers = stated->numbers(3);
    const Vector3d direction = Eigen::Map<const Vector3d>(numbers.data());
    if (direction.isZero(0)) throw stated->error("is zero; must point the way that weights pull");
    return direction;
}

void add_gravity(const YamlValue& value, RobotSection& section) {
    Chain& chain = section.declared;
    std::vector<Index> joints;
    if (value.is_map()) {
        const YamlMap map(value, keys::terms, "gravity");
        section.gravity = read_direction(map);
        joints = read_joints(map, chain);
        const auto listed = map.find("joints");
        if (section.error_model == io::ErrorModel::Full && listed) {
            throw listed->error(
                "is stated, but errors: full has these errors on every joint; leave it out, or "
                "state errors: geometric");
        }
    } else if (!value.boolean()) {
        return;
    }
    if (section.error_model == io::ErrorModel::Full) return;  // which has all that gravity does
    chain = add(value, [&] { return with_gravity_terms(chain, section.gravity, joints); });
}

std::vector<double> read_list(const YamlValue& listed) {
    std::vector<double> orders;
    for (const YamlValue& item : listed.list()) {
        orders.push_back(item.number());
        if (!(orders.back() >= 1e-3 && orders.back() <= 1e4)) {
            throw item.error("is " + quote(item.text()) + "; must be from 1e-3 to 1e4 a turn");
        }
        if (std::find(orders.begin(), orders.end() - 1, orders.back()) != orders.end() - 1) {
            throw item.error("is " + quote(item.text()) + " again; keep one");
        }
    }
    return orders;
}

/// "1..40": every whole number from the first to the last.
std::vector<double> read_range(const YamlValue& value) {
    const std::string text = value.text();
    const auto dots = text.find("..");
    const ParsedNumber first = parse_number(text.substr(0, dots));
    const ParsedNumber last =
        dots == std::string::npos ? ParsedNumber{} : parse_number(text.substr(dots + 2));
    const auto is_whole = [](const ParsedNumber& number) {
        return number.ok() && number.value >= 1 && number.value <= 1e4 &&
               number.value == std::floor(number.value);
    };
    if (dots == std::string::npos || !is_whole(first) || !is_whole(last) ||
        first.value > last.value) {
        throw value.error("is " + quote(text) +
                          "; must be a list of orders or a range of whole ones like 1..40");
    }
    std::vector<double> orders;
    for (double order = first.value; order <= last.value && orders.size() <= most_orders; ++order)
        orders.push_back(order);
    return orders;
}

/// `make` is with_harmonics() or with_axis_tilt().
template <typename Make>
Chain add_periodic(const YamlValue& value, const char* kind, const Chain& chain, const Make& make) {
    const YamlMap map(value, keys::terms, kind);
    const YamlValue listed = map.require("orders");
    const std::vector<double> orders = listed.is_list() ? read_list(listed) : read_range(listed);
    if (orders.empty() || orders.size() > most_orders) {
        throw listed.error("lists " + std::to_string(orders.size()) +
                           " orders; must be from 1 to 100");
    }
    const std::vector<Index> joints = read_joints(map, chain);
    return add(value, [&] { return make(chain, orders, joints); });
}

Chain add_gains(const YamlValue& value, const RobotSection& section) {
    const Chain& chain = section.declared;
    if (!value.is_map()) return value.boolean() ? with_gains(chain) : chain;
    const std::vector<Index> joints = read_joints(YamlMap(value, keys::terms, "gains"), chain);
    return add(value, [&] { return with_gains(chain, joints); });
}

double read_number_up_to(const YamlValue& value, double most, const char* unit) {
    constexpr double least = 1e-6;
    const double number = value.number();
    if (number >= least && number <= most) return number;
    throw value.error(
        fmt::format("is {}; must be from 1e-06 to {:g} {}", quote(value.text()), most, unit));
}

Load read_load(const YamlValue& value, Index link) {
    const YamlMap map(value, keys::weight);
    return {link, read_number_up_to(map.require("mass_kg"), 1e5, "kg"),
            map.require_measure("center").vector_to_si()};
}

/// Weights of the links and the payload.
std::vector<Load> read_loads(const YamlMap& map, const RobotSection& section) {
    std::vector<Load> loads;
    const auto links = map.find("links");
    if (links && links->is_map()) {
        for (const YamlEntry& entry : links->entries()) {
            const Index joint = find_joint(section.declared, entry.key, entry.key_location);
            loads.push_back(read_load(entry.value, joint + 1));
        }
    } else if (links) {
        if (links->is_list() || links->text() != "urdf") {
            throw links->error("must be a map of joints, or urdf for the masses of the URDF");
        }
        if (!section.urdf) throw links->error("is urdf, but the robot does not come from one");
        loads = read_urdf_loads(*section.urdf);
    }
    if (const auto payload = map.find("payload")) {
        loads.push_back(read_load(*payload, section.declared.joint_count() + 1));
    }
    return loads;
}

std::vector<MeasuredTorque> read_torques(const YamlValue& value, const Chain& chain) {
    std::vector<MeasuredTorque> torques;
    for (const YamlEntry& entry : value.entries()) {
        torques.push_back({find_joint(chain, entry.key, entry.key_location),
                           read_number_up_to(entry.value, 1e6, "N m")});
    }
    if (torques.empty()) throw value.error("is empty; must state the largest torque of joints");
    return torques;
}

Chain add_compliance(const YamlValue& value, const RobotSection& section) {
    const YamlMap map(value, keys::terms, "compliance");
    const Chain& chain = section.declared;
    if (const auto measured = map.find("torques_Nm")) {
        for (const char* const key : {"links", "payload", "direction", "joints"}) {
            if (const auto other = map.find(key)) {
                throw other->error(
                    "is stated beside torques_Nm; torques are measured or follow "
                    "from weights, keep one");
            }
        }
        const std::vector<MeasuredTorque> torques = read_torques(*measured, chain);
        return add(*measured, [&] { return with_measured_compliance(chain, torques); });
    }
    const std::vector<Load> loads = read_loads(map, section);
    if (loads.empty()) {
        throw value.error("states no weight; must have links, payload or torques_Nm");
    }
    const Vector3d direction = read_direction(map);
    const std::vector<Index> joints = read_joints(map, chain);
    return add(value, [&] { return with_compliance(chain, loads, direction, joints); });
}

}  // namespace

void add_stated_terms(const YamlMap& robot, RobotSection& section) {
    Chain& chain = section.declared;
    if (const auto gravity = robot.find("gravity")) add_gravity(*gravity, section);
    if (const auto stated = robot.find("harmonics"))
        chain = add_periodic(*stated, "harmonics", chain, with_harmonics);
    if (const auto stated = robot.find("axis_tilt"))
        chain = add_periodic(*stated, "axis_tilt", chain, with_axis_tilt);
    if (const auto stated = robot.find("gains")) chain = add_gains(*stated, section);
    if (const auto stated = robot.find("compliance")) chain = add_compliance(*stated, section);
}

}  // namespace posewise::detail
