#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "options.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/units.hpp"
#include "selection_problem.hpp"

namespace posewise::cli {
namespace {

using Kind = io::CandidateSource::Kind;

constexpr const char* footer = R"(
Example:
  posewise select campaign.yaml -m measurements.csv -k 12 --criterion d
  posewise select campaign.yaml --random 2000 -k 20 --prior --least-distance-deg 10
  posewise select campaign.yaml --candidates pool.csv -k 6 --augment measured.csv
  posewise select --blocks jacobians.csv --rows 9 -k 40 --criterion a

Chooses the candidates that tell most about the parameters and writes them as a plan file (JSON)
that calibrate --plan takes and verify checks. Prints the chosen ids, the criterion's value, and
what is proven about it:
  bound       no choice of as many candidates has a larger value
  efficiency  part of the best possible information per measurement that is surely reached
  starts      how many of the starts ended at this same value; many of them: hard to beat
At few poses the bound is loose: the plan may well be the best although little is proven.

Measurements register the base and the targets; other candidates need them in the campaign file (or
measured poses, --augment). A candidate file has the columns config,q1_deg,... and perhaps
visible_targets (as plan --csv writes it), or is a measurement file; --random draws a scrambled Halton
sequence within the joint limits. A file of blocks has a row of numbers a line (or is a MATLAB
matrix), and each --rows of them are one candidate, named 0, 1, ...
A file of --groups has the columns config,group.

Ctrl-C or --time end the search with the best plan so far, written with its bound; exit code 0.
The same seed gives the same plan, on any number of threads, unless time ended it.)";

struct Arguments {
    io::SelectionRequest request;
    std::string measurements;
    std::string candidates;
    std::string blocks;
    std::optional<Index> random;
    std::string criterion;
    std::optional<bool> prior;
    std::string focus = "all";
    double least_distance_deg = 0;
    std::optional<std::uint64_t> seed;
    std::string out;
    bool progress = false;
    SelectOptions search;   ///< how hard to try
    double time_limit = 0;  ///< s; 0: none
};

// ---- From arguments to a request ----

void require_usage(bool is_right, const char* option, const std::string& rule) {
    if (!is_right) throw CLI::ValidationError(option, rule);
}

void check_usage(const Arguments& arguments) {
    const bool is_plain = !arguments.blocks.empty();
    const io::SelectionRequest& request = arguments.request;
    require_usage(is_plain == request.source.campaign.empty(), "CAMPAIGN",
                  is_plain ? "must be left out with --blocks" : "is required (but for --blocks)");
    require_usage(is_plain == (request.source.rows_per_block > 0), "--rows",
                  is_plain ? "is required with --blocks" : "goes with --blocks only");
    const std::string& blocks = arguments.blocks;
    require_usage(
        request.source.variable.empty() || blocks.ends_with(".mat") || blocks.ends_with(".MAT"),
        "--variable", "goes with --blocks and a MATLAB file only");
    require_usage(!is_plain || request.source.repeats == 0, "--repeats", "needs a robot");
    require_usage(!is_plain || arguments.focus == "all", "--focus", "needs a robot");
    require_usage(!is_plain || arguments.least_distance_deg == 0, "--least-distance-deg",
                  "needs a robot");
    require_usage(request.groups.empty() == (request.group_limit == 0), "--groups",
                  "and --per-group need each other");
}

/// What the campaign file says where the command line does not.
void apply_campaign_defaults(Arguments& arguments) {
    io::SelectionRequest& request = arguments.request;
    std::optional<io::CampaignFile> file;
    if (!request.source.campaign.empty()) file = io::read_campaign(request.source.campaign);
    request.criterion = !arguments.criterion.empty() ? parse_criterion(arguments.criterion)
                        : file                       ? file->criterion
                                                     : Criterion::D;
    request.has_prior = arguments.prior.value_or(file && file->spread.is_prior);
    arguments.search.seed = arguments.seed.value_or(file ? file->seed : 1);
}

io::SelectionRequest make_request(Arguments& arguments) {
    check_usage(arguments);
    apply_campaign_defaults(arguments);
    io::SelectionRequest request = arguments.request;
    io::CandidateSource& source = request.source;
    if (arguments.random) {
        source.kind = Kind::Random;
        source.count = *arguments.random;
        source.seed = arguments.search.seed;
    } else if (!arguments.candidates.empty()) {
        source.kind = Kind::Configurations;
    } else if (!arguments.blocks.empty()) {
        source.kind = Kind::Blocks;
    }
    source.path = arguments.measurements + arguments.candidates + arguments.blocks;  // one is given
    request.is_focused_on_robot = arguments.focus == "robot";
    request.least_distance = to_radians(arguments.least_distance_deg);
    return request;
}

// ---- From a plan to file and text ----

io::PlanFile make_plan_file(const SelectionProblem& problem, const Choice& plan) {
    io::PlanFile file;
    file.request = problem.request;
    file.candidate_count = problem.blocks.count();
    file.checksum = problem.checksum;
    file.plan = plan;
    for (std::size_t i = 0; i < plan.poses.size(); ++i) {
        const Index pose = plan.poses[i];
        if (i > 0 && pose == plan.poses[i - 1]) {
            ++file.poses.back().times;
            continue;
        }
        file.poses.push_back({problem.ids[static_cast<std::size_t>(pose)], 1, {}});
        if (problem.campaign) file.poses.back().joints = problem.configurations.row(pose);
    }
    return file;
}

/// What the bound says, in words, where the numbers alone may mislead.
std::string describe_proof(const Choice& plan) {
    if (plan.ending == Ending::Optimal) {
        return "proof:      optimal: every other choice is ruled out by the bound or was tried\n";
    }
    const std::string looseness =
        describe_looseness(plan.efficiency, plan.starts_at_best, plan.starts);
    return looseness.empty() ? "" : "note:       " + looseness + '\n';
}

void print_plan(const io::PlanFile& file) {
    const Choice& plan = file.plan;
    std::string ids;
    for (const io::PlannedPose& pose : file.poses) {
        ids += (ids.empty() ? "" : " ") + pose.id;
        if (pose.times > 1) ids += fmt::format(" (x{})", pose.times);
    }
    print(fmt::format(
        "chosen:     {}\ncriterion:  {}\nvalue:      {}\nbound:      {}\n"
        "efficiency: {} proven\nstarts:     {} of {} ended here, {}\n{}",
        ids, criterion_name(plan.criterion), format_short(plan.value, 8),
        format_short(plan.bound, 8), format_fixed(plan.efficiency, 4), plan.starts_at_best,
        plan.starts, ending_name(plan.ending), describe_proof(plan)));
}

std::string default_out(const io::CandidateSource& source) {
    const std::string& path = source.path.empty() ? source.campaign : source.path;
    return std::filesystem::path(path).stem().string() + ".plan.json";
}

Choice search(SelectionProblem& problem, const Arguments& arguments, const StopSignal& stop) {
    SelectOptions& options = problem.options;
    options.starts = arguments.search.starts;
    options.seed = arguments.search.seed;
    options.stop = stop;
    ProgressLine line("selecting", arguments.progress);
    options.progress = [&](const Progress& progress) { line(progress); };
    return select_poses(problem.blocks, options);
}

void select(Arguments arguments) {
    const io::SelectionRequest request = make_request(arguments);
    const std::string out = arguments.out.empty() ? default_out(request.source) : arguments.out;
    check_outputs({request.source.campaign, request.source.path, request.augment,
                   request.test_poses, request.groups},
                  {out});
    const InterruptFlag interrupted;
    const StopSignal stop{interrupted.get(), deadline_after(arguments.time_limit)};
    SelectionProblem problem = read_problem(request, stop.with_half_the_time());
    if (problem.request.source.count < request.source.count) {
        print_warning(
            fmt::format("only {} of the {} random candidates were drawn in the time there was",
                        problem.request.source.count, request.source.count));
    }
    const io::PlanFile file = make_plan_file(problem, search(problem, arguments, stop));
    const io::CampaignFile* campaign = problem.campaign ? &*problem.campaign : nullptr;
    io::write_plan(out, file, campaign);
    print_plan(file);
    if (campaign != nullptr) {
        print(describe_scaling(*campaign, problem.request.source.repeats));
    }
    if (problem.request.has_prior) print("prior:      the scale, as standard deviation\n");
    print("plan:       " + out + '\n');
    if (file.plan.ending == Ending::Interrupted) {
        std::fputs("posewise: interrupted; the plan is the best so far\n", stderr);
    }
}

// ---- The command line ----

void add_sources(CLI::App& command, Arguments& arguments) {
    io::CandidateSource& source = arguments.request.source;
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
        .add_option("--repeats", source.repeats,
                    "Samples of each chosen configuration (default: as in the file, else 1)")
        ->check(real_number(1, 1e9));
}

void add_problem(CLI::App& command, Arguments& arguments) {
    io::SelectionRequest& request = arguments.request;
    const auto count = whole_number(1, 1000000);
    command.add_option("-k,--poses", request.pose_count, "How many to choose")
        ->required()
        ->check(count);
    command
        .add_option("-c,--criterion", arguments.criterion,
                    "o1, o2, o3, o4, o5, a, d, e, g or v (default: the campaign's, else d)")
        ->check(criterion_check());
    command
        .add_option("--test-poses", request.test_poses,
                    "g and v: predict these (as --candidates; default: the candidates)")
        ->check(file_name());
    add_prior_option(command, arguments.prior, "; --poses may then be below what identifies");
    command
        .add_option("--focus", arguments.focus,
                    "all, or robot: base and targets are estimated along, but do not count")
        ->check(CLI::IsMember({"all", "robot"}))
        ->capture_default_str();
    command
        .add_option("--augment", request.augment,
                    "Poses measured already: their information is there, they are not chosen")
        ->check(file_name());
    add_ids_option(command, "--exclude", request.excluded, "Ids not to choose, by commas");
    command.add_option("--groups", request.groups, "CSV that gives each candidate a group")
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

void add_search(CLI::App& command, Arguments& arguments) {
    command.add_option("--starts", arguments.search.starts, "Independent searches")
        ->check(whole_number(1, 1000000))
        ->capture_default_str();
    command
        .add_option("--seed", arguments.seed,
                    "Of the random starts and of --random (default: the campaign's, else 1)")
        ->check(whole_number(0, largest_seed));
    command.add_option("--time", arguments.time_limit, "Seconds after which to stop")
        ->check(real_number(1e-3, 1e9));
    command
        .add_option("-o,--out", arguments.out,
                    "Plan file (default: <candidates>.plan.json in this folder)")
        ->check(file_name());
    command.add_flag("--progress", arguments.progress,
                     "Show progress on standard error even if it is no terminal");
}

}  // namespace

void add_select(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command = program.add_subcommand(
        "select", "Choose the most informative configurations, with a proven bound");
    add_sources(*command, *arguments);
    add_problem(*command, *arguments);
    add_search(*command, *arguments);
    command->footer(footer);
    command->callback([arguments] { select(*arguments); });
}

}  // namespace posewise::cli
