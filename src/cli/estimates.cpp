#include "estimates.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <set>
#include <tuple>

#include "common.hpp"
#include "core/text.hpp"
#include "crew.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/doubts.hpp"
#include "task/calibration/earlier_estimate.hpp"

namespace posewise::cli {
namespace {

bool contains(const std::vector<std::string>& names, const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// Throws InputError for one that has faults and is not forced; warns of what has changed since.
void check_usable(const std::string& path, const Campaign& campaign, const io::EarlierFile& earlier,
                  bool is_forced) {
    if (!earlier.changes.empty()) {
        print_warning(path + ": the campaign file said otherwise when it was made: " +
                      join_some(earlier.changes));
    }
    for (const std::string& warning : earlier.warnings) {
        if (warning.starts_with(no_calibration)) continue;  // its faults say so
        print_warning(path + ": was warned of when it was made: " + warning);
    }
    const std::vector<std::string> faults = io::find_faults(campaign, earlier);
    if (faults.empty()) return;
    const std::string words = "is no calibration to use: " + join_some(faults);
    if (!is_forced) throw input_error_at({path}, words + "; --force takes it all the same");
    print_warning(path + ": " + words);
}

/// With drift it may be one even where the estimate's covariance alone is none.
void check_prior(const std::string& path, const Campaign& expected) {
    try {
        prior_information(expected);
    } catch (const InputError&) {
        throw input_error_at({path},
                             "covariance.rows_si: is not positive definite, even with drift; must "
                             "be, to be a prior");
    }
}

}  // namespace

CLI::Option* add_force_option(CLI::App& command, bool& is_forced) {
    return command.add_flag("--force", is_forced,
                            "Take an estimate that did not converge or has values no robot has");
}

JudgeCalibration judge_of(const std::string& measurements, bool is_forced) {
    const auto warned = std::make_shared<std::set<std::string>>();
    return [=](const Calibration& calibration) {
        if (!leads_crew()) return;
        for (const std::string& sentence : describe_doubts(calibration, measurements)) {
            if (warned->insert(sentence).second) print_warning(sentence);
        }
        if (calibration.faults.empty()) return;
        const std::string words =
            fmt::format("{}: {}{}", measurements, no_calibration, join_some(calibration.faults));
        if (!is_forced) throw NoCalibration(words + "; --force takes it all the same");
        print_warning(words);
    };
}

std::string join_some(const std::vector<std::string>& texts) {
    constexpr std::size_t shown = 3;
    if (texts.size() <= shown) return fmt::format("{}", fmt::join(texts, "; "));
    return fmt::format("{}; and {} more like this",
                       fmt::join(texts.begin(), texts.begin() + shown, "; "), texts.size() - shown);
}

CLI::Option* add_parts_option(CLI::App& command, const std::string& name,
                              std::vector<std::string>& parts, const std::string& description) {
    return add_ids_option(command, name, parts, description, {"base", "targets"});
}

Estimate read_usable_estimate(const std::string& path, const Campaign& campaign, bool is_forced) {
    const io::EarlierFile earlier = io::read_earlier(path, campaign, {});
    check_usable(path, campaign, earlier, is_forced);
    return earlier.estimate;
}

EarlierUse EarlierArguments::use() const {
    return {is_prior,
            {drift_mm / mm_per_m, drift_offset_mrad / mrad_per_rad, drift_mrad / mrad_per_rad},
            contains(moved, "base"),
            contains(moved, "targets"),
            only};
}

CLI::Option* add_from_option(CLI::App& command, EarlierArguments& arguments) {
    CLI::Option* const force = add_force_option(command, arguments.is_forced);
    CLI::Option* const from =
        command
            .add_option(
                "--from", arguments.from,
                "An estimate of the same robot (JSON), from calibrate --out: base, targets, "
                "errors, model error and learned sizes are as it found them")
            ->check(file_name());
    force->needs(from);
    return from;
}

void let_force_take_measured(CLI::App& command) {
    command.get_option("--force")->remove_needs(command.get_option("--from"));
}

void add_earlier_options(CLI::App& command, EarlierArguments& arguments) {
    CLI::Option* const from = add_from_option(command, arguments);
    CLI::Option* const as_prior =
        command
            .add_flag("--as-prior", arguments.is_prior,
                      "It is the prior, as sure as it was, but for drift of the robot's errors")
            ->needs(from);
    if (CLI::Option* const no_prior = command.get_option_no_throw("--no-prior")) {
        as_prior->excludes(no_prior);
    }
    add_parts_option(
        command, "--moved", arguments.moved,
        "With --from: what was moved since: base, targets or both (base,targets); they "
        "are as the campaign says, targets perhaps more or fewer. Here and in --only and "
        "--refit tool, anchors, planes and sockets count as targets")
        ->needs(from);
    command
        .add_option("--drift-mm", arguments.drift_mm,
                    "With --as-prior: by which lengths may have changed since, standard deviation")
        ->check(real_number(1e-6, 1e3))
        ->capture_default_str()
        ->needs(as_prior);
    for (const auto& [name, value, what] :
         {std::tuple{"--drift-offset-mrad", &arguments.drift_offset_mrad,
                     "The same of offsets of joints"},
          std::tuple{"--drift-mrad", &arguments.drift_mrad, "The same of other angles"}}) {
        command.add_option(name, *value, what)
            ->check(real_number(1e-6, 1e3))
            ->capture_default_str()
            ->needs(as_prior);
    }
    add_ids_option(command, "--only", arguments.only,
                   "With --from: identify only base, targets, robot or errors of it, by commas; "
                   "the others are as it found them. What is expected of poses counts them as "
                   "exact; calibrate prints deviations with their uncertainty and without")
        ->needs(from);
}

Earlier read_usable_earlier(const std::string& path, const Campaign& campaign,
                            const EarlierUse& use, bool is_forced) {
    const io::EarlierFile earlier = io::read_earlier(path, campaign, use);
    compute_from(path, [&] { detail::check_known_base(campaign, earlier); });
    if (!use.only.empty()) compute_from("--only", [&] { with_earlier(campaign, earlier); });
    check_usable(path, campaign, earlier, is_forced);
    if (use.is_prior) check_prior(path, with_earlier(campaign, earlier));
    return earlier;
}

void expect_earlier(io::CampaignFile& file, const EarlierArguments& arguments) {
    if (arguments.from.empty()) return;
    const Earlier earlier =
        read_usable_earlier(arguments.from, file, arguments.use(), arguments.is_forced);
    static_cast<Campaign&>(file) = with_earlier(file, earlier);
}

io::CampaignFile read_planned(const PlanSources& sources, const EarlierUse& use,
                              std::optional<bool> prior, bool is_forced, const StopSignal& stop) {
    if (sources.estimate.empty()) {
        return io::planned_campaign(io::read_campaign(sources.campaign, stop), prior, stop);
    }
    io::CampaignFile file = read_with_prior(sources.campaign, prior, stop);
    if (file.planned_model) {
        print_warning(fmt::format("{}: planning.errors, {}, is not used: {} is of robot.errors",
                                  sources.campaign, io::error_model_name(*file.planned_model),
                                  sources.estimate));
        file.planned_model.reset();
    }
    static_cast<Campaign&>(file) =
        with_earlier(file, read_usable_earlier(sources.estimate, file, use, is_forced));
    return file;
}

void warn_of_counting_twice(const std::string& estimate, bool is_prior, const std::string& path,
                            const Measurements& measured) {
    if (!is_prior || !io::is_made_from(estimate, measured)) return;
    print_warning(fmt::format(
        "{}: was made from the measurements in {}; as a prior beside them it counts them twice",
        estimate, path));
}

std::string describe_earlier(const std::string& path, const EarlierUse& use) {
    if (path.empty()) return "";
    std::vector<std::string> found;
    if (!use.has_new_base) found.emplace_back("base");
    if (!use.has_new_targets) found.emplace_back("targets");
    found.emplace_back("errors and model error");
    std::string text =
        fmt::format("from:       {}: {} as it found them", path, fmt::join(found, ", "));
    if (use.is_prior) text += "; it is the prior, but for drift";
    if (!use.only.empty()) {
        text += fmt::format("; to be identified: {}", fmt::join(use.only, ", "));
    }
    return text + '\n';
}

std::string describe_earlier(const PlanRequest& request) {
    std::string text = describe_earlier(request.sources.estimate, request.earlier);
    const bool counts = request.earlier.is_prior || !request.sources.augment.empty();
    if (!text.empty() && !counts && request.earlier.only.empty()) {
        text +=
            "            the poses that it is from do not count; with --augment of what was "
            "measured at them they do\n";
    }
    return text + describe_exact(request.earlier);
}

std::string describe_exact(const EarlierUse& use) {
    if (use.only.empty()) return "";
    return "            the rest counts as exact: its errors come on top of what is predicted\n";
}

io::Provenance provenance_of(const CLI::App& command, const io::CampaignFile& file,
                             const std::string& path, const Measurements& measured) {
    io::Provenance made_from{path, io::checksum_of(measured), file.path, file.checksum, {}};
    made_from.record = file.record;
    const std::vector<std::string> of_no_matter{
        "--out", "--predict-out", "--all-parameters", "--report", "--plot", "--json", "--threads"};
    for (const CLI::Option* const option : command.get_options()) {
        const std::string name = option->get_name();
        const bool matters = name.starts_with("--") && !contains(of_no_matter, name.c_str());
        if (option->count() == 0 || !matters) continue;
        made_from.options.emplace_back(name, option->results());
    }
    return made_from;
}

}  // namespace posewise::cli
