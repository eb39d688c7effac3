#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.hpp"
#include "io/format/atomic_file.hpp"
#include "io/measurements/target_names.hpp"
#include "measurement/cell_check.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/sensors.hpp"
#include "targets_text.hpp"

namespace posewise::detail {
namespace {

/// The angle between a reflector's normal and the direction to the instrument, in degrees; nothing
/// where the cell does not state the normals.
std::string incidence_cell(const Campaign& campaign, const Isometry3d& flange, Index target,
                           const Vector3d& point) {
    if (!campaign.cell.sight || campaign.cell.sight->normals.empty()) return "";
    const Vector3d normal =
        flange.linear() * campaign.cell.sight->normals[static_cast<std::size_t>(target)];
    return fmt::format("{:.3f}", to_degrees(angle_between(normal, -point)));
}

/// An instrument that measures points, alone or one of several.
struct Tracker {
    const Sensor& sensor;
    VectorXd unknowns;
    Isometry3d own_from_world;
    Index first_target = 0;
    Index number = 1;  ///< by which the file calls the sensor, from 1
};

std::vector<Tracker> trackers_of(const Campaign& campaign) {
    const VectorXd& unknowns = campaign.nominal.sensor;
    if (campaign.sensor->observes_targets()) {
        return {{*campaign.sensor, unknowns, Isometry3d::Identity()}};
    }
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    if (combined == nullptr) return {};
    std::vector<Tracker> trackers;
    for (Index k = 0; k < combined->part_count(); ++k) {
        const Sensor& sensor = *combined->part(k).sensor;
        if (!sensor.observes_targets()) continue;
        trackers.push_back({sensor, combined->unknowns_of(k, unknowns),
                            combined->frame(k, unknowns).inverse(), combined->first_target(k),
                            k + 1});
    }
    return trackers;
}

bool is_text_list(const std::string& path) { return path.ends_with(".txt"); }

/// What the text is of: all that its rows have in common.
struct Table {
    const Campaign& campaign;
    bool is_list = false;  ///< which a program imports to measure all of it: only what is visible
    bool has_several = false;  ///< instruments, each by its number
};

void append_row(std::string& text, const Table& table, const Tracker& tracker,
                const PlannedPose& pose, const Isometry3d& flange, Index target) {
    const bool is_visible =
        pose.targets.empty() ||
        std::ranges::find(pose.targets, tracker.first_target + target) != pose.targets.end();
    if (table.is_list && !is_visible) return;
    const Vector3d point = flange * tracker.sensor.target_position(target, tracker.unknowns);
    const Vector3d mm = mm_per_m * point;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{},{:.4f},{:.4f},{:.4f}", target_name(pose.id, target), mm.x(), mm.y(),
                   mm.z());
    if (!table.is_list) {
        const auto [azimuth, elevation] = sighting_of(point);
        fmt::format_to(out, ",{:.3f},{:.4f},{:.4f},{},{}", mm.norm(), to_degrees(azimuth),
                       to_degrees(elevation), incidence_cell(table.campaign, flange, target, point),
                       is_visible ? "yes" : "no");
    }
    if (table.has_several) fmt::format_to(out, ",{}", tracker.number);
    text += '\n';
}

}  // namespace

void check_has_targets(const std::string& path, const Campaign& campaign) {
    const std::vector<Tracker> trackers = trackers_of(campaign);
    if (trackers.empty()) {
        throw input_error_at({path},
                             "is not written: there is a list of targets only where a "
                             "sensor measures points, as a laser tracker does (kind: "
                             "points)");
    }
    if (!campaign.has_nominal_base || !campaign.has_nominal_targets) {
        throw input_error_at({path}, "is not written: the campaign must state base and " +
                                         campaign.sensor->words().key);
    }
    if (trackers.size() > 1 && is_text_list(path)) {
        throw input_error_at(
            {path}, fmt::format("is not written: a list that ends in .txt is of one instrument, "
                                "the campaign has {} that measure points; must end in .csv, whose "
                                "column 'sensor' tells them apart",
                                trackers.size()));
    }
}

std::string targets_text(const std::string& path, const Campaign& campaign, const Plan& plan) {
    check_has_targets(path, campaign);
    const std::vector<Tracker> trackers = trackers_of(campaign);
    Index most_targets = 0;
    for (const Tracker& tracker : trackers) {
        most_targets = std::max(most_targets, tracker.sensor.target_count());
    }
    std::vector<std::string> ids;
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) ids.push_back(pose.id);
    }
    if (const auto same = find_same_name(ids, most_targets)) {
        throw input_error_at(
            {path}, fmt::format("is not written: the plan's poses {} and {} have the same name for "
                                "an instrument, {}; must differ by more than capitals, separators "
                                "and leading zeros",
                                quote(same->first), quote(same->second), same->name));
    }
    const Table table{campaign, is_text_list(path), trackers.size() > 1};
    std::string text = table.is_list ? "// name, x, y, z in mm\n"
                                     : "name,x_mm,y_mm,z_mm,range_mm,azimuth_deg,elevation_deg,"
                                       "incidence_deg,visible";
    if (!table.is_list) text += table.has_several ? ",sensor\n" : "\n";
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) {
            const Isometry3d flange =
                world_from_flange(campaign, campaign.nominal, pose.configuration);
            for (const Tracker& tracker : trackers) {
                for (Index target = 0; target < tracker.sensor.target_count(); ++target) {
                    append_row(text, table, tracker, pose, tracker.own_from_world * flange, target);
                }
            }
        }
    }
    return text;
}

}  // namespace posewise::detail

namespace posewise::io {

void write_targets(const std::string& path, const Campaign& campaign, const Plan& plan) {
    detail::write_file(path, detail::targets_text(path, campaign, plan));
}

}  // namespace posewise::io
