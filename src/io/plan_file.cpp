#include "posewise/io/plan_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "atomic_file.hpp"
#include "csv_reader.hpp"
#include "measurement_columns.hpp"
#include "plan_format.hpp"
#include "plan_paths.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/json_reports.hpp"
#include "posewise/measurement/seen.hpp"

namespace posewise::io {
namespace {

using detail::Json;

Json candidates_to_json(const Plan& plan, const std::string& plan_path) {
    const PlanSources& sources = plan.request.sources;
    Json json;
    json["kind"] = std::find_if(detail::candidate_kinds.begin(), detail::candidate_kinds.end(),
                                [&](const auto& entry) { return entry.first == plan.kind; })
                       ->second;
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
    json["kept"] = pose.is_kept;
    return json;
}

Json plan_to_json(const Plan& plan, const std::string& path) {
    Json document = detail::make_document(detail::plan_kind, detail::plan_format);
    document["campaign"] = plan.campaign.empty() ? Json(nullptr) : Json(plan.campaign);
    document["candidates"] = candidates_to_json(plan, path);
    document["problem"] = problem_to_json(plan, path);
    document["criterion"] = criterion_name(plan.request.criterion);
    document["value"] = plan.value;
    add_bounds(document, plan);
    document["search"] = {{"seed", plan.request.seed},
                          {"starts", plan.request.starts},
                          {"starts_at_best", plan.starts_at_best},
                          {"stop_reason", ending_name(plan.ending)}};
    if (plan.tried > 0) document["search"]["tried"] = plan.tried;
    if (plan.request.proof) document["search"]["proof_s"] = *plan.request.proof;
    add_prediction(document, plan);
    if (!plan.assumptions.empty()) document["assumes"] = detail::numbers_to_json(plan.assumptions);
    Json& poses = document["poses"] = Json::array();
    for (const PlannedPose& pose : plan.poses) poses.push_back(pose_to_json(plan, pose));
    if (!plan.is_continuous()) document["certificate"] = certificate_to_json(plan.certificate);
    return document;
}

// ---- What is printed, but not in the file ----

/// Of the positions of targets, by the parameters alone, and with the model error.
Json accuracy_to_json(const PredictedAccuracy& accuracy, double model_error) {
    const PredictedTotal total = predict_total(accuracy, model_error);
    return {{"rms_mm", mm_per_m * accuracy.rms},
            {"p95_mm", mm_per_m * accuracy.percentile95},
            {"total_rms_mm", mm_per_m * total.rms},
            {"total_lower_mm", mm_per_m * total.lower},
            {"total_upper_mm", mm_per_m * total.upper}};
}

Json count_to_json(const CountAccuracy& count, double model_error) {
    return {{"new_pose_count", count.pose_count},
            {"is_planned", count.is_planned},
            {"accuracy",
             count.accuracy ? accuracy_to_json(*count.accuracy, model_error) : Json(nullptr)}};
}

Json pool_to_json(const Pool& pool) {
    Json rejections = Json::array();
    for (std::size_t k = 0; k < pool.rejections.size(); ++k) {
        const auto& [first, in_all] = pool.rejections[k];
        if (in_all == 0) continue;
        rejections.push_back({{"constraint", constraint_name(static_cast<Constraint>(k))},
                              {"in_all", in_all},
                              {"first", first}});
    }
    return {{"drawn", pool.candidate_count},
            {"feasible", pool.configurations.rows()},
            {"rejections", std::move(rejections)}};
}

Json budget_to_json(const ErrorBudget& budget) {
    return {{"noise_mm", mm_per_m * budget.noise},
            {"model_mm", mm_per_m * budget.model},
            {"prior_mm", mm_per_m * budget.prior},
            {"parameters_mm", mm_per_m * budget.parameters},
            {"left_over_mm", mm_per_m * budget.left_over},
            {"repeatability_mm", mm_per_m * budget.repeatability},
            {"total_mm", mm_per_m * budget.total}};
}

/// Poses that are missing: each alone (`is_value`: what that costs), or one after another.
Json drop_outs_to_json(const Planning& planning, const std::vector<DropOut>& drop_outs,
                       bool is_value) {
    Json list = Json::array();
    for (const DropOut& one : drop_outs) {
        const double without = is_value ? planning.plan.predicted->rms : 0;
        list.push_back({{"id", planning.plan.poses[static_cast<std::size_t>(one.pose)].id},
                        {is_value ? "value_mm" : "rms_mm", mm_per_m * (one.rms - without)}});
    }
    return list;
}

Json range_to_json(const ErrorRange& range) {
    return {{"expected_mm", mm_per_m * range.expected},
            {"lower_mm", mm_per_m * range.lower},
            {"upper_mm", mm_per_m * range.upper},
            {"assured_mm", mm_per_m * range.assured}};
}

const char* quantity_name(ErrorQuantity quantity) {
    if (quantity == ErrorQuantity::Rms) return "rms";
    return quantity == ErrorQuantity::Max ? "max" : "p95";
}

Json simulated_to_json(const SimulatedPlan& simulated, const std::optional<double>& limit) {
    static const std::map<LimitVerdict, const char*> verdicts{{LimitVerdict::Kept, "kept"},
                                                              {LimitVerdict::NotKept, "not kept"},
                                                              {LimitVerdict::Open, "open"}};
    const auto number = [&](const SimulatedNumber& one) -> Json {
        const bool is_found = simulated.robot_count > 0;
        return {{"predicted_mm", mm_per_m * one.predicted},
                {"found_mm", is_found ? Json(mm_per_m * one.found) : Json(nullptr)},
                {"uncertainty_mm", mm_per_m * one.uncertainty}};
    };
    return {{"quantity", quantity_name(simulated.quantity)},
            {"assurance", simulated.assurance},
            {"ending", ending_name(simulated.ending)},
            {"is_sure", simulated.is_sure()},
            {"digits", simulated.digits},
            {"tolerance_mm", mm_per_m * simulated.tolerance},
            {"deviation_mm", mm_per_m * simulated.deviation},
            {"robot_count", simulated.robot_count},
            {"expected_robot_count", simulated.expected_count},
            {"block_count", simulated.block_count},
            {"uncalibrated_count", simulated.uncalibrated_count},
            {"expected", number(simulated.expected)},
            {"lower", number(simulated.lower)},
            {"upper", number(simulated.upper)},
            {"assured", number(simulated.assured)},
            {"limit", limit ? Json(verdicts.at(judge_limit(simulated, *limit))) : Json(nullptr)}};
}

Json target_to_json(const TargetPlanning& found) {
    const TargetOptions& target = found.target;
    Json json = {{"limit_mm", detail::millimetres(target.limit)},
                 {"limit_s", target.duration ? Json(*target.duration) : Json(nullptr)},
                 {"assurance", target.assurance},
                 {"quantity", quantity_name(target.quantity)},
                 {"robust_to", target.robust_to},
                 {"error", range_to_json(*found.error)},
                 {"floor", range_to_json(found.floor)},
                 {"curve", Json::array()}};
    for (const CountPrediction& one : found.curve) {
        json["curve"].push_back({{"new_pose_count", one.pose_count},
                                 {"is_planned", one.is_planned},
                                 {"error", one.error ? range_to_json(*one.error) : Json(nullptr)},
                                 {"duration_s", one.duration}});
    }
    return json;
}

Json report_to_json(const Plan& plan, const std::string& path) {
    Json document = plan_to_json(plan, path);
    document["plan_file"] = path;
    document["value_rms_mm"] = detail::millimetres(plan.value_rms);
    const std::optional<double> model_error = assumed_model_error(plan);
    if (plan.predicted && model_error) {
        document["accuracy"] = accuracy_to_json(*plan.predicted, *model_error);
    }
    return document;
}

Json planning_to_json(const Planning& planning, const std::string& path) {
    Json document = report_to_json(planning.plan, path);
    document["new_pose_count"] = planning.search.pose_count;
    document["measured_count"] = planning.measured_count;
    document["workspace_count"] = planning.workspace_count;
    document["pool"] = pool_to_json(planning.pool);
    const Tour& tour = planning.tour;
    document["tour"] = {{"time_s", tour.time},
                        {"as_planned_s", tour.planning_order_time},
                        {"to_the_nearest_s", tour.nearest_neighbour_time},
                        {"blocked_count", tour.blocked_count}};
    document["duration_s"] = planning.duration;
    document["budget"] = budget_to_json(planning.budget);
    document["pose_values"] = drop_outs_to_json(planning, planning.without_each, true);
    document["drop_outs"] = drop_outs_to_json(planning, planning.drop_outs, false);
    return document;
}

std::string configurations_text(const Campaign& campaign, const std::vector<PlannedPose>& poses) {
    std::string text =
        fmt::format("config{},{}\n", detail::joint_header(campaign), detail::seen_header(campaign));
    const Index targets = campaign.sensor->target_count();
    for (const PlannedPose& pose : poses) {
        fmt::format_to(std::back_inserter(text), "{}{},{}\n", detail::csv_field(pose.id),
                       detail::joint_cells(campaign, pose.configuration),
                       detail::seen_cell(campaign, seen_targets(pose.targets, targets)));
    }
    return text;
}

}  // namespace

std::string to_json(const Plan& plan, const std::string& path) {
    return detail::json_text(report_to_json(plan, path));
}

std::string to_json(const Planning& planning, const std::vector<CountAccuracy>& counts,
                    const std::string& path, const std::optional<SimulatedPlan>& simulated) {
    Json document = planning_to_json(planning, path);
    Json& others = document["other_counts"] = Json::array();
    for (const CountAccuracy& count : counts) {
        others.push_back(count_to_json(count, planning.campaign.model_error));
    }
    if (simulated) document["monte_carlo"] = simulated_to_json(*simulated, std::nullopt);
    return detail::json_text(document);
}

std::string to_json(const TargetPlanning& found, const std::string& path,
                    const std::optional<SimulatedPlan>& simulated) {
    Json document = planning_to_json(found.planning.value(), path);
    document["target"] = target_to_json(found);
    if (simulated) document["monte_carlo"] = simulated_to_json(*simulated, found.target.limit);
    return detail::json_text(document);
}

void write_plan(const std::string& path, const Plan& plan) {
    detail::write_json(path, plan_to_json(plan, path));
}

void write_plan(const std::string& path, const Plan& plan, const std::string& csv_path,
                const Campaign& campaign) {
    std::vector<detail::FileContent> files{
        {path, detail::json_text(plan_to_json(plan, path), path)}};
    if (!csv_path.empty()) files.push_back({csv_path, configurations_text(campaign, plan.poses)});
    detail::write_files(files);
}

void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<PlannedPose>& poses) {
    detail::write_file(path, configurations_text(campaign, poses));
}

}  // namespace posewise::io

namespace posewise::detail {

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
