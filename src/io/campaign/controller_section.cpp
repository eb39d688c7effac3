#include <fmt/format.h>

#include <algorithm>

#include "campaign_sections.hpp"
#include "element_notation.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "posewise/model/controller.hpp"

namespace posewise::detail {
namespace {

/// The controller's joints as they are read, the robot's own at first.
struct Sums {
    std::vector<std::string> names;
    MatrixXd from_model;
    VectorXd offset;
};

std::vector<std::string> names_of(const Chain& robot) {
    std::vector<std::string> names;
    for (const Joint& joint : robot.joints()) names.push_back(joint.name);
    return names;
}

/// J1, J2, ...
std::vector<std::string> numbered_names(Index count) {
    std::vector<std::string> names;
    for (Index i = 1; i <= count; ++i) names.push_back(fmt::format("J{}", i));
    return names;
}

void read_sum(const YamlValue& value, Index joint, const Chain& robot, Sums& sums) {
    const ElementParser parser(names_of(robot));
    const Element sum =
        parser.parse_joint_sum(value.text(), value.text_location(), robot.joint(joint).motion);
    sums.from_model.row(joint).setZero();
    for (const JointTerm& term : sum.joints) sums.from_model(joint, term.joint) = term.coefficient;
    sums.offset[joint] = sum.value;
}

void read_list(const YamlValue& joints, const Chain& robot, Sums& sums) {
    const std::vector<YamlValue> list = joints.list();
    if (std::ssize(list) != robot.joint_count()) {
        throw joints.error(fmt::format("lists {} joints; must list {}, as many as the robot has",
                                       list.size(), robot.joint_count()));
    }
    for (Index i = 0; i < robot.joint_count(); ++i) {
        read_sum(list[static_cast<std::size_t>(i)], i, robot, sums);
    }
}

/// All joints by names of their own, or some of J1, J2, ...
void read_map(const YamlValue& joints, const Chain& robot, Sums& sums) {
    const std::vector<YamlEntry> entries = joints.entries();
    const bool is_whole = std::ssize(entries) == robot.joint_count();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const auto& [name, location, value] = entries[i];
        auto joint = static_cast<Index>(i);
        if (is_whole) {
            if (!is_identifier(name)) {
                throw input_error_at(location, quote(name) +
                                                   " cannot name a joint; must be letters, digits "
                                                   "and underscores");
            }
            sums.names[i] = name;
        } else {
            const auto found = std::find(sums.names.begin(), sums.names.end(), name);
            if (found == sums.names.end()) {
                throw input_error_at(
                    location, quote(name) +
                                  " is no joint of the controller where not all are stated; " +
                                  suggest(name, sums.names));
            }
            joint = found - sums.names.begin();
        }
        read_sum(value, joint, robot, sums);
    }
}

Sums read_sums(const YamlValue& joints, const Chain& robot) {
    const Index n = robot.joint_count();
    Sums sums{numbered_names(n), MatrixXd::Identity(n, n), VectorXd::Zero(n)};
    if (!joints.is_map() && !joints.is_list()) {
        throw joints.error("must be a list of sums like 'q3 - q2', or a map like {J3: q3 - q2}");
    }
    joints.is_list() ? read_list(joints, robot, sums) : read_map(joints, robot, sums);
    return sums;
}

/// Per rad or m; empty where they are not stated.
VectorXd read_pulses(const YamlMap& map, const Chain& robot) {
    constexpr double most = 1e9;
    const auto pulses = map.find_measure("pulses_per");
    if (!pulses) return {};
    const auto count = static_cast<std::size_t>(robot.joint_count());
    const std::vector<double> numbers = pulses->value.numbers(count);
    VectorXd per_unit(robot.joint_count());
    for (std::size_t i = 0; i < count; ++i) {
        if (!(numbers[i] >= 1e-3 && numbers[i] <= most)) {
            throw pulses->value.error(
                fmt::format("has {} for joint {}; must be from 0.001 to 1e9: a reversed joint is "
                            "stated under joints",
                            numbers[i], i + 1));
        }
        const auto joint = static_cast<Index>(i);
        per_unit[joint] = robot.joint(joint).motion == Motion::Rotation
                              ? numbers[i] / pulses->unit->to_si(1)
                              : numbers[i] * mm_per_m;
    }
    return per_unit;
}

/// What `make` returns; what is wrong is said of `value`.
template <typename Make>
ControllerJoints make_at(const YamlValue& value, const Make& make) {
    try {
        return make();
    } catch (const InputError& problem) {
        throw value.error(std::string("cannot be: ") + problem.what());
    }
}

ControllerJoints read_family(const YamlMap& map, const YamlValue& maker, const Chain& robot) {
    const std::string word = maker.text();
    if (word != "fanuc") {
        throw maker.error("is " + quote(word) +
                          "; must be fanuc, the only family whose joints are known to be others "
                          "than a model's; state joints, or leave the section out");
    }
    const YamlValue factor = map.require("j23_factor");
    const double number = factor.number();
    if (number != -1 && number != 0 && number != 1) {
        throw factor.error("is " + quote(factor.text()) + "; must be -1, 0 or 1");
    }
    return make_at(maker, [&] { return fanuc_joints(robot, static_cast<int>(number)); });
}

}  // namespace

ControllerSection read_controller(const YamlValue& value, const Chain& robot) {
    const YamlMap map(value, keys::controller);
    const auto maker = map.find("maker");
    const auto joints = map.find("joints");
    if (maker && joints) {
        throw joints->error("is stated beside controller.maker; must be one of them");
    }
    if (const auto factor = map.find("j23_factor"); factor && !maker) {
        throw factor->error("is stated without maker: fanuc");
    }
    const VectorXd pulses = read_pulses(map, robot);
    const auto with_pulses = [&](const ControllerJoints& one) {
        return ControllerJoints(robot, one.names(), one.from_model(), one.offset(), pulses);
    };
    if (maker) return {with_pulses(read_family(map, *maker, robot)), maker->text()};
    if (!joints) return {with_pulses(ControllerJoints(robot))};
    const Sums sums = read_sums(*joints, robot);
    return {make_at(*joints, [&] {
        return ControllerJoints(robot, sums.names, sums.from_model, sums.offset, pulses);
    })};
}

}  // namespace posewise::detail
