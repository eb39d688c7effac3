#include "places.hpp"

#include <fmt/format.h>

#include "core/format.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {
namespace {

constexpr double farthest_tracker = 200;  // m: none measures farther
constexpr double farthest_board = 100;    // m: a camera sees no corners of one farther off
constexpr double nearest_tracker = 0.05;  // m: there the robot stands

/// The sensor, or the first of several.
const Sensor& first_of(const Sensor& sensor) {
    const auto* const several = dynamic_cast<const CombinedSensor*>(&sensor);
    return several != nullptr ? *several->part(0).sensor : sensor;
}

const PointNoise* noise_of(const Sensor& sensor) {
    if (const auto* points = dynamic_cast<const PointSensor*>(&sensor)) return &points->noise();
    if (const auto* poses = dynamic_cast<const PoseSensor*>(&sensor)) return &poses->noise();
    return nullptr;
}

const LaserTrackerNoise* tracker_of(const Sensor& sensor) {
    const PointNoise* const noise = noise_of(sensor);
    return noise != nullptr ? std::get_if<LaserTrackerNoise>(noise) : nullptr;
}

InputError too_far(const Campaign& campaign, const std::string& what, double distance,
                   double farthest) {
    return InputError(
        fmt::format("{}: {} is stated {} m away, must be within {} m; are its numbers in mm? Then "
                    "the key is position_mm",
                    campaign.name, what, format_short(distance, 4), format_short(farthest, 4)));
}

InputError too_near(const Campaign& campaign, const std::string& what, double distance) {
    return InputError(fmt::format(
        "{}: {} is stated {} mm away, which is no place for it; are its numbers in m? Then the key "
        "is position_m",
        campaign.name, what, format_short(1e3 * distance, 4)));
}

/// How far from the base an instrument may be, and what is said of it.
double farthest_from_base(const Sensor& sensor, bool is_tracker) {
    if (is_tracker) return farthest_tracker;
    return sensor.has_only_pixels() ? farthest_board : farthest_base;
}

void check_base(const Campaign& campaign) {
    const Vector3d base = campaign.nominal.world_from_base.translation();
    const std::optional<Vector3d> tracker = tracker_position(campaign);
    const double distance = (base - tracker.value_or(Vector3d::Zero())).norm();
    const double farthest = farthest_from_base(first_of(*campaign.sensor), tracker.has_value());
    const char* const what = tracker ? "the base, seen from the tracker," : "the base";
    if (distance > farthest) throw too_far(campaign, what, distance, farthest);
    if (tracker && distance > 0 && distance < nearest_tracker) {
        throw too_near(campaign, what, distance);
    }
}

/// Of each further sensor how far it is from the base, where its frame is stated.
void check_frames(const Campaign& campaign) {
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    for (Index k = 1; combined != nullptr && k < combined->part_count(); ++k) {
        const SensorPart& part = combined->part(k);
        if (!part.has_nominal_frame) continue;
        const Isometry3d base = combined->parameters_of(k, campaign.nominal).world_from_base;
        const double farthest =
            farthest_from_base(*part.sensor, tracker_of(*part.sensor) != nullptr);
        const double distance = base.translation().norm();
        if (distance <= farthest) continue;
        throw too_far(campaign,
                      fmt::format("the frame of sensor {} (sensors[{}].frame), seen from the base,",
                                  k + 1, k + 1),
                      distance, farthest);
    }
}

/// "target 1"; of a camera "the board", whichever is on the flange.
std::string name_of(const Sensor& sensor, Index target) {
    return sensor.has_pixels() ? "the " + sensor.words().place
                               : fmt::format("target {}", target + 1);
}

/// `of`: the sensor, if it is one of several.
void check_targets(const Campaign& campaign, const Sensor& sensor, const VectorXd& unknowns,
                   const std::string& of) {
    for (Index k = 0; k < sensor.targets().count(); ++k) {
        const double distance = sensor.targets().position(k, unknowns).norm();
        const std::string what = fmt::format("{}{}, seen from the flange,", name_of(sensor, k), of);
        if (distance > farthest_target) throw too_far(campaign, what, distance, farthest_target);
        const bool is_point = !sensor.has_orientation();  // a tool's frame may be the flange's
        if (is_point && distance > 0 && distance < nearest_targets) {
            throw too_near(campaign, what, distance);
        }
    }
}

void check_targets(const Campaign& campaign) {
    const VectorXd& unknowns = campaign.nominal.sensor;
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    if (combined == nullptr) return check_targets(campaign, *campaign.sensor, unknowns, "");
    for (Index k = 0; k < combined->part_count(); ++k) {
        check_targets(campaign, *combined->part(k).sensor, combined->unknowns_of(k, unknowns),
                      fmt::format(" of sensor {}", k + 1));
    }
}

}  // namespace

std::optional<Vector3d> tracker_position(const Campaign& campaign) {
    if (const auto* const tracker = tracker_of(first_of(*campaign.sensor)))
        return tracker->position;
    if (campaign.cell.sight) return Vector3d(Vector3d::Zero());
    return std::nullopt;
}

void check_places(const Campaign& campaign) {
    if (campaign.has_nominal_base) {
        check_base(campaign);
        check_frames(campaign);
    }
    if (campaign.has_nominal_targets) check_targets(campaign);
}

}  // namespace posewise::detail
