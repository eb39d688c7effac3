#include <fmt/format.h>

#include <algorithm>

#include "core/format.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

/// Base and targets are measured by hand before; a robot's errors move them by less.
constexpr double far_away = 0.1;  // m

PlaceDoubt::Unit find_unit(double stated, double found) {
    constexpr double least = 0.02;  // m: nearer to the origin nothing can be said
    constexpr double factor = 1000;
    constexpr double tolerance = 2;
    const auto is_about = [&](double times) {
        return found > times / tolerance * stated && found < times * tolerance * stated;
    };
    if (found > least && is_about(factor)) return PlaceDoubt::Unit::Metres;
    if (stated > least && is_about(1 / factor)) return PlaceDoubt::Unit::Millimetres;
    return PlaceDoubt::Unit::AsRead;
}

/// Whether it is elsewhere, whatever its unit.
bool is_away(const PlaceDoubt& place) { return (place.found - place.stated).norm() > far_away; }

bool is_doubtful(const PlaceDoubt& place) {
    return place.unit != PlaceDoubt::Unit::AsRead || place.turn > 0 || is_away(place);
}

/// 0 where it is as stated, by and large.
double find_turn(const Isometry3d& stated, const Isometry3d& found) {
    constexpr double turned = 0.35;  // rad, 20 deg
    const double turn = Eigen::AngleAxisd(found.linear() * stated.linear().transpose()).angle();
    return turn > turned ? turn : 0;
}

/// Of each target the one that is stated nearest to where it was found.
std::vector<Index> nearest_stated(const std::vector<PlaceDoubt>& targets) {
    std::vector<Index> nearest;
    for (const PlaceDoubt& target : targets) {
        const auto distance = [&](const PlaceDoubt& other) {
            return (other.stated - target.found).squaredNorm();
        };
        const auto found = std::ranges::min_element(targets, {}, distance);
        nearest.push_back(found - targets.begin());
    }
    return nearest;
}

/// Notes which targets change places, if all are then far nearer to where they are stated.
void find_exchanged(std::vector<PlaceDoubt>& targets) {
    constexpr double least_gain = 10;  // of the sum of squares
    constexpr double least = 5e-3;     // m
    const std::vector<Index> nearest = nearest_stated(targets);
    std::vector<Index> sorted = nearest;
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end()) return;
    double as_stated = 0;
    double exchanged = 0;
    for (std::size_t k = 0; k < targets.size(); ++k) {
        const Vector3d& other = targets[static_cast<std::size_t>(nearest[k])].stated;
        as_stated += (targets[k].found - targets[k].stated).squaredNorm();
        exchanged += (targets[k].found - other).squaredNorm();
    }
    if (as_stated < least * least || as_stated < least_gain * exchanged) return;
    for (std::size_t k = 0; k < targets.size(); ++k) {
        if (nearest[k] != static_cast<Index>(k)) {
            targets[k].exchanged_with = targets[static_cast<std::size_t>(nearest[k])].name;
        }
    }
}

std::string describe_place(const Vector3d& place) {
    return fmt::format("[{}, {}, {}] mm", detail::format_mm(place.x(), 1),
                       detail::format_mm(place.y(), 1), detail::format_mm(place.z(), 1));
}

std::string describe(const PlaceDoubt& place) {
    if (!place.exchanged_with.empty()) {
        return fmt::format("{} is measured where {} is stated", place.name, place.exchanged_with);
    }
    if (place.turn > 0 && place.unit == PlaceDoubt::Unit::AsRead && !is_away(place)) {
        return fmt::format("{} is measured turned by {} deg from how it is stated", place.name,
                           detail::format_short(to_degrees(place.turn), 3));
    }
    const std::string text = fmt::format("{} is stated at {}, measured at {}", place.name,
                                         describe_place(place.stated), describe_place(place.found));
    switch (place.unit) {
        case PlaceDoubt::Unit::Metres:
            return text + ": are its numbers in m? Then the key is position_m";
        case PlaceDoubt::Unit::Millimetres:
            return text + ": are its numbers in mm? Then the key is position_mm";
        case PlaceDoubt::Unit::AsRead:
            break;
    }
    const std::string turn =
        place.turn > 0
            ? fmt::format(" and turned by {} deg", detail::format_short(to_degrees(place.turn), 3))
            : "";
    return fmt::format("{}, {} mm away{}", text,
                       detail::format_short(mm_per_m * (place.found - place.stated).norm(), 3),
                       turn);
}

