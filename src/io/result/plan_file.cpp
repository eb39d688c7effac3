#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "plan_format.hpp"
#include "plan_paths.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise::io {
namespace {

using detail::Json;

Json candidates_to_json(const Plan& plan, const std::string& plan_path) {
    const PlanSources& sources = plan.request.sources;
    Json json;
    json["kind"] = detail::name_of(detail::candidate_kinds, plan.kind);
    json["campaign_file"] = detail::path_to_json(sources.campaign, plan_path);
    json["source"] = detail::path_to_json(sources.candidates, plan_path);
    if (plan.kind == CandidateKind::Blocks) {
        json["rows_per_block"] = sources.rows_per_block;
        json["variable"] = sources.variable;
    }
    if (plan.is_continuous()) json["drawn"] = plan.request.pool_count;
    json["count"] = plan.candidate_count;
    if (!plan.is_continuous()) json["checksum"] = plan.checksum;
    json["repeats"] = plan.request.repeats;
    return json;
}

/// An earlier estimate, and how it was used.
Json earlier_to_json(const PlanRequest& request, const std::string& plan_path) {
    const EarlierUse& use = request.earlier;
    Json json = {{"file", detail::path_to_json(request.sources.estimate, plan_path)},
                 {"as_prior", use.is_prior},
                 {"moved", Json::array()},
                 {"only", use.only}};
    if (use.has_new_base) json["moved"].push_back("base");
    if (use.has_new_targets) json["moved"].push_back("targets");
    if (!use.is_prior) return json;
    json["drift_m"] = use.drift.length;
    json["drift_offset_rad"] = use.drift.offset;
    json["drift_rad"] = use.drift.angle;
    return json;
}

Json problem_to_json(const Plan& plan, const std::string& plan_path) {
    const PlanRequest& request = plan.request;
    Json json = {{"pose_count", request.pose_count},
                 {"prior", request.has_prior},
                 {"focus", request.is_focused_on_robot ? "robot" : "all"},
                 {"augment", detail::path_to_json(request.sources.augment, plan_path)}};
    if (!request.sources.estimate.empty()) json["estimate"] = earlier_to_json(request, plan_path);
    if (plan.is_continuous()) {
        json["repaired_plan"] = detail::path_to_json(request.sources.repaired, plan_path);
        json["dropped"] = request.dropped;
        json["workspace"] = detail::path_to_json(request.sources.workspace, plan_path);
        json["workspace_poses"] = request.workspace_count;
        json["workspace_box_mm"] = request.workspace_box_mm;
        json["workspace_target"] = request.workspace_target;
        json["verification_count"] = request.verification_count;
        json["time_limit_s"] = request.time_limit;
    } else {
        json["test_poses"] = detail::path_to_json(request.sources.test_poses, plan_path);
        json["groups"] = detail::path_to_json(request.sources.groups, plan_path);
        json["group_limit"] = request.group_limit;
        json["excluded"] = request.excluded;
        json["repeat_limit"] = request.repeat_limit;
        json["least_distance_rad"] = request.least_distance;
    }
    return json;
}

/// The lower triangle: M is symmetric.
Json certificate_to_json(const Certificate& certificate) {
    Json rows = Json::array();
    for (Index i = 0; i < certificate.M.rows(); ++i) {
        Json row = Json::array();
        for (Index j = 0; j <= i; ++j) row.push_back(certificate.M(i, j));
        rows.push_back(std::move(row));
    }
    return {{"sharpness", certificate.sharpness}, {"M_lower", std::move(rows)}};
}

void add_bounds(Json& document, const Plan& plan) {
    if (!plan.is_continuous()) {
        document["bound"] = plan.bound;
        document["efficiency"] = plan.efficiency;
        return;
    }
    document["bounds"] = {{"pool",
                           {{"value", plan.choice_value},
                            {"bound", plan.bound},
                            {"efficiency", plan.efficiency},
                            {"is_proven", true}}},
                          {"continuous",
                           {{"bound", plan.searched_bound},
                            {"efficiency", plan.searched_efficiency},
                            {"is_proven", false}}}};
}

void add_prediction(Json& document, const Plan& plan) {
    if (!plan.predicted || !plan.is_continuous()) return;
    Json& predicted = document["predicted"];
    predicted["position_error_rms_m"] = plan.predicted->rms;
    predicted["position_error_p95_m"] = plan.predicted->percentile95;
    Json& deviations = predicted["standard_deviation"];
    for (const NamedNumber& one : plan.standard_deviations) deviations[one.name] = one.value;
    document["visiting_time_s"] = plan.visiting_time;
}

Json configuration_to_json(const std::vector<std::string>& columns, const VectorXd& q) {
    Json json;
    for (Index j = 0; j < q.size(); ++j) json[columns[static_cast<std::size_t>(j)]] = q[j];
    return json;
}

/// In degrees and mm, rounded.
Json readable_to_json(const std::vector<std::string>& columns, const VectorXd& q) {
    Json json;
    for (Index j = 0; j < q.size(); ++j) {
        const auto readable = detail::readable_joint(columns[static_cast<std::size_t>(j)], q[j]);
        if (readable) json[readable->name] = std::round(1e4 * readable->value) / 1e4;
    }
    return json;
}

Json pose_to_json(const Plan& plan, const PlannedPose& pose) {
    Json json = {{"id", pose.id}, {"times", pose.times}};
    if (pose.configuration.size() == 0) return json;
    json["joints"] = configuration_to_json(plan.columns, pose.configuration);
    if (plan.is_continuous()) json["readable"] = readable_to_json(plan.columns, pose.configuration);
    json["visible_targets"] = Json::array();
    for (const Index target : pose.targets) json["visible_targets"].push_back(target + 1);
    if (!plan.is_continuous()) return json;
    json["via"] = pose.via ? configuration_to_json(plan.columns, *pose.via) : Json(nullptr);
    json["way_is_blocked"] = pose.is_blocked;
    json["clearance_m"] = pose.clearance ? Json(pose.clearance->distance) : Json(nullptr);
    json["nearest"] = Json::array();
    if (pose.clearance) json["nearest"] = {pose.clearance->body, pose.clearance->other};
    json["kept"] = pose.is_kept;
    return json;
}

/// The cells of a row beside its configuration: what is seen, what for, how it is reached.
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

std::string configurations_text(const Campaign& campaign, const std::vector<PlannedPose>& poses,
                                const std::vector<PlannedPose>& verification = {}) {
    const bool has_clearance = have_clearance(poses) || have_clearance(verification);
    std::string text =
        fmt::format("config{},{},{},{}", detail::joint_header(campaign),
                    detail::seen_header(campaign), detail::purpose_column, detail::way_column);
    if (has_clearance) {
        text += fmt::format(",{},{}", detail::clearance_column, detail::nearest_column);
    }
    return text + '\n' + rows_of(campaign, poses, detail::to_calibrate, has_clearance) +
           rows_of(campaign, verification, detail::to_verify, has_clearance);
}

std::string plan_text(const Plan& plan, const std::string& path,
                      const std::vector<std::string>& warnings) {
    Json document = detail::plan_to_json(plan, path);
    document["warnings"] = warnings;
    return detail::json_text(document, path);
}

}  // namespace

