#include <fmt/format.h>

#include <map>

#include "judgement_json.hpp"
#include "plan_json.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::Json;

/// Of the positions of targets, by the parameters alone, and with the model error.
Json accuracy_to_json(const PredictedAccuracy& accuracy) {
    const PredictedTotal total = predict_total(accuracy);
    return {{"rms_mm", mm_per_m * accuracy.rms},
            {"p95_mm", mm_per_m * accuracy.percentile95},
            {"total_rms_mm", mm_per_m * total.rms},
            {"total_lower_mm", mm_per_m * total.lower},
            {"total_upper_mm", mm_per_m * total.upper}};
}

Json count_to_json(const CountAccuracy& count) {
    return {{"new_pose_count", count.pose_count},
            {"is_planned", count.is_planned},
            {"accuracy", count.accuracy ? accuracy_to_json(*count.accuracy) : Json(nullptr)}};
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

Json left_out_to_json(const ErrorsLeftOut& left_out) {
    return {{"errors", left_out.key},
            {"error_count", left_out.error_count},
            {"promised_mm", mm_per_m * left_out.promised},
            {"expected_mm", mm_per_m * left_out.expected},
            {"lower_mm", mm_per_m * left_out.lower},
            {"upper_mm", mm_per_m * left_out.upper},
            {"with_them_mm", mm_per_m * left_out.with_them}};
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
                 {"is_settled", found.is_settled},
                 {"error", range_to_json(*found.error)},
                 {"floor", range_to_json(found.floor)},
                 {"counts", nullptr},
                 {"curve", Json::array()}};
    if (found.counts) {
        const auto number = [](const std::optional<Index>& count) {
            return count ? Json(*count) : Json(nullptr);
        };
        json["counts"] = {{"lower", number(found.counts->lower)},
                          {"upper", number(found.counts->upper)},
                          {"most", found.counts->most}};
    }
    for (const CountPrediction& one : found.curve) {
        json["curve"].push_back({{"new_pose_count", one.pose_count},
                                 {"is_planned", one.is_planned},
                                 {"error", one.error ? range_to_json(*one.error) : Json(nullptr)},
                                 {"duration_s", one.duration}});
    }
    return json;
}

void add_accuracy(Json& document, const Plan& plan, const std::string& path) {
    document["plan_file"] = path;
    document["value_rms_mm"] = detail::millimetres(plan.value_rms);
    if (plan.predicted) document["accuracy"] = accuracy_to_json(*plan.predicted);
}

Json report_to_json(const Plan& plan, const std::string& path) {
    Json document = detail::plan_to_json(plan, path);
    add_accuracy(document, plan, path);
    return document;
}

/// What is known of a plan that was kept, too.
void add_judgement(Json& document, const Planning& planning) {
    document["budget"] = budget_to_json(planning.budget);
    document["pose_values"] = drop_outs_to_json(planning, planning.without_each, true);
    document["drop_outs"] = drop_outs_to_json(planning, planning.drop_outs, false);
    if (!planning.images.empty()) {
        document["images"] = detail::images_to_json(planning.images);
    }
}

void add_counts(Json& document, const Planning& planning) {
    document["new_pose_count"] = planning.search.pose_count;
    document["measured_count"] = planning.measured_count;
    document["workspace_count"] = planning.workspace_count;
    Json& made_up = document["made_up"] = Json::array();
    if (!planning.campaign.has_nominal_base) made_up.push_back("base");
    if (!planning.campaign.has_nominal_targets) made_up.push_back("targets");
}

Json planning_to_json(const Planning& planning, const std::string& path) {
    Json document = report_to_json(planning.plan, path);
    add_counts(document, planning);
    document["pool"] = pool_to_json(planning.pool);
    const Tour& tour = planning.tour;
    document["tour"] = {{"time_s", tour.time},
                        {"as_planned_s", tour.planning_order_time},
                        {"to_the_nearest_s", tour.nearest_neighbour_time},
                        {"shortest_s", tour.shortest_time},
                        {"blocked_count", tour.blocked_count}};
    add_judgement(document, planning);
    document["left_out"] = planning.left_out ? left_out_to_json(*planning.left_out) : Json(nullptr);
    return document;
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
        others.push_back(count_to_json(count));
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

std::string read_saved_plan(const std::string& path, const Planning& judged,
                            const std::vector<Answer>& answers) {
    Json document = detail::read_document(path, "plan");
    if (!document.contains("accuracy")) {
        add_accuracy(document, judged.plan, path);
        add_counts(document, judged);
        add_judgement(document, judged);
        document["answers"] = detail::answers_to_json(answers);
    }
    return detail::json_text(document, path);
}

std::string read_saved_plan(const std::string& path, const Plan& judged,
                            const std::vector<Answer>& answers) {
    Json document = detail::read_document(path, "plan");
    if (!document.contains("accuracy")) {
        add_accuracy(document, judged, path);
        document["answers"] = detail::answers_to_json(answers);
    }
    return detail::json_text(document, path);
}

}  // namespace posewise::io
