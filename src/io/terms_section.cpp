#include <algorithm>
#include <cmath>

#include "posewise/model/error_terms.hpp"
#include "robot_parts.hpp"
#include "text.hpp"

namespace posewise::io {
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

/// Indices of the joints listed under `joints`; empty if the key is not there.
std::vector<Index> read_joints(const YamlMap& map, const Chain& chain) {
    std::vector<Index> joints;
    const auto listed = map.find("joints");
    if (!listed) return joints;
    std::vector<std::string> names;
    for (const Joint& joint : chain.joints()) names.push_back(joint.name);
    for (const YamlValue& item : listed->list()) {
        const std::string name = item.text();
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            throw item.error("is " + quote(name) + ", no joint of the robot; " +
                             suggest(name, names));
        }
        joints.push_back(found - names.begin());
    }
    if (joints.empty()) throw listed->error("is empty; must list joints, or be left out for all");
    return joints;
}

Chain add_gravity(const YamlValue& value, const Chain& chain) {
    Vector3d direction = -Vector3d::UnitZ();
    std::vector<Index> joints;
    if (value.is_map()) {
        const YamlMap map(value, {"direction", "joints"});
        if (const auto stated = map.find("direction")) {
            const std::vector<double> numbers = stated->numbers(3);
            direction = Eigen::Map<const Vector3d>(numbers.data());
        }
        joints = read_joints(map, chain);
    } else if (!value.boolean()) {
        return chain;
    }
    return add(value, [&] { return with_gravity_terms(chain, direction, joints); });
}

std::vector<double> read_list(const YamlValue& listed) {
    std::vector<double> orders;
    for (const YamlValue& item : listed.list()) {
        orders.push_back(item.number());
        if (!(orders.back() >= 1e-3 && orders.back() <= 1e4)) {
            throw item.error("is " + quote(item.text()) + "; must be from 1e-3 to 1e4 a turn");
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

Chain add_harmonics(const YamlValue& value, const Chain& chain) {
    const YamlMap map(value, {"orders", "joints"});
    const YamlValue listed = map.require("orders");
    const std::vector<double> orders = listed.is_list() ? read_list(listed) : read_range(listed);
    if (orders.empty() || orders.size() > most_orders) {
        throw listed.error("lists " + std::to_string(orders.size()) +
                           " orders; must be from 1 to 100");
    }
    const std::vector<Index> joints = read_joints(map, chain);
    return add(value, [&] { return with_harmonics(chain, orders, joints); });
}

}  // namespace

Chain add_stated_terms(const YamlMap& robot, const Chain& chain) {
    Chain result = chain;
    if (const auto gravity = robot.find("gravity")) result = add_gravity(*gravity, result);
    if (const auto harmonics = robot.find("harmonics")) result = add_harmonics(*harmonics, result);
    return result;
}

}  // namespace posewise::io
