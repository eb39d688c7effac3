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

/// A row of the table; of a list, which a program imports to measure all of it, only what is
/// visible.
void append_row(std::string& text, const Campaign& campaign, const PlannedPose& pose,
                const Isometry3d& flange, Index target, bool is_list) {
    const bool is_visible =
        pose.targets.empty() || std::ranges::find(pose.targets, target) != pose.targets.end();
    if (is_list && !is_visible) return;
    const Vector3d point =
        flange * campaign.sensor->target_position(target, campaign.nominal.sensor);
    const Vector3d mm = mm_per_m * point;
    const auto out = std::back_inserter(text);
    fmt::format_to(out, "{},{:.4f},{:.4f},{:.4f}", target_name(pose.id, target), mm.x(), mm.y(),
                   mm.z());
    if (!is_list) {
        const auto [azimuth, elevation] = sighting_of(point);
        fmt::format_to(out, ",{:.3f},{:.4f},{:.4f},{},{}", mm.norm(), to_degrees(azimuth),
                       to_degrees(elevation), incidence_cell(campaign, flange, target, point),
                       is_visible ? "yes" : "no");
    }
    text += '\n';
}

}  // namespace

void check_has_targets(const std::string& path, const Campaign& campaign) {
    if (!campaign.sensor->observes_targets()) {
        throw input_error_at({path},
                             "is not written: there is a list of targets only where the "
                             "sensor measures points, as a laser tracker does (kind: "
                             "points)");
    }
    if (!campaign.has_nominal_base || !campaign.has_nominal_targets) {
        throw input_error_at({path}, "is not written: the campaign must state base and " +
                                         campaign.sensor->words().key);
    }
}

std::string targets_text(const std::string& path, const Campaign& campaign, const Plan& plan) {
    check_has_targets(path, campaign);
    std::vector<std::string> ids;
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) ids.push_back(pose.id);
    }
    if (const auto same = find_same_name(ids, campaign.sensor->target_count())) {
        throw input_error_at(
            {path}, fmt::format("is not written: the plan's poses {} and {} have the same name for "
                                "an instrument, {}; must differ by more than capitals, separators "
                                "and leading zeros",
                                quote(same->first), quote(same->second), same->name));
    }
    const bool is_list = path.ends_with(".txt");
    std::string text = is_list ? "// name, x, y, z in mm\n"
                               : "name,x_mm,y_mm,z_mm,range_mm,azimuth_deg,elevation_deg,"
                                 "incidence_deg,visible\n";
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) {
            const Isometry3d flange =
                world_from_flange(campaign, campaign.nominal, pose.configuration);
            for (Index target = 0; target < campaign.sensor->target_count(); ++target) {
                append_row(text, campaign, pose, flange, target, is_list);
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