/// Of further sensors whose frames are found, as they are stated and as they were.
std::vector<PlaceDoubt> frames_of(const Campaign& campaign, const Parameters& registered) {
    std::vector<PlaceDoubt> frames;
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    for (Index k = 1; combined != nullptr && k < combined->part_count(); ++k) {
        const SensorPart& part = combined->part(k);
        if (part.known_frame || !part.has_nominal_frame) continue;
        const Isometry3d stated = combined->frame(k, campaign.nominal.sensor);
        const Isometry3d found = combined->frame(k, registered.sensor);
        frames.push_back({fmt::format("the frame of sensor {}", k + 1),
                          stated.translation(),
                          found.translation(),
                          find_unit(stated.translation().norm(), found.translation().norm()),
                          {},
                          find_turn(stated, found)});
    }
    return frames;
}

}  // namespace

std::vector<PlaceDoubt> find_place_doubts(const Campaign& campaign, const Parameters& registered) {
    std::vector<PlaceDoubt> doubts;
    const auto add = [&doubts](const PlaceDoubt& place) {
        if (!place.exchanged_with.empty() || is_doubtful(place)) doubts.push_back(place);
    };
    if (campaign.has_nominal_base && base_parameter_count(campaign) == 6) {
        const Isometry3d& base = campaign.nominal.world_from_base;
        const Vector3d stated = base.translation();
        const Vector3d found = registered.world_from_base.translation();
        add({"base",
             stated,
             found,
             find_unit(stated.norm(), found.norm()),
             {},
             find_turn(base, registered.world_from_base)});
    }
    for (PlaceDoubt& frame : frames_of(campaign, registered)) add(frame);
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera != nullptr && campaign.has_nominal_targets && !camera->setup().known_place) {
        const Isometry3d stated = camera->place(campaign.nominal.sensor);
        const Isometry3d found = camera->place(registered.sensor);
        add({"sensor.place",
             stated.translation(),
             found.translation(),
             find_unit(stated.translation().norm(), found.translation().norm()),
             {},
             find_turn(stated, found)});
    }
    const Targets& targets = campaign.sensor->targets();
    if (!campaign.has_nominal_targets || targets.unknown_count() < 3 * targets.count())
        return doubts;
    const std::vector<std::string> names = campaign.sensor->unknown_names();
    std::vector<PlaceDoubt> places;
    for (Index k = 0; k < targets.count(); ++k) {
        const Vector3d stated = targets.position(k, campaign.nominal.sensor);
        const Vector3d found = targets.position(k, registered.sensor);
        const std::string& name = names[static_cast<std::size_t>(3 * k)];  // "target1.x"
        places.push_back({name.substr(0, name.find('.')),
                          stated,
                          found,
                          find_unit(stated.norm(), found.norm()),
                          {}});
    }
    find_exchanged(places);
    std::ranges::for_each(places, add);
    return doubts;
}

std::string describe_places(const std::vector<PlaceDoubt>& places) {
    std::string text;
    bool has_moved = false;
    bool is_exchanged = false;
    for (const PlaceDoubt& place : places) {
        text += (text.empty() ? "" : "; ") + describe(place);
        is_exchanged = is_exchanged || !place.exchanged_with.empty();
        has_moved =
            has_moved || (place.exchanged_with.empty() && place.unit == PlaceDoubt::Unit::AsRead);
    }
    if (is_exchanged) text += "; state them in the order of the columns";
    if (has_moved) text += "; state them there for plans, or are these of another set-up?";
    return text;
}

}  // namespace posewise
