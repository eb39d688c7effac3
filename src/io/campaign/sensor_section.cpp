#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "campaign_sections.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {
namespace {

/// Places for targets that the file does not state: a spiral about the flange's x axis, 0.2 to
/// 0.3 m away, no three of them in line.
Vector3d generic_target(std::size_t index) {
    constexpr double golden_angle = 2.399963229728653;
    const auto turns = static_cast<double>(index);
    const double along = 0.15 + 0.1 * std::fmod(0.618 * turns, 1.0);
    return {along, 0.15 * std::cos(golden_angle * turns), 0.15 * std::sin(golden_angle * turns)};
}

constexpr std::size_t most_targets = 1000;

std::vector<Vector3d> generic_targets(const YamlValue& count) {
    const std::uint64_t number = count.natural_number(1, most_targets);
    std::vector<Vector3d> targets;
    while (targets.size() < number) targets.push_back(generic_target(targets.size()));
    return targets;
}

constexpr double least_apart = 1e-3;  // m: no two reflectors fit into a millimetre

/// Metres read as millimetres do.
void check_apart(const YamlMeasure& positions, const std::vector<Vector3d>& stated,
                 const std::string& of_what) {
    for (std::size_t k = 0; k < stated.size(); ++k) {
        for (std::size_t i = 0; i < k; ++i) {
            const double distance = (stated[k] - stated[i]).norm();
            if (distance >= least_apart) continue;
            throw positions.value.error(
                fmt::format("puts {0}s {1} and {2} at one place, {3:.3g} mm apart; must be places "
                            "of their own{4}",
                            of_what, i + 1, k + 1, 1e3 * distance,
                            positions.unit->name != "m" && distance > 0
                                ? ": are they in m? Then the key is position_m"
                                : ""));
        }
    }
}

std::vector<Vector3d> stated_positions(const YamlMeasure& positions, const std::string& of_what) {
    const std::vector<YamlValue> items = positions.value.list();
    if (items.empty()) throw positions.value.error("is empty; must list at least one " + of_what);
    if (items.size() > most_targets) {
        throw positions.value.error(
            fmt::format("lists {} {}s; must be at most {}", items.size(), of_what, most_targets));
    }
    std::vector<Vector3d> stated;
    for (const YamlValue& item : items) {
        stated.push_back(YamlMeasure{item, positions.unit}.vector_to_si());
    }
    check_apart(positions, stated, of_what);
    return stated;
}

/// `sigma_mm`, one number or one for each axis, or `noise`, a laser tracker's.
PointNoise read_noise(const YamlValue& value, const YamlMap& sensor) {
    const auto noise = sensor.find("noise");
    const auto sigma = sensor.find_measure("sigma");
    if (noise.has_value() == sigma.has_value()) {
        throw value.error("must have either sigma_mm or noise");
    }
    if (noise) {
        const YamlMap tracker(*noise, keys::noise, "points");
        return LaserTrackerNoise{read_positive(tracker.require_measure("range")),
                                 read_positive(tracker.require_measure("angle"))};
    }
    if (!sigma->value.is_list()) return IsotropicNoise{read_positive(*sigma)};
    PerAxisNoise axes;
    const std::vector<YamlValue> items = sigma->value.list();
    if (items.size() != 3) throw sigma->value.error("must be one number, or three for x, y and z");
    for (std::size_t k = 0; k < 3; ++k) {
        axes.sigma[static_cast<Index>(k)] = read_positive({items[k], sigma->unit});
    }
    return axes;
}

/// Standard deviation of a sensor that returns lengths.
double read_sigma(const YamlMap& sensor) { return read_positive(sensor.require_measure("sigma")); }

// ---- Targets ----

struct TargetsSection {
    Targets targets;
    VectorXd unknowns;
    bool has_positions;
};

std::array<bool, 3> read_known_axes(const std::optional<YamlValue>& known) {
    if (!known) return {};
    const std::vector<bool> marks = read_known(*known, {"x", "y", "z"});
    return {marks[0], marks[1], marks[2]};
}

/// How large the balls at the targets are, where they are balls.
enum class Body { Ball, None };

TargetsSection read_targets(const YamlValue& value, Body body) {
    const YamlMap targets(value, keys::places, "targets");
    const auto positions = targets.find_measure("position");
    const auto count = targets.find("count");
    if (positions.has_value() == count.has_value()) {
        throw value.error("must have either count or position_mm");
    }
    const auto known = targets.find("known");
    const std::array<bool, 3> is_known = read_known_axes(known);
    if (!positions && std::any_of(is_known.begin(), is_known.end(), [](bool b) { return b; })) {
        throw known->error("says that positions are known; needs position_mm, not count");
    }
    const std::vector<Vector3d> nominal =
        positions ? stated_positions(*positions, "target") : generic_targets(*count);
    Targets found(nominal, std::vector<std::array<bool, 3>>(nominal.size(), is_known));
    if (const auto radius = targets.find_measure("radius")) {
        if (body == Body::None) {
            throw radius->value.error(
                "is stated, but only targets of points and distances have a body; must be left "
                "out");
        }
        constexpr double largest = 1;  // m
        found = found.with_radius(read_positive(*radius, true, largest));
    }
    VectorXd unknowns(found.unknown_count());
    for (Index j = 0; j < found.count(); ++j) {
        for (Index axis = 0; axis < 3; ++axis) {
            const Index k = found.unknown_index(j, axis);
            if (k >= 0) unknowns[k] = nominal[static_cast<std::size_t>(j)][axis];
        }
    }
    return {std::move(found), std::move(unknowns), positions.has_value()};
}

// ---- Kinds of sensors ----

SensorSection read_points(const YamlValue& value) {
    const YamlMap sensor(value, keys::sensor, "points");
    const PointNoise noise = read_noise(value, sensor);
    TargetsSection targets = read_targets(sensor.require("targets"), Body::Ball);
    return {std::make_shared<PointSensor>(std::move(targets.targets), noise), targets.unknowns,
            targets.has_positions};
}

/// What a camera recorded of a board, and where it sat.
PoseRecord read_record(const YamlMap& sensor) {
    const auto camera = sensor.find("camera");
    const auto measured = sensor.find("measured");
    if (!camera) {
        if (!measured) return {};
        throw measured->error("is of a camera; needs camera: flange or fixed");
    }
    const auto is_first = [](const YamlValue& value, const char* first, const char* second) {
        if (value.is_text(first)) return true;
        if (value.is_text(second)) return false;
        throw value.error(
            fmt::format("is {}; must be {} or {}", quote(value.text()), first, second));
    };
    const bool is_on_flange = is_first(*camera, "flange", "fixed");
    const bool is_board_seen =
        !measured || is_first(*measured, "board_in_camera", "camera_in_board");
    return {.is_inverse = is_on_flange == is_board_seen, .is_made_at_body = is_on_flange};
}

SensorSection read_poses(const YamlValue& value) {
    const YamlMap sensor(value, keys::sensor, "poses");
    const PointNoise noise = read_noise(value, sensor);
    const PoseRecord record = read_record(sensor);
    if (record.is_made_at_body && std::holds_alternative<LaserTrackerNoise>(noise)) {
        throw sensor.require("noise").error(
            "is a laser tracker's, which is not on the flange; must be sigma_mm with a camera");
    }
    const double sigma = read_positive(sensor.require_measure("sigma_orientation"));
    const auto tool_value = sensor.find("tool");
    if (!tool_value) {
        // Generic: its origin is on no axis.
        Isometry3d somewhere = Isometry3d::Identity();
        somewhere.translation() = generic_target(0);
        return {std::make_shared<PoseSensor>(std::nullopt, noise, sigma, record),
                tool_unknowns(somewhere), false};
    }
    const YamlMap tool(*tool_value, keys::places, "tool");
    const Isometry3d nominal = read_frame(tool);
    if (is_true(tool, "known")) {
        return {std::make_shared<PoseSensor>(nominal, noise, sigma, record), VectorXd(), true};
    }
    return {std::make_shared<PoseSensor>(std::nullopt, noise, sigma, record),
            tool_unknowns(nominal), true};
}

VectorXd join(const VectorXd& first, const VectorXd& second) {
    VectorXd joined(first.size() + second.size());
    joined << first, second;
    return joined;
}

SensorSection read_distances(const YamlValue& value) {
    const YamlMap sensor(value, keys::sensor, "distances");
    const YamlMap anchors(sensor.require("anchors"), keys::places, "anchors");
    const std::vector<Vector3d> positions =
        stated_positions(anchors.require_measure("position"), "anchor");
    TargetsSection targets = read_targets(sensor.require("targets"), Body::Ball);
    VectorXd own(is_true(anchors, "known") ? 0 : 3 * static_cast<Index>(positions.size()));
    for (Index k = 0; k < own.size(); ++k)
        own[k] = positions[static_cast<std::size_t>(k / 3)][k % 3];
    return {std::make_shared<DistanceSensor>(std::move(targets.targets), positions,
                                             is_true(anchors, "known"), read_sigma(sensor)),
            join(targets.unknowns, own), targets.has_positions};
}

/// With what the list's own key says of all planes, if the plane says nothing of itself.
Plane read_plane(const YamlValue& value, bool are_known) {
    const YamlMap map(value, keys::places, "plane");
    const YamlValue normal = map.require("normal");
    const std::vector<double> xyz = normal.numbers(3);
    const auto known = map.find("known");
    const std::vector<bool> is_known =
        known ? read_known(*known, {"normal", "offset"}) : std::vector<bool>(2, are_known);
    const YamlMeasure offset = map.require_measure("offset");
    const Plane plane{{xyz[0], xyz[1], xyz[2]}, offset.to_si(), is_known[0], is_known[1]};
    constexpr double farthest = 1e3;  // m
    if (std::abs(plane.offset) > farthest) {
        throw offset.value.error(
            fmt::format("is {}; must be within 1 km of the origin", quote(offset.value.text())));
    }
    const double length = plane.normal.stableNorm();
    if (!(length > 1e-9 && length < 1e9)) {
        throw normal.error(fmt::format(
            "is of length {:g}; must point away from the face, its length from 1e-09 to 1e+09",
            length));
    }
    return plane;
}

SensorSection read_planes(const YamlValue& value) {
    const YamlMap sensor(value, keys::sensor, "planes");
    const YamlValue list = sensor.require("planes");
    const bool are_known = is_true(sensor, "known_planes");
    std::vector<Plane> planes;
    std::vector<double> own;
    for (const YamlValue& item : list.list()) {
        planes.push_back(read_plane(item, are_known));
        if (!planes.back().normal_is_known) own.insert(own.end(), {0, 0});
        if (!planes.back().offset_is_known) own.push_back(planes.back().offset);
    }
    if (planes.empty()) throw list.error("is empty; must list at least one plane");
    TargetsSection targets = read_targets(sensor.require("targets"), Body::None);
    const Eigen::Map<const VectorXd> unknowns(own.data(), std::ssize(own));
    return {std::make_shared<PlaneSensor>(std::move(targets.targets), planes, read_sigma(sensor)),
            join(targets.unknowns, unknowns), targets.has_positions};
}

// ---- Sockets ----

/// Places for sockets that the file does not state, all different.
Vector3d generic_socket(std::size_t index) { return Vector3d(0.5, 0, 0.2) + generic_target(index); }

Socket read_socket(const YamlValue& value, const std::vector<Socket>& before, bool& has_position) {
    const YamlMap map(value, keys::places, "socket");
    Socket socket;
    const YamlValue name = map.require("name");
    socket.name = name.text();
    const auto is_called = [](const std::string& called) {
        return [&called](const Socket& other) { return other.name == called; };
    };
    if (socket.name.empty() || socket.name.find_first_of(", \t\"'") != std::string::npos) {
        throw name.error("is " + quote(socket.name) + "; must be one word");
    }
    if (std::any_of(before.begin(), before.end(), is_called(socket.name))) {
        throw name.error("is " + quote(socket.name) + " as of another socket; must be its own");
    }
    const auto position = map.find_measure("position");
    has_position = position.has_value();
    socket.position = position ? position->vector_to_si() : generic_socket(before.size());
    const auto from = map.find("from");
    const auto distance = map.find_measure("distance");
    if (from.has_value() != distance.has_value()) {
        throw value.error("must have both from and distance_mm, or none of them");
    }
    if (!from) return socket;
    const std::string other = from->text();
    const auto found = std::find_if(before.begin(), before.end(), is_called(other));
    if (found == before.end()) {
        throw from->error("is " + quote(other) + "; must be a socket listed before this one");
    }
    socket.from = found - before.begin();
    socket.distance = read_positive(*distance);
    return socket;
}

struct SocketsSection {
    std::vector<Socket> sockets;
    std::vector<bool> has_position;  ///< whether it was stated, not made up
};

SocketsSection read_socket_list(const YamlValue& list) {
    constexpr std::size_t most = 100;
    SocketsSection section;
    const std::vector<YamlValue> items = list.list();
    if (items.size() > most) {
        throw list.error(fmt::format("lists {} sockets; must be at most {}", items.size(), most));
    }
    for (const YamlValue& item : items) {
        bool has_position = false;
        section.sockets.push_back(read_socket(item, section.sockets, has_position));
        section.has_position.push_back(has_position);
    }
    if (section.sockets.empty()) throw list.error("is empty; must list at least one socket");
    return section;
}

/// What is stated of a socket's place against those before it; `tolerance` (m) of a distance.
void check_socket_place(const YamlValue& value, const SocketsSection& section, std::size_t k,
                        double tolerance) {
    const Socket& socket = section.sockets[k];
    for (std::size_t i = 0; i < k; ++i) {
        if (!section.has_position[i] || !section.has_position[k]) continue;
        const Socket& other = section.sockets[i];
        const double apart = (socket.position - other.position).norm();
        if (apart < least_apart) {
            throw value.error(
                fmt::format("is at the place of socket {}, {:.3g} mm apart; must be "
                            "at a place of its own",
                            quote(other.name), 1e3 * apart));
        }
        const bool is_from = socket.from == static_cast<Index>(i);
        if (!is_from || std::abs(apart - socket.distance) <= tolerance) continue;
        throw value.error(
            fmt::format("is stated {:.6g} mm from {}, and by position_mm {:.6g} mm; "
                        "must agree within {:g} mm",
                        1e3 * socket.distance, quote(other.name), 1e3 * apart, 1e3 * tolerance));
    }
}

SensorSection read_sockets(const YamlValue& value) {
    const YamlMap sensor(value, keys::sensor, "sockets");
    const YamlValue list = sensor.require("sockets");
    const SocketsSection section = read_socket_list(list);
    const bool are_known = is_true(sensor, "known_sockets");
    const auto& stated = section.has_position;
    const bool has_positions = std::all_of(stated.begin(), stated.end(), [](bool b) { return b; });
    if (are_known && !has_positions) {
        throw sensor.require("known_sockets").error("is true; needs position_mm of every socket");
    }
    constexpr double roughly = 0.1;  // m
    constexpr double exactly = 1e-3;
    for (std::size_t k = 0; k < section.sockets.size(); ++k) {
        check_socket_place(list.list()[k], section, k, are_known ? exactly : roughly);
    }
    const YamlValue targets_value = sensor.require("targets");
    TargetsSection targets = read_targets(targets_value, Body::None);
    if (targets.targets.count() != 1) {
        throw targets_value.error(
            fmt::format("are {}; must be one, the ball", targets.targets.count()));
    }
    auto result = std::make_shared<SocketSensor>(std::move(targets.targets), section.sockets,
                                                 are_known, read_sigma(sensor));
    VectorXd unknowns = VectorXd::Zero(std::ssize(result->unknown_names()));
    unknowns.head(targets.unknowns.size()) = targets.unknowns;
    std::vector<Index> reached;
    Index next = targets.unknowns.size();
    for (std::size_t k = 0; k < section.sockets.size() && !are_known; ++k) {
        const bool is_free = section.sockets[k].from < 0;
        if (is_free) unknowns.segment<3>(next) = section.sockets[k].position;
        if (is_free && !section.has_position[k]) reached.push_back(next);
        next += is_free ? 3 : 2;
    }
    return {std::move(result), std::move(unknowns), targets.has_positions && has_positions,
            !are_known, std::move(reached)};
}

/// A sensor by its kind; its keys depend on it.
using ReadKind = SensorSection (*)(const YamlValue&);
constexpr std::array<std::pair<std::string_view, ReadKind>, 6> kinds{{{"points", read_points},
                                                                      {"poses", read_poses},
                                                                      {"camera", read_camera},
                                                                      {"distances", read_distances},
                                                                      {"planes", read_planes},
                                                                      {"sockets", read_sockets}}};

YamlValue kind_of(const YamlValue& sensor) {
    const auto kind = find_of(sensor, "kind");
    return kind ? *kind : YamlMap(sensor, keys::sensor).require("kind");
}

SensorSection read_kind(const YamlValue& value) {
    const YamlValue kind = kind_of(value);
    const std::string name = kind.text();
    std::vector<std::string> names;
    for (const auto& [known, read] : kinds) {
        if (name == known) return read(value);
        names.emplace_back(known);
    }
    throw kind.error("is " + quote(name) + "; " + suggest(name, names));
}

const CameraSensor* as_camera(const std::vector<SensorPart>& parts, Index part) {
    return dynamic_cast<const CameraSensor*>(parts[static_cast<std::size_t>(part)].sensor.get());
}

/// Which of the sensors before it a further one is a camera of, by its number; nothing: of none.
std::optional<Index> read_same_camera(const YamlValue& sensor,
                                      const std::vector<SensorPart>& before) {
    const auto value = find_of(sensor, "same_camera");
    if (!value) return std::nullopt;
    if (before.empty()) throw value->error("is of the first sensor; must be left out");
    const auto number = static_cast<Index>(
        value->natural_number(1, before.size(), ", the number of a sensor before this one"));
    if (as_camera(before, number - 1) != nullptr &&
        !before[static_cast<std::size_t>(number - 1)].same_camera) {
        return number - 1;
    }
    throw value->error(
        fmt::format("is {}; must be the number of a sensor of kind camera before this one, which "
                    "has intrinsics of its own",
                    number));
}

/// Where a further sensor's frame is in the first one's.
struct FrameSection {
    std::optional<Isometry3d> known;
    Isometry3d nominal = Isometry3d::Identity();
    bool is_stated = false;
};

FrameSection read_sensor_frame(const YamlValue& sensor, bool is_first) {
    const auto value = find_of(sensor, "frame");
    const Isometry3d same = Isometry3d::Identity();
    if (is_first && value) {
        throw value->error("is of the first sensor, whose frame is the world; must be left out");
    }
    if (is_first) return {same, same, true};
    if (!value) return {};
    if (value->is_text("first")) return {same, same, true};
    if (!value->is_map()) {
        throw value->error(
            "must be first (the same as the first sensor's) or a map with "
            "position_mm and rpy_deg");
    }
    const YamlMap map(*value, keys::places, "frame");
    const Isometry3d frame = read_frame(map);
    if (is_true(map, "known")) return {frame, frame, true};
    return {std::nullopt, frame, true};
}

}  // namespace

