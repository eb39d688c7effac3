#include "common.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <limits>

#include "commands.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "flags.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/inspection.hpp"

namespace posewise::cli {
namespace {

/// Like standard error, there is one of them.
std::vector<std::string>& warnings_of_run() {
    static std::vector<std::string> warnings;
    return warnings;
}

}  // namespace

CLI::Option* add_campaign_argument(CLI::App& command, InputPaths& paths) {
    return command
        .add_option("CAMPAIGN", paths.campaign, "Campaign file (YAML): robot, sensor, spread")
        ->required()
        ->check(file_name());
}

CLI::Option* add_measurements_option(CLI::App& command, InputPaths& paths) {
    return command
        .add_option("-m,--measurements", paths.measurements,
                    "Measured configurations (CSV, or MATLAB .mat), or with --plan the points "
                    "measured at its poses, as the instrument's program lists them")
        ->required()
        ->check(file_name());
}

void add_digits_option(CLI::App& command, int& digits) {
    command.add_option("--digits", digits, "Significant digits of values")
        ->check(whole_number(1, 17))
        ->capture_default_str();
}

void add_common_options(CLI::App& command, CommonOptions& common) {
    CLI::Option* const json = command.add_flag(
        "--json", common.json, "Print the result as one JSON document instead of text");
    for (const char* const of_text : {"--digits", "--all-parameters"}) {
        CLI::Option* const option = command.get_option_no_throw(of_text);
        if (option != nullptr) json->excludes(option);  // it has all
    }
    command
        .add_option_function<Index>(
            "--threads", set_thread_count,
            "Threads to compute with, at most four for each core; no result "
            "depends on it (default: one for each)")
        ->check(whole_number(1, 1024));
}

CLI::Validator criterion_check() {
    return CLI::Validator(
        [](const std::string& name) {
            try {
                parse_criterion(name);
            } catch (const InputError& error) {
                return std::string(error.what());
            }
            return std::string();
        },
        "CRITERION");
}

std::vector<std::string> leave_out_missing(const std::string& plan_path, const Plan& plan,
                                           const io::MeasurementsFile& measured,
                                           const std::vector<std::string>& excluded) {
    std::vector<std::string> left_out = excluded;
    std::vector<std::string> missing;
    for (const PlannedPose& pose : plan.poses) {
        if (std::ranges::find(measured.ids, pose.id) != measured.ids.end()) continue;
        left_out.push_back(pose.id);
        if (excluded.empty() && !measured.is_joined) missing.push_back(detail::quote(pose.id));
    }
    if (left_out.size() - excluded.size() == plan.poses.size()) {
        throw input_error_at({plan_path}, "none of its poses is among the measured ones");
    }
    if (!missing.empty()) {
        print_warning(fmt::format("{}: {} of {} poses are not among the measured ones: {}",
                                  plan_path, missing.size(), plan.poses.size(),
                                  join_some(missing)));
    }
    return left_out;
}

std::vector<Index> find_planned(const std::string& plan_path, const Plan& plan,
                                const Campaign& campaign, const io::MeasurementsFile& measured,
                                const std::vector<std::string>& excluded) {
    const auto left_out = leave_out_missing(plan_path, plan, measured, excluded);
    return compute_from(plan_path,
                        [&] { return posewise::find_planned(plan, campaign, measured, left_out); });
}

void print(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

void print_section(const std::string& title, const detail::Table& table) {
    print(format_section(title, table));
}

void print_warning(const std::string& text) {
    const std::string sentence = with_flags(detail::escape_controls(text));
    const std::string line = "posewise: warning: " + sentence + '\n';
    std::fwrite(line.data(), 1, line.size(), stderr);
    warnings_of_run().push_back(sentence);
}

void warn_of_limits(const Campaign& campaign) {
    const std::string words = describe_narrow_limits(campaign, find_narrow_limits(campaign));
    if (!words.empty()) print_warning(words);
}

const std::vector<std::string>& given_warnings() { return warnings_of_run(); }

void print_document(const std::string& document,
                    const std::optional<std::vector<Answer>>& answers) {
    print(io::with_sentences(document, given_warnings(), answers));
}

ProgressLine::ProgressLine(std::string label, bool asked_for)
    : label_(std::move(label)), shown_(asked_for || isatty(STDERR_FILENO) == 1) {}

void ProgressLine::operator()(const Progress& progress, const std::string& note) {
    const Index percent = 100 * progress.done / progress.total;
    if (!shown_ || percent == last_percent_) return;
    last_percent_ = percent;
    // A note may be shorter than the one it overwrites.
    const std::string padded = note.empty() ? note : fmt::format("  {:<64}", note);
    std::fprintf(stderr, "\r%s %3ld %%%s%s", label_.c_str(), static_cast<long>(percent),
                 padded.c_str(), progress.done == progress.total ? "\n" : "");
}

}  // namespace posewise::cli
