#include "study_options.hpp"

#include <algorithm>
#include <charconv>

#include "blocks_options.hpp"
#include "core/text.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "page.hpp"
#include "plot.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::cli {
namespace {

Index parse_count(std::string_view text) {
    Index count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size() || count < 1 || count > 1000000) {
        throw CLI::ValidationError(
            "--poses", detail::quote(text) + " is not a pose count; must be like 5:24 or 6,9,12");
    }
    return count;
}

/// "5:24" (or "5..24") and "6,9,12", and both mixed.
std::vector<Index> parse_counts(const std::string& text) {
    std::vector<Index> counts;
    for (std::string part : CLI::detail::split(text, ',')) {
        if (const auto dots = part.find(".."); dots != std::string::npos)
            part.replace(dots, 2, ":");
        const auto colon = part.find(':');
        const Index first = parse_count(part.substr(0, colon));
        const Index last = colon == std::string::npos ? first : parse_count(part.substr(colon + 1));
        if (first > last) {
            throw CLI::ValidationError(
                "--poses", "is " + detail::quote(part) + "; the first must not be above the last");
        }
        for (Index count = first; count <= last; ++count) counts.push_back(count);
    }
    if (counts.empty()) throw CLI::ValidationError("--poses", "'" + text + "' holds no pose count");
    return counts;
}

/// Names separated by commas; what is wrong with one is said of the option.
template <class Parse>
auto parse_names(const std::string& text, const char* option, const char* example, Parse&& parse) {
    std::vector<decltype(parse(text))> values;
    try {
        for (const std::string& name : CLI::detail::split(text, ',')) {
            const auto value = parse(name);
            if (std::find(values.begin(), values.end(), value) != values.end()) {
                throw InputError("names " + detail::quote(name) + " twice; keep one");
            }
            values.push_back(value);
        }
    } catch (const InputError& error) {
        throw CLI::ValidationError(option, error.what());
    }
    if (values.empty()) {
        throw CLI::ValidationError(option, std::string("is empty; must be like ") + example);
    }
    return values;
}

}  // namespace

void add_blocks_study_options(CLI::App& command, StudyArguments& arguments) {
    BlocksStudyArguments& plain = arguments.plain;
    CLI::Option* const blocks = add_blocks_option(command, plain.blocks);
    add_blocks_layout(command, plain.sources);
    command
        .add_option(
            "--subset", plain.subsets,
            "With --blocks: candidates to compare, by number from 0 (text, .npy), or a plan "
            "of select; may be repeated")
        ->check(file_name())
        ->needs(blocks);
    command
        .add_option("--augment", plain.sources.augment,
                    "With --blocks: poses measured already, whose information is there")
        ->check(file_name())
        ->needs(blocks);
}

void add_study_options(CLI::App& command, StudyArguments& arguments) {
    command.add_option_function<std::string>(
        "-c,--criteria",
        [&arguments](const std::string& text) {
            arguments.criteria = parse_names(text, "--criteria", "d,a", parse_criterion);
        },
        "Criteria to choose by, such as v,d,o1 (default: the campaign's, else v)");
    add_points_options(command, arguments.paths.plan, arguments.paths.points_unit,
                       "Plan whose poses a list of points was measured at");
    add_exclude_option(command, arguments.excluded);
    command
        .add_option(
            "--random", arguments.random_subsets,
            "Random subsets per pose count (default: 100; with --simulate 1 for each robot)")
        ->check(whole_number(0, 1000000));
    command
        .add_option(
            "--splits", arguments.options.splits,
            "Splits into configurations to choose from and to judge all subsets on; 0: "
            "each is judged on what it leaves, planned ones then on easier poses (default: "
            "10, or 0 where no pose count is up to a third of what there is to choose from)")
        ->check(whole_number(0, 1000));
    command
        .add_option("--holdout", arguments.options.holdout,
                    "Part of the configurations that a split judges on (default: 0.3)")
        ->check(real_number(0.01, 0.99));
    command.add_option_function<std::string>(
        "-k,--poses",
        [&arguments](const std::string& text) {
            arguments.options.pose_counts = parse_counts(text);
        },
        "Pose counts, 5:24 or 6,9,12 (default: 8,12,16,20,30,50 up to a third of what there is to "
        "choose from; without splits from the least that identifies to all but one, of fewer than "
        "50 to all but "
        "a fifth)");
    add_prior_option(command, arguments.prior, ": of choice and calibration alike");
    add_earlier_options(command, arguments.earlier);
    let_force_take_measured(command);
    CLI::Option* const models = command.add_option_function<std::string>(
        "--models",
        [&arguments](const std::string& text) {
            arguments.models =
                parse_names(text, "--models", "geometric,full", io::parse_error_model);
        },
        "Error models of the robot to compare on the same splits and random subsets, of full, "
        "geometric and stated (default: the campaign's alone)");
    models->excludes("--from");
    command
        .add_option("--least-distance-deg", arguments.least_distance_deg,
                    "Least distance in joint space (Euclidean) of any two planned; random subsets "
                    "are drawn without it")
        ->check(real_number(0, 1e4));
    command
        .add_option("--starts", arguments.options.starts,
                    "Starts of each search (default: 4, of more than 200 candidates 1)")
        ->check(whole_number(1, 1000000));
    add_effort_option(command, arguments.options.starts, &arguments.proof);
    command.add_option("--seed", arguments.seed, "Of all random choices (default: the campaign's)")
        ->check(whole_number(0, largest_seed));
    command
        .add_option("--time", arguments.time_limit,
                    "Seconds after which it ends with what is finished (default: none)")
        ->check(real_number(1e-3, 1e9));
    command.add_option("--csv", arguments.csv, "Write every subset's result to this file")
        ->check(file_name());
    add_plot_option(command, arguments.plot, "Draw error against pose count");
    add_report_option(command, arguments.page);
    add_progress_flag(command, arguments.progress);
}

}  // namespace posewise::cli