SensorSection read_sensor(const YamlValue& value) {
    for (const char* const key : {"frame", "same_camera"}) {
        const auto found = find_of(value, key);
        if (!found) continue;
        throw found->error(
            "is of a further one of several sensors (key 'sensors'); must be left out");
    }
    return read_kind(value);
}

SensorSection read_sensors(const YamlValue& list) {
    const std::vector<YamlValue> values = list.list();
    constexpr std::size_t most = 8;
    if (values.size() < 2 || values.size() > most) {
        throw list.error(
            fmt::format("lists {} sensor{}; must be from 2 to {} (one alone is stated "
                        "as 'sensor')",
                        values.size(), values.size() == 1 ? "" : "s", most));
    }
    std::vector<SensorPart> parts;
    std::vector<VectorXd> unknowns;
    std::vector<Isometry3d> frames;
    bool has_positions = true;
    for (const YamlValue& value : values) {
        const auto same = read_same_camera(value, parts);
        const CameraSensor* const camera = same ? as_camera(parts, *same) : nullptr;
        SensorSection section =
            camera != nullptr ? read_another_board(value, *camera) : read_kind(value);
        FrameSection frame = read_sensor_frame(value, parts.empty());
        const bool has_own_frame = camera == nullptr || camera->setup().is_on_flange;
        const bool has_frame = frame.known || frame.is_stated || !has_own_frame;
        has_positions = has_positions && section.has_positions && has_frame;
        parts.push_back(
            {std::move(section.sensor), frame.known, section.has_positions, has_frame, same});
        unknowns.push_back(std::move(section.unknowns));
        frames.push_back(frame.nominal);
    }
    try {
        auto sensor = std::make_shared<CombinedSensor>(std::move(parts));
        VectorXd all = sensor->unknowns(unknowns, frames);
        return {std::move(sensor), std::move(all), has_positions};
    } catch (const InputError& error) {
        throw list.error(std::string("cannot be used: ") + error.what());
    }
}

}  // namespace posewise::detail
