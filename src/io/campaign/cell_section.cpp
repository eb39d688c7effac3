#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "campaign_sections.hpp"
#include "element_notation.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "measurement/cell_check.hpp"
#include "model/halton.hpp"
#include "model/joint_limits.hpp"

namespace posewise::detail {
namespace {

Vector3d point_to_si(const YamlValue& value, const Unit& unit) {
    return YamlMeasure{value, &unit}.vector_to_si();
}

double positive_to_si(const YamlValue& value, const Unit& unit) {
    return read_positive(YamlMeasure{value, &unit});
}

Vector3d read_direction(const YamlValue& value) {
    const std::vector<double> numbers = value.numbers(3);
    const Vector3d direction(numbers[0], numbers[1], numbers[2]);
    const double length = direction.stableNorm();
    if (!(length > 0)) throw value.error("has no direction; must not be zero");
    return direction / length;
}

Box read_box(const YamlValue& value, const Unit& unit) {
    const YamlMap map(value, keys::solid, "box");
    const Box box{point_to_si(map.require("min"), unit), point_to_si(map.require("max"), unit)};
    if (!(box.lower.array() < box.upper.array()).all()) {
        throw map.require("max").error("must be above min in x, y and z");
    }
    return box;
}

Sphere read_sphere(const YamlValue& value, const Unit& unit) {
    const YamlMap map(value, keys::solid, "sphere");
    return {point_to_si(map.require("center"), unit), positive_to_si(map.require("radius"), unit)};
}

Capsule read_capsule(const YamlValue& value, const Unit& unit) {
    const YamlMap map(value, keys::solid, "capsule");
    return {point_to_si(map.require("from"), unit), point_to_si(map.require("to"), unit),
            positive_to_si(map.require("radius"), unit)};
}

HalfSpace read_half_space(const YamlValue& value) {
    const YamlMap map(value, keys::solid, "half_space");
    return {map.require_measure("point").vector_to_si(), read_direction(map.require("normal"))};
}

KeepOut read_keep_out(const YamlValue& value) {
    const YamlMap map(value, keys::keep_out);
    const auto name = map.find("name");
    std::vector<Shape> solids;
    if (const auto box = map.find_measure("box"))
        solids.push_back(read_box(box->value, *box->unit));
    if (const auto sphere = map.find_measure("sphere")) {
        solids.push_back(read_sphere(sphere->value, *sphere->unit));
    }
    if (const auto capsule = map.find_measure("capsule")) {
        solids.push_back(read_capsule(capsule->value, *capsule->unit));
    }
    if (const auto plane = map.find("half_space")) solids.push_back(read_half_space(*plane));
    if (solids.size() != 1) {
        throw value.error("states " + std::to_string(solids.size()) +
                          " solids; must state one: box_mm, sphere_mm, capsule_mm or half_space");
    }
    return {name ? name->text() : value.name(), solids.front()};
}

std::vector<std::string> names_of_joints(const Chain& robot) {
    std::vector<std::string> names;
    for (const Joint& joint : robot.joints()) names.push_back(joint.name);
    return names;
}

/// Index of a joint by its name, at `location`.
Index find_joint(const Chain& robot, const std::string& name, const FileLocation& location) {
    const std::vector<std::string> names = names_of_joints(robot);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        throw input_error_at(location,
                             quote(name) + " is no joint of this robot; " + suggest(name, names));
    }
    return found - names.begin();
}

Index read_frame(const YamlValue& after, const Chain& robot) {
    if (after.text() == "base") return 0;
    if (after.text() == "flange") return robot.joint_count() + 1;
    std::vector<std::string> known{"base", "flange"};
    for (const std::string& name : names_of_joints(robot)) known.push_back(name);
    if (std::find(known.begin(), known.end(), after.text()) == known.end()) {
        throw after.error("is " + quote(after.text()) + ", which is no frame of this robot; " +
                          suggest(after.text(), known));
    }
    return find_joint(robot, after.text(), after.location()) + 1;
}

Link read_link(const YamlValue& value, const Chain& robot) {
    const YamlMap map(value, keys::link);
    const YamlValue after = map.require("after");
    const auto name = map.find("name");
    return {name ? name->text() : "after " + after.text(), read_frame(after, robot),
            Capsule{map.require_measure("from").vector_to_si(),
                    map.require_measure("to").vector_to_si(),
                    read_positive(map.require_measure("radius"))}};
}

Interval read_interval(const YamlMeasure& measure) {
    const VectorXd ends = measure.list_to_si(2);
    if (ends[0] >= ends[1]) {
        throw measure.value.error("is not in order; the lower end must come first");
    }
    return {ends[0], ends[1]};
}

void read_tracker(const YamlValue& value, Sight& sight) {
    const YamlMap map(value, keys::sight, "tracker");
    if (const auto range = map.find_measure("range")) {
        sight.range = read_interval(*range);
        if (sight.range.lower < 0) throw range->value.error("must not be negative");
    }
    if (const auto azimuth = map.find_measure("azimuth")) {
        sight.azimuth = read_interval(*azimuth);
        if (sight.azimuth.upper - sight.azimuth.lower > 2 * std::numbers::pi * (1 + 1e-12)) {
            throw azimuth->value.error("is wider than a full turn");
        }
    }
    if (const auto elevation = map.find_measure("elevation")) {
        sight.elevation = read_interval(*elevation);
        constexpr double upright = std::numbers::pi / 2 * (1 + 1e-12);
        if (sight.elevation.lower < -upright || sight.elevation.upper > upright) {
            const double up = elevation->unit->from_si(std::numbers::pi / 2);
            throw elevation->value.error(
                fmt::format("must lie from {:g} to {:g} {}: straight down to straight up", -up, up,
                            elevation->unit->name));
        }
    }
    if (const auto line = map.find("line_of_sight")) sight.is_line_required = line->boolean();
}

void read_reflectors(const YamlValue& value, Index target_count, Sight& sight) {
    const YamlMap map(value, keys::sight, "reflectors");
    if (const auto angle = map.find_measure("acceptance_half_angle")) {
        sight.acceptance_half_angle = read_positive(*angle);
        if (sight.acceptance_half_angle > std::numbers::pi) {
            throw angle->value.error("must be at most half a turn");
        }
    }
    if (const auto normals = map.find("normals")) {
        for (const YamlValue& item : normals->list()) {
            sight.normals.push_back(read_direction(item));
        }
        if (static_cast<Index>(sight.normals.size()) != target_count) {
            throw normals->error("has " + std::to_string(sight.normals.size()) +
                                 " directions; must have " + std::to_string(target_count) +
                                 ", one for each target of the sensor");
        }
    }
    if (const auto least = map.find("at_least_visible")) {
        sight.least_visible = static_cast<Index>(least->natural_number(
            1, static_cast<std::uint64_t>(target_count), ", the number of targets"));
    }
}

/// One value a joint, all of which must turn.
VectorXd read_joint_angles(const YamlMeasure& measure, const Chain& robot) {
    VectorXd angles = measure.list_to_si(static_cast<std::size_t>(robot.joint_count()));
    for (Index j = 0; j < angles.size(); ++j) {
        if (robot.joint(j).motion != Motion::Rotation) {
            throw measure.value.error("is in '" + std::string(measure.unit->name) +
                                      "', but joint '" +
                                      robot.joints()[static_cast<std::size_t>(j)].name +
                                      "' slides; only for robots whose joints all turn");
        }
    }
    return angles;
}

void read_fixed(const YamlValue& value, const Chain& robot, Cell& cell) {
    for (const YamlEntry& entry : value.entries()) {
        const Index index = find_joint(robot, entry.key, entry.key_location);
        const double amount =
            read_amount(entry.value, quantity_of(robot.joint(index).motion), Sign::Any);
        const Joint& joint = robot.joints()[static_cast<std::size_t>(index)];
        if (amount < joint.lower || amount > joint.upper) {
            throw entry.value.error("is " + quote(entry.value.text()) +
                                    "; must lie within the joint's limits");
        }
        cell.fixed_joints[index] = amount;
    }
}

/// What a limit is of: a sum of the robot's joints, or a joint of the controller, which is one.
Element parse_limited(const YamlEntry& entry, bool turns, const Chain& robot,
                      const ControllerJoints& controller) {
    const std::vector<std::string> names = names_of_joints(robot);
    const auto& shown = controller.names();
    const auto found = std::find(shown.begin(), shown.end(), trim(entry.key));
    const Motion motion = turns ? Motion::Rotation : Motion::Translation;
    const bool is_same = controller.is_identity() && shown == names;
    if (found == shown.end() || is_same) {
        const ElementParser parser(names, is_same ? std::vector<std::string>() : shown);
        return parser.parse_joint_sum(entry.key, entry.key_location, motion);
    }
    if (std::find(names.begin(), names.end(), *found) != names.end()) {
        throw input_error_at(entry.key_location,
                             quote(*found) +
                                 " names a joint of the robot and one of the controller; must be "
                                 "one: call the controller's joints otherwise");
    }
    const Index row = found - shown.begin();
    Element element;
    element.motion = motion;
    element.value = controller.offset()[row];
    for (Index j = 0; j < controller.count(); ++j) {
        const double coefficient = controller.from_model()(row, j);
        if (coefficient != 0) element.joints.push_back({j, coefficient});
    }
    return element;
}

/// Of joints that all turn, in degrees or mm: "q3 - q2: {limits_deg: [-80, 90]}".
JointSum read_joint_sum(const YamlEntry& entry, const Chain& robot,
                        const ControllerJoints& controller, const JointMargin& margin) {
    const YamlMap map(entry.value, keys::joint_sum);
    const YamlMeasure limits = map.require_measure("limits");
    const bool turns = limits.unit->quantity == Quantity::Angle;
    const Element parsed = parse_limited(entry, turns, robot, controller);
    JointSum sum{entry.key, VectorXd::Zero(robot.joint_count()), read_interval(limits),
                 parsed.value};
    for (const JointTerm& term : parsed.joints) {
        sum.coefficients[term.joint] = term.coefficient;
        if (robot.joint(term.joint).motion != parsed.motion) {
            throw limits.value.error(
                fmt::format("is in '{}', but '{}' {}", limits.unit->name, entry.key,
                            turns ? "slides; must be in mm or m" : "turns; must be in deg or rad"));
        }
    }
    sum.limits.lower -= sum.offset;
    sum.limits.upper -= sum.offset;
    const double kept = turns ? margin.angle : margin.length;
    if (!(sum.limits.upper - sum.limits.lower > 2 * kept)) {
        throw limits.value.error(
            fmt::format("is not wider than twice cell.{}, which is kept from either end; must be, "
                        "or the margin smaller",
                        turns ? "margin" : "slide_margin"));
    }
    return sum;
}

/// Rates of all joints, such as speed_deg_per_s; of joints that all turn.
VectorXd read_rates(const YamlMap& map, const std::string& name, const std::string& per,
                    const Chain& robot) {
    VectorXd rates;
    for (const char* const unit : {"deg", "rad"}) {
        const auto stated = map.find(fmt::format("{}_{}_per_{}", name, unit, per));
        if (!stated) continue;
        if (rates.size() != 0) throw stated->error("is stated in two units; keep one");
        rates = read_joint_angles({*stated, find_unit(unit)}, robot);
        if (!(rates.array() > 0).all()) throw stated->error("must be positive for every joint");
        constexpr double fastest = 35;                     // rad/s, 2000 deg/s
        constexpr double slowest_rise = to_radians(0.01);  // rad/s^2
        constexpr double fastest_rise = to_radians(1e5);
        if (per == "s2" &&
            !(rates.minCoeff() >= slowest_rise && rates.maxCoeff() <= fastest_rise)) {
            throw stated->error("is beyond 0.01 to 100000 deg/s^2, which no joint has; is it in " +
                                std::string(unit) + "/s^2?");
        }
        if (per == "s" && rates.maxCoeff() > fastest) {
            throw stated->error("is beyond 2000 deg/s, which no joint has; is it in deg/s?");
        }
    }
    return rates;
}

/// s, from 0 to a day.
double read_standstill(const YamlMap& map, const char* key) {
    const auto stated = map.find(key);
    if (!stated) return 0;
    constexpr double day = 86400;
    const double seconds = stated->number();
    if (!(seconds >= 0 && seconds <= day)) {
        throw stated->error("is " + stated->text() + "; must be from 0 to 86400");
    }
    return seconds;
}

void read_motion(const YamlMap& map, const Chain& robot, Cell& cell) {
    if (const auto home = map.find_measure("home")) {
        cell.home = read_joint_angles(*home, robot);
        const std::string violation = describe_limit_violation(robot, cell.home);
        if (!violation.empty()) {
            throw home->value.error("is beyond the joint limits: " + violation);
        }
        const std::string sums = describe_sums(cell, robot, cell.home);
        if (!sums.empty()) throw home->value.error("is beyond joint_sums: " + sums);
    }
    cell.speed = read_rates(map, "speed", "s", robot);
    cell.acceleration = read_rates(map, "acceleration", "s2", robot);
    cell.dwell = read_standstill(map, "dwell_s");
    cell.settle = read_standstill(map, "settle_s");
    cell.target_change = read_standstill(map, "target_change_s");
    if (const auto stations = map.find("stations")) {
        const double count = stations->number();
        if (!(count >= 1 && count <= 100 && count == std::floor(count))) {
            throw stations->error("is " + stations->text() +
                                  "; must be a whole number from 1 to 100");
        }
        cell.stations = static_cast<Index>(count);
    }
    cell.station_change = read_standstill(map, "station_change_s");
}

void read_solids(const YamlMap& map, const Chain& robot, Cell& cell) {
    if (const auto boxes = map.find_measure("target_boxes")) {
        for (const YamlValue& item : boxes->value.list()) {
            cell.target_boxes.push_back(read_box(item, *boxes->unit));
        }
    }
    if (const auto floor = map.find_measure("floor_z")) {
        constexpr double farthest = 100;  // m
        if (std::abs(floor->to_si()) > farthest) {
            throw floor->value.error("is over 100 m from the base; is it in mm?");
        }
        cell.keep_outs.push_back(
            {"floor", HalfSpace{Vector3d(0, 0, floor->to_si()), Vector3d::UnitZ()}});
    }
    if (const auto keep_outs = map.find("keep_out")) {
        for (const YamlValue& item : keep_outs->list()) {
            cell.keep_outs.push_back(read_keep_out(item));
        }
    }
    if (const auto links = map.find("links")) {
        for (const YamlValue& item : links->list()) cell.links.push_back(read_link(item, robot));
    }
    if (const auto distance = map.find_measure("safety_distance")) {
        cell.safety_distance = read_positive(*distance, true);
    }
}

/// The limits less their margin; where that is impossible, the margin's fault.
void read_margin(const YamlMap& map, const Chain& robot, Cell& cell) {
    const auto angle = map.find_measure("margin");
    const auto length = map.find_measure("slide_margin");
    if (angle) cell.limit_margin.angle = read_positive(*angle, true);
    if (length) cell.limit_margin.length = read_positive(*length, true);
    try {
        detail::with_margin(robot, cell.limit_margin);
    } catch (const InputError& problem) {
        throw(angle ? angle : length)->value.error(std::string("is too large: ") + problem.what());
    }
}

}  // namespace

