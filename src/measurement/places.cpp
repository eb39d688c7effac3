#include "places.hpp"

#include <fmt/format.h>

#include "core/format.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {
namespace {

constexpr double farthest_tracker = 200;  // m: none measures farther
constexpr double nearest_tracker = 0.05;  // m: there the robot stands

const PointNoise* noise_of(const Sensor& sensor) {
    if (const auto* several = dynamic_cast<const CombinedSensor*>(&sensor)) {
        return noise_of(*several->part(0).sensor);
    }
    if (const auto* points = dynamic_cast<const PointSensor*>(&sensor)) return &points->noise();
    if (const auto* poses = dynamic_cast<const PoseSensor*>(&sensor)) return &poses->noise();
    return nullptr;
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

void check_base(const Campaign& campaign) {
    const Vector3d base = campaign.nominal.world_from_base.translation();
    const std::optional<Vector3d> tracker = tracker_position(campaign);
    const double distance = (base - tracker.value_or(Vector3d::Zero())).norm();
    const double farthest = tracker ? farthest_tracker : farthest_base;
    const char* const what = tracker ? "the base, seen from the tracker," : "the base";
    if (distance > farthest) throw too_far(campaign, what, distance, farthest);
    if (tracker && distance > 0 && distance < nearest_tracker) {
        throw too_near(campaign, what, distance);
    }
}

void check_targets(const Campaign& campaign) {
    const Sensor& sensor = *campaign.sensor;
    for (Index k = 0; k < sensor.targets().count(); ++k) {
        const double distance = sensor.targets().position(k, campaign.nominal.sensor).norm();
        const std::string what = fmt::format("target {}, seen from the flange,", k + 1);
        if (distance > farthest_target) throw too_far(campaign, what, distance, farthest_target);
        const bool is_point = !sensor.has_orientation();  // a tool's frame may be the flange's
        if (is_point && distance > 0 && distance < nearest_targets) {
            throw too_near(campaign, what, distance);
        }
    }
}

}  // namespace

std::optional<Vector3d> tracker_position(const Campaign& campaign) {
    const PointNoise* const noise = noise_of(*campaign.sensor);
    if (noise != nullptr) {
        if (const auto* tracker = std::get_if<LaserTrackerNoise>(noise)) return tracker->position;
    }
    if (campaign.cell.sight) return Vector3d(Vector3d::Zero());
    return std::nullopt;
}

void check_places(const Campaign& campaign) {
    if (campaign.has_nominal_base) check_base(campaign);
    if (campaign.has_nominal_targets) check_targets(campaign);
}

}  // namespace posewise::detail