void write_plan(const std::string& path, const Plan& plan,
                const std::vector<std::string>& warnings) {
    detail::write_file(path, plan_text(plan, path, warnings));
}

void write_plan(const std::string& path, const Plan& plan, const std::string& csv_path,
                const Campaign& campaign, const std::vector<std::string>& warnings) {
    std::vector<detail::FileContent> files{{path, plan_text(plan, path, warnings)}};
    if (!csv_path.empty())
        files.push_back({csv_path, configurations_text(campaign, plan.poses, plan.verification)});
    detail::write_files(files);
}

void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<PlannedPose>& poses) {
    detail::write_file(path, configurations_text(campaign, poses));
}

}  // namespace posewise::io

namespace posewise::detail {

Json plan_to_json(const Plan& plan, const std::string& path) {
    Json document = make_document("plan");
    document["campaign"] = plan.campaign.empty() ? Json(nullptr) : Json(plan.campaign);
    document["candidates"] = io::candidates_to_json(plan, path);
    document["problem"] = io::problem_to_json(plan, path);
    document["criterion"] = criterion_name(plan.request.criterion);
    document["value"] = plan.value;
    io::add_bounds(document, plan);
    document["search"] = {{"seed", plan.request.seed.value_or(1)},
                          {"starts", plan.request.starts},
                          {"starts_at_best", plan.starts_at_best},
                          {"stop_reason", ending_name(plan.ending)}};
    if (plan.tried > 0) document["search"]["tried"] = plan.tried;
    if (plan.request.proof) document["search"]["proof_s"] = *plan.request.proof;
    io::add_prediction(document, plan);
    if (!plan.cell_doubts.empty()) document["cell_doubts"] = plan.cell_doubts;
    if (!plan.assumptions.empty()) document["assumes"] = numbers_to_json(plan.assumptions);
    Json& poses = document["poses"] = Json::array();
    for (const PlannedPose& pose : plan.poses) poses.push_back(io::pose_to_json(plan, pose));
    if (!plan.verification.empty()) {
        Json& others = document["verification"] = Json::array();
        for (const PlannedPose& pose : plan.verification) {
            others.push_back(io::pose_to_json(plan, pose));
        }
        document["verification_time_s"] = plan.verification_time;
    }
    if (!plan.is_continuous()) document["certificate"] = io::certificate_to_json(plan.certificate);
    return document;
}

std::optional<NamedNumber> readable_joint(const std::string& column, double value) {
    for (const AmountUnits& units : {angle_units, length_units}) {
        const std::string suffix = '_' + std::string(units.si);
        if (!column.ends_with(suffix)) continue;
        const std::string name = column.substr(0, column.size() - suffix.size());
        return NamedNumber{name + '_' + std::string(units.reading), units.to_reading(value)};
    }
    return std::nullopt;
}

}  // namespace posewise::detail
