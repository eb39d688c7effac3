#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "plan_inputs.hpp"
#include "plan_options.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

constexpr const char* select_footer = R"(
Example:
  posewise select campaign.yaml -m measurements.csv -k 12 -c d --proof 60
  posewise select campaign.yaml --random 2000 -k 20 --prior --least-distance-deg 10
  posewise select campaign.yaml --candidates pool.csv -k 6 --augment measured.csv
  posewise select --blocks jacobians.csv --rows 9 -k 40 --criterion a

Chooses the candidates that tell most about the parameters, writes them as a plan file (JSON) for
calibrate --plan and verify, prints the chosen ids, the criterion's value and what is proven:
  bound       no choice of as many candidates has a larger value
  efficiency  part of the best possible information per measurement that is surely reached
  starts      how many of the starts ended at this same value; five that agree end the search
  proof       optimal: branch and bound ruled out or tried all other choices; else what it tried

Measurements register the base and the targets; other candidates need them in the campaign file (or
measured poses, --augment). A candidate file has the columns config,q1_deg,... and perhaps
visible_targets (as plan --csv writes it), or is a measurement file; --random draws a Halton sequence
within the limits. A file of blocks has a row of numbers a line (or is a MATLAB matrix), each --rows of
them one candidate, named 0, 1, ... One of --groups: columns config,group.
Ctrl-C or --time end the search with the best plan so far, written with its bound; exit code 0. The
same seed gives the same plan, on any number of threads, unless time ended it.)";

struct SelectArguments : RequestArguments {
    std::string measurements;
    std::string candidates;
    std::string blocks;
    Index random = 0;  ///< how many; 0: others
    double least_distance_deg = 0;
};

void require_usage(bool is_right, const char* option, const std::string& rule) {
    if (!is_right) throw CLI::ValidationError(option, rule);
}

void check_select_usage(const SelectArguments& arguments) {
    const std::string& blocks = arguments.blocks;
    const bool is_plain = !blocks.empty();
    const PlanRequest& request = arguments.request;
    const PlanSources& sources = request.sources;
    require_usage(is_plain == sources.campaign.empty(), "CAMPAIGN",
                  is_plain ? "must be left out with --blocks" : "is required (but for --blocks)");
    require_usage(is_plain == (sources.rows_per_block > 0), "--rows",
                  is_plain ? "is required with --blocks" : "goes with --blocks only");
    require_usage(sources.variable.empty() || blocks.ends_with(".mat") || blocks.ends_with(".MAT"),
                  "--variable", "goes with --blocks and a MATLAB file only");
    require_usage(!is_plain || request.repeats == 0, "--repeats", "needs a robot");
    require_usage(!is_plain || arguments.focus == "all", "--focus", "needs a robot");
    require_usage(!is_plain || arguments.least_distance_deg == 0, "--least-distance-deg",
                  "needs a robot");
    require_usage(sources.groups.empty() == (request.group_limit == 0), "--groups",
                  "and --per-group need each other");
}

CandidateKind kind_of(const SelectArguments& arguments) {
    if (arguments.random > 0) return CandidateKind::Random;
    if (!arguments.candidates.empty()) return CandidateKind::Configurations;
    return arguments.blocks.empty() ? CandidateKind::Measurements : CandidateKind::Blocks;
}

PlanRequest complete_request(const SelectArguments& arguments, const io::CampaignFile* campaign) {
    PlanRequest request =
        make_request(arguments, campaign, campaign != nullptr ? campaign->criterion : Criterion::D);
    request.sources.candidates = arguments.measurements + arguments.candidates + arguments.blocks;
    request.least_distance = to_radians(arguments.least_distance_deg);
    return request;
}

std::string default_select_out(const PlanSources& sources) {
    const std::string& path = sources.candidates.empty() ? sources.campaign : sources.candidates;
    return std::filesystem::path(path).stem().string() + ".plan.json";
}