Cell read_cell(const YamlValue& value, const Chain& robot, const Sensor& sensor,
               const ControllerJoints& controller) {
    const YamlMap map(value, keys::cell);
    Cell cell;
    read_margin(map, robot, cell);
    if (const auto sums = map.find("joint_sums")) {
        for (const YamlEntry& entry : sums->entries()) {
            cell.joint_sums.push_back(read_joint_sum(entry, robot, controller, cell.limit_margin));
        }
    }
    if (const auto fixed = map.find("fixed")) read_fixed(*fixed, robot, cell);
    if (const auto least = map.find_measure("least_joint_distance")) {
        cell.least_joint_distance = read_positive(*least, true);
    }
    read_solids(map, robot, cell);
    const auto tracker = map.find("tracker");
    const auto reflectors = map.find("reflectors");
    if (tracker || reflectors) cell.sight = Sight{};
    if (cell.sight && sensor.is_combined()) {
        throw(tracker ? tracker : reflectors)
            ->error(
                "states what one instrument can see, but there are several sensors; must be "
                "left out");
    }
    if (cell.sight && sensor.has_contacts()) {
        throw(tracker ? tracker : reflectors)
            ->error(
                "states what an instrument can see, but a ball in sockets is seen by none; "
                "must be left out");
    }
    if (tracker) read_tracker(*tracker, *cell.sight);
    if (reflectors) read_reflectors(*reflectors, sensor.target_count(), *cell.sight);
    read_motion(map, robot, cell);
    return cell;
}

}  // namespace posewise::detail
