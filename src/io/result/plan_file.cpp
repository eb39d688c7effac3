#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "configurations_text.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "plan_json.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/sensor.hpp"
#include "targets_text.hpp"

namespace posewise::io {
namespace {

/// A row: id, configuration, then `rest`: what is seen, what for, how it is reached.
std::string configuration_row(const Campaign& campaign, const std::string& id, const VectorXd& q,
                              const std::string& rest) {
    return fmt::format("{}{},{}\n", detail::csv_field(id), detail::joint_cells(campaign, q), rest);
}

/// How near the robot comes to something, where that is known.
std::string clearance_cells(const PlannedPose& pose) {
    if (!pose.clearance) return ",,";
    const auto& [distance, body, other] = *pose.clearance;
    return fmt::format(",{:.2f},{}", mm_per_m * distance, detail::csv_field(body + " to " + other));
}

bool have_clearance(const std::vector<PlannedPose>& poses) {
    return std::ranges::any_of(poses, [](const auto& pose) { return pose.clearance.has_value(); });
}

std::string rows_of(const Campaign& campaign, const std::vector<PlannedPose>& poses,
                    std::string_view purpose, bool has_clearance) {
    const Index targets = campaign.sensor->target_count();
    std::string text;
    for (const PlannedPose& pose : poses) {
        if (pose.via) {
            text += configuration_row(
                campaign, pose.id + ".via", *pose.via,
                fmt::format(",{},straight{}", detail::on_the_way, has_clearance ? ",," : ""));
        }
        text += configuration_row(
            campaign, pose.id, pose.configuration,
            fmt::format("{},{},{}{}",
                        detail::seen_cell(campaign, seen_targets(pose.targets, targets)), purpose,
                        pose.is_blocked ? "BLOCKED" : "straight",
                        has_clearance ? clearance_cells(pose) : ""));
    }
    return text;
}

std::string plan_text(const Plan& plan, const std::string& path,
                      const std::vector<std::string>& warnings) {
    detail::Json document = detail::plan_to_json(plan, path);
    document["warnings"] = warnings;
    return detail::json_text(document, path);
}

}  // namespace
}  // namespace posewise::io

namespace posewise::detail {

std::string configurations_text(const Campaign& campaign, const std::vector<PlannedPose>& poses,
                                const std::vector<PlannedPose>& verification) {
    const bool has_clearance = io::have_clearance(poses) || io::have_clearance(verification);
    std::string text = fmt::format("config{},{},{},{}", joint_header(campaign),
                                   seen_header(campaign), purpose_column, way_column);
    if (has_clearance) {
        text += fmt::format(",{},{}", clearance_column, nearest_column);
    }
    return text + '\n' + io::rows_of(campaign, poses, to_calibrate, has_clearance) +
           io::rows_of(campaign, verification, to_verify, has_clearance);
}

}  // namespace posewise::detail

namespace posewise::io {

using detail::configurations_text;

void write_plan(const std::string& path, const Plan& plan,
                const std::vector<std::string>& warnings) {
    detail::write_file(path, plan_text(plan, path, warnings));
}

void write_plan(const std::string& path, const Plan& plan, const PlanTables& tables,
                const Campaign& campaign, const std::vector<std::string>& warnings) {
    std::vector<detail::FileContent> files{{path, plan_text(plan, path, warnings)}};
    if (!tables.configurations.empty()) {
        files.push_back(
            {tables.configurations, configurations_text(campaign, plan.poses, plan.verification)});
    }
    if (!tables.targets.empty()) {
        files.push_back({tables.targets, detail::targets_text(tables.targets, campaign, plan)});
    }
    detail::write_files(files);
}

void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<PlannedPose>& poses) {
    detail::write_file(path, configurations_text(campaign, poses));
}

}  // namespace posewise::io