void print_plan(const Plan& plan, const io::CampaignFile* campaign, const std::string& out) {
    print(format_choice(plan));
    if (campaign != nullptr) print(describe_planned(*campaign, plan.request.repeats));
    print("plan:       " + out + '\n');
    if (plan.ending == Ending::Interrupted) {
        std::fputs("posewise: interrupted; the plan is the best so far\n", stderr);
    }
}

void select(const SelectArguments& arguments) {
    check_select_usage(arguments);
    std::optional<InterruptFlag> interrupted(std::in_place);
    const StopSignal stop{interrupted->get(), deadline_after(arguments.request.time_limit)};
    std::optional<io::CampaignFile> file;
    const std::string& path = arguments.request.sources.campaign;
    if (!path.empty()) file = io::read_planned_campaign(path, arguments.prior);
    const PlanRequest request = complete_request(arguments, file ? &*file : nullptr);
    const PlanSources& sources = request.sources;
    const std::string out = arguments.out.empty() ? default_select_out(sources) : arguments.out;
    check_outputs(
        {sources.campaign, sources.candidates, sources.augment, sources.test_poses, sources.groups},
        {out});
    ChoiceInputs inputs =
        read_choice_inputs(request, kind_of(arguments), arguments.random, std::move(file));
    inputs.options.stop = stop;
    ProgressLine line("selecting", arguments.progress);
    inputs.options.progress = [&](const Progress& state) { line(state); };
    const Plan plan = inputs.campaign ? choose(*inputs.campaign, inputs.candidates, inputs.options)
                                      : choose(inputs.blocks, inputs.options);
    if (plan.candidate_count < arguments.random) {
        print_warning(
            fmt::format("only {} of the {} random candidates were drawn in the time there was",
                        plan.candidate_count, arguments.random));
    }
    io::write_plan(out, plan);
    interrupted.reset();
    print_plan(plan, inputs.campaign ? &*inputs.campaign : nullptr, out);
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
    group.add_option("--blocks", arguments.blocks, "A plain matrix, CSV or MATLAB .mat; no robot")
        ->check(file_name());
    group.require_option(1);
    command.add_option("--rows", source.rows_per_block, "--blocks: rows of one candidate")
        ->check(whole_number(1, 1000000));
    command.add_option("--variable", source.variable,
                       "--blocks: variable of the MATLAB file (default: the first)");
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
    add_criterion_option(
        command, arguments,
        "o1, o2, o3, o4, o5, a, d, e, g or v (default: the campaign's, else v; with "
        "--focus robot or --blocks d)");
    command
        .add_option("--test-poses", request.sources.test_poses,
                    "g and v: predict these (as --candidates; default: the candidates)")
        ->check(file_name());
    add_prior_option(command, arguments.prior, "; --poses may then be below what identifies");
    add_focus_option(command, arguments);
    command
        .add_option("--augment", request.sources.augment,
                    "Poses measured already: their information is there, they are not chosen")
        ->check(file_name());
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
    PlanRequest& request = arguments.request;
    command
        .add_option("--starts", request.starts, "Searches (default: until five agree, 2 to 100)")
        ->check(whole_number(1, 1000000));
    command.add_option("--proof", request.proof, "CPU s for branch and bound (default: 3 at most)")
        ->check(real_number(0, 1e9));
    add_search_options(command, arguments,
                       "Of the random starts and of --random (default: the campaign's, else 1)",
                       "<candidates>.plan.json");
    add_progress_flag(command, arguments);
}

}  // namespace

void add_select(CLI::App& program) {
    const auto arguments = std::make_shared<SelectArguments>();
    CLI::App* command = program.add_subcommand(
        "select", "Choose the most informative configurations, with a proven bound");
    add_sources(*command, *arguments);
    add_select_problem(*command, *arguments);
    add_select_search(*command, *arguments);
    command->footer(select_footer);
    command->callback([arguments] { select(*arguments); });
}

}  // namespace posewise::cli
