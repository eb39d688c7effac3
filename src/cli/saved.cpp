#include "saved.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>

#include "calibrate_report.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "measured.hpp"
#include "page.hpp"
#include "plan_inputs.hpp"
#include "plan_report.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/calibration.hpp"
#include "study_runs.hpp"

namespace posewise::cli {
namespace {
namespace fs = std::filesystem;

void warn_of_missing(const std::string& path, const char* what, const std::string& reason) {
    print_warning(fmt::format("{}: {} not shown: {}", path, what, reason));
}

/// Does it as far as the files allow that are named in `path`.
bool try_to_show(const std::string& path, const char* what, const std::function<void()>& show) {
    try {
        show();
        return true;
    } catch (const InputError& error) {
        warn_of_missing(path, what, error.what());
        return false;
    }
}

/// The file that an estimate names, by the path that was typed when it was made. It is looked for
/// in the estimate's folder first: another of that name may stand in the current one.
std::string find_file(const std::string& typed, const std::string& estimate) {
    std::error_code ignored;
    const fs::path beside = fs::path(estimate).parent_path() / typed;
    return fs::exists(beside, ignored) ? beside.string() : typed;
}

// ---- Plans ----

/// Throws InputError if the campaign predicts something else for the poses than the plan's did.
void check_prediction(const Plan& stated, const Plan& judged, const std::string& campaign) {
    constexpr double rounding = 1e-6;
    if (!stated.predicted || !judged.predicted) return;
    const double was = stated.predicted->rms;
    const double is = judged.predicted->rms;
    if (std::abs(is - was) <= rounding * was) return;
    throw input_error_at(
        {campaign}, fmt::format("predicts {:.6g} mm by the parameters for these poses, the plan "
                                "says {:.6g} mm; must be as it was when the plan was made",
                                mm_per_m * is, mm_per_m * was));
}

/// From the files that the plan names.
void show_again(const Plan& plan, const std::string& path, io::PagePart& part) {
    const PlanRequest& request = plan.request;
    std::optional<io::CampaignFile> campaign;
    if (plan.kind != CandidateKind::Blocks) {
        campaign = read_planned(request.sources, request.earlier, request.has_prior, true);
        const std::string mismatch = describe_mismatch(plan, *campaign);
        if (!mismatch.empty()) throw InputError(mismatch);
    }
    if (plan.is_continuous()) {
        const PlanningOptions options = read_planning_inputs(request, *campaign);
        const Planning judged = judge_again(plan, *campaign, options);
        check_prediction(plan, judged.plan, campaign->path);
        std::string document = io::read_saved_plan(path, judged, answer(judged));
        part = show_plan(plan, *campaign, options);
        part.document = std::move(document);
        return;
    }
    const ChoiceInputs inputs =
        read_choice_inputs(request, plan.kind, plan.candidate_count, std::move(campaign));
    part = show_choice(plan, inputs);
    if (!inputs.campaign) return;
    const Plan judged = judge_again(plan, *inputs.campaign, inputs.candidates, inputs.options);
    part.document = io::read_saved_plan(path, judged, answer(judged));
}

ShownFile show_plan_file(const std::string& path) {
    const Plan plan = io::read_plan(path);
    ShownFile shown;
    io::PagePart& part = shown.parts.emplace_back();
    try_to_show(path, "robot and errors are", [&] { show_again(plan, path, part); });
    if (part.document.empty()) part.document = io::read_saved_document(path, io::SavedKind::Plan);
    const PlanSources& sources = plan.request.sources;
    shown.read = {sources.campaign,   sources.estimate, sources.candidates, sources.augment,
                  sources.test_poses, sources.groups,   sources.workspace,  sources.measured_plan};
    shown.summary = "plan of " + detail::count_of(std::ssize(plan.poses), "pose");
    return shown;
}

// ---- Estimates ----

/// The campaign that an estimate is of, as it was calibrated.
io::CampaignFile read_calibrated(const io::EstimateRecord& record, const std::string& campaign,
                                 const std::string& path, Estimate& estimate) {
    std::optional<bool> prior;
    if (record.has_option("--prior")) prior = true;
    if (record.has_option("--no-prior")) prior = false;
    io::CampaignFile file = read_with_prior(campaign, prior);
    io::EarlierFile read = io::read_earlier(path, file, {});
    if (!read.changes.empty()) {
        print_warning(
            fmt::format("{}: {} says otherwise now: {}", path, campaign, join_some(read.changes)));
    }
    estimate = std::move(read.estimate);
    static_cast<Campaign&>(file) = with_model_error(file, estimate);
    return file;
}

/// The files that it was made with.
InputPaths find_files(const io::EstimateRecord& record, const std::string& estimate) {
    InputPaths paths{find_file(record.made_from.campaign_file, estimate), ""};
    std::vector<std::string> measurements{find_file(record.made_from.measurements, estimate)};
    std::vector<std::string> plans;
    for (const auto& [name, values] : record.made_from.options) {
        if (values.empty()) continue;
        if (name == "--points-unit") paths.points_unit = values.front();
        if (name != "--plan" && (name != "--measurements" || values.size() == 1)) continue;
        std::vector<std::string>& found = name == "--plan" ? plans : measurements;
        found.clear();
        for (const std::string& value : values) found.push_back(find_file(value, estimate));
    }
    return pair_with_plans(std::move(paths), measurements, plans);
}

/// The measurements that it was made with, if they are still the same. Throws InputError otherwise.
Measurements read_calibrated_with(const io::EstimateRecord& record, const InputPaths& paths,
                                  const io::CampaignFile& file) {
    const MeasuredPlans plans = read_measured_plans(paths, file);
    io::MeasurementsFile all = read_of_plans(paths, file, plans, io::read_measurements);
    if (!io::are_of_checksum(record.made_from.measurements_checksum, all, record.excluded)) {
        throw input_error_at({paths.measurements}, "is not what it was made from any more");
    }
    static_cast<Measurements&>(all) = leave_out(all, record.excluded);
    if (!plans.all) return all;
    return take(all, find_planned(paths.plan, *plans.all, file, all, record.excluded));
}

ShownFile show_estimate_file(const std::string& path) {
    const io::EstimateRecord record = io::read_estimate_record(path);
    const InputPaths paths = find_files(record, path);
    ShownFile shown;
    shown.read = files_of(paths);
    shown.read.push_back(paths.campaign);
    io::PagePart& part = shown.parts.emplace_back();
    try_to_show(path, "robot and errors are", [&] {
        Estimate estimate;
        const io::CampaignFile file = read_calibrated(record, paths.campaign, path, estimate);
        std::optional<Measurements> used;
        try_to_show(path, "residuals are",
                    [&] { used = read_calibrated_with(record, paths, file); });
        part = show_estimate(file, estimate, used ? &*used : nullptr);
        if (!used) return;
        try_to_show(path, "residuals are", [&] {
            // An earlier estimate that was built on may be another one now.
            const Index folds = record.has_option("--from") ? 0 : record.folds;
            part.residuals = io::page_residuals(
                file, *used, list_residuals(file, estimate, *used, {record.loss, folds}));
        });
    });
    part.title = record.campaign;
    part.document = io::read_saved_document(path, io::SavedKind::Estimate);
    shown.summary = "estimate";
    return shown;
}

// ---- Studies ----

ShownFile show_study_file(const std::string& path, io::SavedKind kind) {
    ShownFile shown;
    shown.summary = "study";
    if (kind == io::SavedKind::Study) {
        shown.parts.emplace_back().document = io::read_saved_document(path, kind);
        return shown;
    }
    shown.read = {path + "-wal", path + "-shm", path + "-journal"};
    for (const std::vector<Study>& studies : read_store_groups(path)) {
        io::PagePart& part = shown.parts.emplace_back();
        part.title = studies.front().campaign;
        part.document = io::with_sentences(io::to_json(studies), {}, answer(studies));
    }
    if (shown.parts.size() > 1) shown.summary = fmt::format("{} studies", shown.parts.size());
    return shown;
}

ShownFile show_export_file(const std::string& path) {
    ShownFile shown;
    shown.summary = "export";
    shown.parts.emplace_back().document = io::read_saved_document(path, io::SavedKind::Export);
    return shown;
}

ShownFile show_by_kind(const std::string& path) {
    const io::SavedKind kind = io::kind_of_saved(path);
    if (kind == io::SavedKind::Plan) return show_plan_file(path);
    if (kind == io::SavedKind::Export) return show_export_file(path);
    if (kind == io::SavedKind::Estimate) return show_estimate_file(path);
    return show_study_file(path, kind);
}

}  // namespace

ShownFile show_saved(const std::string& path) {
    ShownFile shown = show_by_kind(path);
    std::error_code ignored;
    for (io::PagePart& part : shown.parts) {
        if (part.title.empty()) part.title = path;
        part.made_at = format_time(fs::last_write_time(path, ignored));
        shown.summary += part.scene ? ", with the robot" : "";
        shown.summary += part.residuals ? ", residuals" : "";
        shown.summary += part.error_map ? ", errors over the workspace" : "";
    }
    return shown;
}

}  // namespace posewise::cli
