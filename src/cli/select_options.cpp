#include "select_options.hpp"

#include "blocks_options.hpp"
#include "common.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "page.hpp"

namespace posewise::cli {
namespace {

void require_usage(bool is_right, const char* option, const std::string& rule) {
    if (!is_right) throw CLI::ValidationError(option, rule);
}

void add_sources(CLI::App& command, SelectArguments& arguments) {
    PlanSources& source = arguments.request.sources;
    command.add_option("CAMPAIGN", source.campaign,
                       "Campaign file (YAML): robot, sensor, spread; not with --blocks");
    CLI::Option_group& group =
        *command.add_option_group("Candidates", "one of these says what to choose from");
    group.add_option("-m,--measurements", arguments.measurements,
                     "Measured configurations (CSV, or MATLAB .mat)");
    group.add_option("--candidates", arguments.candidates, "Configurations to choose from (CSV)");
    group
        .add_option("--random", arguments.random, "As many configurations within the joint limits")
        ->check(whole_number(1, 10000000));
    add_blocks_option(group, arguments.blocks);
    group.require_option(1);
    add_blocks_layout(command, source);
    command
        .add_option("--repeats", arguments.request.repeats,
                    "Samples of each chosen configuration (default: as in the file, else 1)")
        ->check(real_number(1, 1e9));
}

void add_select_problem(CLI::App& command, SelectArguments& arguments) {
    PlanRequest& request = arguments.request;
    const auto count = whole_number(1, 1000000);
    command.add_option("-k,--poses", request.pose_count, "How many to choose")
        ->required()
        ->check(count);
    add_criterion_option(command, arguments,
                         "Criterion to choose by: o1, o2, o3, o4, o5, a, d, e, g or v (default: "
                         "the campaign's, else v; with "
                         "--focus or --blocks d)");
    command
        .add_option("--test-poses", request.sources.test_poses,
                    "Poses that g and v predict (as --candidates; default: the candidates)")
        ->check(file_name());
    add_prior_option(command, arguments.prior, "; --poses may then be below what identifies");
    add_earlier_options(command, arguments.earlier);
    let_force_take_measured(command);
    add_focus_option(command, arguments);
    command
        .add_option("--augment", request.sources.augment,
                    "Poses measured already: their information is there, they are not chosen")
        ->check(file_name());
    add_points_options(command, request.sources.measured_plan, request.sources.points_unit,
                       "Plan whose poses -m or --augment, a list of points, was measured at");
    add_ids_option(command, "--exclude", request.excluded, "Ids not to choose, by commas");
    command.add_option("--groups", request.sources.groups, "CSV that gives each candidate a group")
        ->check(file_name());
    command.add_option("--per-group", request.group_limit, "At most so many of one group")
        ->check(count);
    command
        .add_option("--repeat-limit", request.repeat_limit, "How often one candidate may be chosen")
        ->check(count)
        ->capture_default_str();
    command
        .add_option("--least-distance-deg", arguments.least_distance_deg,
                    "Least distance in joint space (Euclidean) of any two chosen")
        ->check(real_number(0, 1e4));
}

void add_select_search(CLI::App& command, SelectArguments& arguments) {
    command
        .add_option("--starts", arguments.request.starts,
                    "Independent searches (default: until ten agree, 2 to 100)")
        ->check(whole_number(1, 1000000));
    command
        .add_option("--proof", arguments.request.proof,
                    "CPU seconds for branch and bound (default: 0.7 at most)")
        ->check(real_number(0, 1e9));
    CLI::Option* const effort =
        add_effort_option(command, arguments.request.starts, &arguments.request.proof);
    add_search_options(command, arguments,
                       "Of the random starts and of --random (default: the campaign's, else 1)",
                       "<candidates>.plan.json");
    add_report_option(command, arguments.page);
    add_progress_flag(command, arguments.progress);
    effort->excludes(
        command.add_flag("--relax", arguments.relaxes,
                         "Weights and bound instead of a choice; --out writes them (.csv or "
                         ".json)"));
    add_digits_option(command, arguments.digits);
}

}  // namespace

void add_select_options(CLI::App& command, SelectArguments& arguments) {
    add_sources(command, arguments);
    add_select_problem(command, arguments);
    add_select_search(command, arguments);
}

void check_select_usage(const SelectArguments& arguments) {
    const std::string& blocks = arguments.blocks;
    const bool is_plain = !blocks.empty();
    const PlanRequest& request = arguments.request;
    const PlanSources& sources = request.sources;
    require_usage(is_plain == sources.campaign.empty(), "CAMPAIGN",
                  is_plain ? "must be left out with --blocks" : "is required (but for --blocks)");
    check_blocks_usage(blocks, sources);
    require_usage(!is_plain || request.repeats == 0, "--repeats", "needs a robot");
    require_usage(!arguments.earlier.is_forced || !arguments.earlier.from.empty() ||
                      !arguments.measurements.empty(),
                  "--force", "is of an estimate or of measurements; needs --from or -m");
    require_usage(!is_plain || arguments.focus == "all", "--focus", "needs a robot");
    require_usage(!is_plain || arguments.earlier.from.empty(), "--from", "needs a robot");
    require_usage(sources.measured_plan.empty() || !arguments.measurements.empty() ||
                      (!is_plain && !sources.augment.empty()),
                  "--plan", "joins a list of points; needs -m or --augment");
    require_usage(sources.points_unit.empty() || !sources.measured_plan.empty(), "--points-unit",
                  "needs --plan");
    const bool has_distance = arguments.least_distance_deg != 0;
    require_usage(!is_plain || !has_distance, "--least-distance-deg", "needs a robot");
    require_usage(sources.groups.empty() == (request.group_limit == 0), "--groups",
                  "and --per-group need each other");
    if (!arguments.relaxes) return;
    const std::string& out = arguments.out;
    require_usage(sources.groups.empty(), "--groups", "cannot be kept by weights, --relax");
    require_usage(!has_distance, "--least-distance-deg", "cannot be kept by weights, --relax");
    require_usage(arguments.page.empty(), "--report", "shows a plan, which --relax makes none of");
    require_usage(request.starts == 0, "--starts", "are of a search, which --relax does not need");
    require_usage(!request.proof, "--proof", "is of a choice, which --relax makes none of");
    require_usage(!arguments.progress, "--progress", "is of a search, which --relax does not need");
    require_usage(out.empty() || out.ends_with(".csv") || out.ends_with(".json"), "--out",
                  "must end in .csv or .json with --relax");
}

}  // namespace posewise::cli
