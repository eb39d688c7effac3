#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/text.hpp"
#include "estimate_fields.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::Json;
using detail::JsonValue;

constexpr const char* saved_kinds = "plan, estimate, study or export";

Loss read_loss(const JsonValue& root) {
    Loss loss;
    if (!root.has("loss")) return loss;
    const JsonValue kind = root["loss"]["kind"];
    for (const LossKind one : {LossKind::Huber, LossKind::Cauchy}) {
        if (kind.text() == loss_name(one)) loss.kind = one;
    }
    if (loss.kind == LossKind::Squares) throw kind.error("must be huber or cauchy");
    loss.width = root["loss"]["width_standard_deviations"].number();
    return loss;
}

/// Returns the criterion of each.
std::vector<std::string> check_planned(const JsonValue& list, const std::string& unit) {
    std::vector<std::string> criteria;
    for (const JsonValue& planned : list.list()) {
        criteria.push_back(planned["criterion"].text());
        planned["held_out_rms" + unit].number_or(0);
        planned["expected_rms" + unit].number_or(0);
    }
    if (criteria.empty()) throw list.error("is empty; must hold what each criterion chose");
    return criteria;
}

/// What tables and curves of a study are made of.
void check_study(const JsonValue& study) {
    study["campaign"].text();
    study["simulated"].boolean();
    const std::string unit = '_' + (study.has("unit") ? study["unit"].text() : "mm");
    for (const JsonValue& model : study["models"].list()) {
        model["name"].text();
        std::vector<std::string> criteria;
        for (const JsonValue& row : model["rows"].list()) {
            row["pose_count"].count(1);
            const std::vector<std::string> found = check_planned(row["planned"], unit);
            if (criteria.empty()) criteria = found;
            if (found != criteria) {
                throw row["planned"].error("is not by the criteria of the first row");
            }
            const JsonValue random = row["random"];
            for (const char* const quantile : {"p10", "p50", "p90"}) {
                random[std::string("held_out_rms_") + quantile + unit].number_or(0);
            }
            random["subsets"].count(0);
            random["unidentified"].count(0);
        }
    }
}

/// How far files that were exported are from the robot.
void check_export(const JsonValue& document) {
    document["campaign"].text();
    const JsonValue lost = document["lost"];
    for (const std::string& geometry : {std::string("nominal"), document["geometry"].text()}) {
        lost[geometry]["rms_mm"].number();
        lost[geometry]["largest_mm"].number();
    }
    document["not_exported"].texts();
    const JsonValue files = document["read_back"];
    for (const JsonValue& file : files.list()) {
        file["path"].text();
        file["configurations"].count(1);
        file["position_m"].number();
        file["orientation_rad"].number();
    }
    if (files.list().empty()) throw files.error("is empty; must name the files written");
}

std::string read_checked(const std::string& path, const char* kind,
                         void (*check)(const JsonValue&)) {
    const Json document = detail::read_document(path, kind);
    check(JsonValue(document, path));
    return detail::json_text(document, path);
}

}  // namespace

SavedKind kind_of_saved(const std::string& path) {
    if (is_trial_store(path)) return SavedKind::Trials;
    const Json document = detail::read_json(path, saved_kinds);
    static const std::array<std::pair<std::string, SavedKind>, 4> kinds{
        {{"posewise plan", SavedKind::Plan},
         {"posewise estimate", SavedKind::Estimate},
         {"posewise study", SavedKind::Study},
         {"posewise export", SavedKind::Export}}};
    const JsonValue root(document, path);
    const std::string stated = document.is_object() && root.has("kind") ? root["kind"].text() : "";
    for (const auto& [name, kind] : kinds) {
        if (stated == name) return kind;
    }
    throw input_error_at({path},
                         fmt::format("kind: is {}; must be that of a {}, as posewise writes "
                                     "them, or the file a store of study",
                                     detail::quote(stated), saved_kinds));
}

std::string read_saved_document(const std::string& path, SavedKind kind) {
    switch (kind) {
        case SavedKind::Plan:
            return detail::json_text(detail::read_document(path, "plan"), path);
        case SavedKind::Estimate:
            return detail::json_text(detail::read_document(path, "estimate"), path);
        case SavedKind::Study:
            return read_checked(path, "study", check_study);
        case SavedKind::Export:
            return read_checked(path, "export", check_export);
        case SavedKind::Trials:
            break;
    }
    throw input_error_at({path}, "is a store of trials, which has no document");
}

bool EstimateRecord::has_option(const std::string& name) const {
    return std::any_of(made_from.options.begin(), made_from.options.end(),
                       [&](const auto& option) { return option.first == name; });
}

EstimateRecord read_estimate_record(const std::string& path) {
    const Json document = detail::read_document(path, "estimate");
    const JsonValue root(document, path);
    EstimateRecord record;
    record.campaign = root["campaign"].text();
    detail::provenance_fields(detail::Fields(root), record.made_from);
    if (root.has("excluded")) record.excluded = root["excluded"].texts();
    const JsonValue accuracy = root["accuracy"];
    if (accuracy.has("held_out")) record.folds = accuracy["held_out"]["folds"].count(2);
    record.loss = read_loss(root);
    return record;
}

}  // namespace posewise::io
