#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "io/result/targets_text.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "plan_inputs.hpp"
#include "plan_options.hpp"
#include "plan_progress.hpp"
#include "plan_report.hpp"
#include "plan_target.hpp"
#include "plan_verification.hpp"
#include "plot.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/inspection.hpp"
#include "report/plot.hpp"

namespace posewise::cli {
namespace {

constexpr const char* plan_footer = R"(
Example:
  posewise plan campaign.yaml --poses 24 --verification 15 --out plan.json --targets targets.csv
  posewise plan campaign.yaml --target-mm 0.2 --assurance 0.95 --verify
  posewise plan campaign.yaml --poses 12 --augment measured.csv --criterion d
  posewise plan campaign.yaml --plan plan.json --drop p7,p12 --out repaired.json
  posewise plan campaign.yaml --from estimate.json --only base,targets --poses 5

Proposes configurations to measure: draws a pool within the joint limits, keeps what the campaign's
cell allows, chooses from it, moves each pose continuously to where it tells most, and puts the
poses in an order that is quick to visit. Nothing needs to be measured before; base and targets must
be stated in the campaign file, if only roughly. With sockets each pose of the pool is moved by least
joint steps until the ball sits in one: state where ball and sockets are, or use --from. Prints
  pool         which constraint rejected how many candidates
  predicted    position error of the calibrated robot over the workspace, by the covariance alone
  pool bound   proven: no choice from the pool has a larger value
  note         where that says little: how many starts ended at the best
  searched     no plan at all has a larger value, if the search met the best poses; not a proof
  order        time at the joints' speeds, from the cell's home; a via point where the straight
               way is not free, BLOCKED where none was found
  nearest      of each pose the two bodies that come nearest to each other: links, obstacles, and
               the balls at the targets (radius_mm)
  missing      RMS without the pose that hurts most, or without as many as --robust-to says
and tables of the poses, of the accuracy for other numbers of poses, and of how sure each parameter
will be. The workspace is drawn within the limits and the cell's target boxes, collisions excluded,
sight not asked for; --workspace or --workspace-box-mm state another.

--target-mm finds the least number of poses whose plan keeps the error below it with the probability
--assurance, over errors, sizes and model error that nobody knows yet; with --robust-to even if so
many poses are missing. "enough" says how far that number may be off: which ones are enough with 5
and with 95 % probability. Where none does, it says what is left at best, why, and how many may do
all the same: exit code 1, no plan.
--minutes takes as many as fit; with --target-mm it says whether both can be kept.

--verification adds poses to judge the calibration on (v1, v2, ...): random in the workspace, visited
after the others, so that these stay as they are without it. --minutes is without them. Measure them
into the same file: calibrate --plan calibrates without them and judges on them; 29 of them and no
error above X say that 90 % of the workspace is below X with 95 % confidence, 59 that 95 % are.

--targets writes where the instrument finds each target at each pose, in visiting order and in the
instrument's frame: name (P001_T1: target 1 at pose p1), x_mm, y_mm, z_mm, range_mm, azimuth_deg,
elevation_deg, incidence_deg (to the target's normal, if the cell states it), visible. Points measured
under these names are read by calibrate -m points.txt --plan plan.json (posewise help measurements).
A file that ends in .txt has only what is visible, and name, x, y, z, for programs that import no more.
Sensors of points have targets (column sensor: of which); posewise verify writes those of old plans.

--verify checks what is predicted, before anything is measured: robots are drawn, measured at the poses, calibrated and judged at
other places, block by block, until what it finds is sure; a limit that is not kept then is said.

--from plans for the robot as an earlier calibration found it, --as-prior for what that left open;
the 90 % interval is then as narrow as that knows the model error, and sizes that it learned;
--only base,targets for finding them again after the instrument or the tool was moved.
--augment counts what was measured already; calibrate takes both lists of points, each with its plan:
-m old.txt --plan old.json -m new.txt --plan new.json. --plan with --drop keeps the other poses of a plan as
they are and finds new ones, at least 5 deg in some joint from those that could not be reached.
Ctrl-C, SIGTERM or --time end the search with the best plan so far, marked as interrupted; exit
code 0. Before there is one, while it looks for what is identifiable, they end it with an error.
If --time is exceeded, a warning says where the time went. A plan of thousands of poses that is stopped
is in the order of nearest poses, and moves that are not free are marked as BLOCKED.
The same seed gives the same plan, on any number of threads, unless time ended it.)";

struct PlanArguments : RequestArguments {
    TargetArguments target;
    VerificationArguments verification;
    std::string csv;
    std::string targets;
    bool is_strict = false;
    std::string page;
    std::string plot;
};

void check_plan_usage(const PlanArguments& arguments) {
    const PlanRequest& request = arguments.request;
    if (!request.sources.repaired.empty()) return;
    if (!request.dropped.empty()) {
        throw CLI::ValidationError("--drop", "needs the plan to drop from, --plan");
    }
    if (request.pose_count == 0 && !arguments.target.is_stated()) {
        throw CLI::RequiredError("--poses, --target-mm or --minutes");
    }
}

std::string default_plan_out(const std::string& campaign) {
    return std::filesystem::path(campaign).stem().string() + ".poses.json";
}

TargetPlanning plan_with_progress(const io::CampaignFile& campaign, PlanningOptions& options,
                                  const PlanArguments& arguments) {
    ProgressLine line("planning", arguments.progress);
    const ProgressNote note;
    line(Progress{.total = 1}, "choosing from the pool");
    options.progress = [&](const Progress& state) { line(state, note(state)); };
    options.drop_out_count = std::max<Index>(1, arguments.target.robust_to);
    if (arguments.target.is_stated()) return plan_for_target(campaign, options, arguments.target);
    TargetPlanning made;
    made.planning = make_plan(campaign, options);
    return made;
}

/// Where there were not as many poses to verify as were asked for.
void warn_of_few(const Plan& plan) {
    const Index asked_for = plan.request.verification_count;
    const Index count = std::ssize(plan.verification);
    if (count == asked_for) return;
    print_warning(fmt::format(
        "--verification is {}, only {} poses are feasible and far enough from all others; raise {}",
        asked_for, count, plan.request.workspace_box_mm.empty() ? "--pool" : "--workspace-poses"));
}

/// Moves for which no free way was found, the ids that they lead to; with --strict an InputError.
void warn_of_cell(const Plan& plan, bool is_strict) {
    std::ranges::for_each(plan.cell_doubts, print_warning);
    std::vector<std::string> blocked;
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) {
            if (pose.is_blocked) blocked.push_back(pose.id);
        }
    }
    if (blocked.empty()) return;
    const std::string text = fmt::format("no free way was found to {}", fmt::join(blocked, ", "));
    if (is_strict) {
        throw InputError(text +
                         "; nothing is written. Try another --seed, leave poses out (--plan with "
                         "--drop), state another home_deg, or plan without --strict and find the "
                         "ways by hand");
    }
    print_warning(text + ": find one by hand before a robot is sent there; marked BLOCKED");
}

void plan(const PlanArguments& arguments, const CommonOptions& common) {
    check_plan_usage(arguments);
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    const PlanSources& sources = arguments.request.sources;
    const std::string out =
        arguments.out.empty() ? default_plan_out(sources.campaign) : arguments.out;
    std::optional<InterruptFlag> interrupted(std::in_place);
    const StopSignal stop{interrupted->get(), deadline_after(arguments.request.time_limit)};
    const io::CampaignFile campaign = read_planned(arguments, stop);
    check_outputs({&campaign},
                  {arguments.earlier.from, sources.augment, sources.measured_plan, sources.repaired,
                   sources.workspace},
                  {out, arguments.csv, arguments.targets, arguments.page, arguments.plot}, common);
    if (!arguments.targets.empty()) detail::check_has_targets(arguments.targets, campaign);
    const PlanRequest request = make_request(arguments);
    for (const OnAxis& one : find_on_axis(campaign)) print_warning(describe(one));
    PlanningOptions options = read_planning_inputs(request, campaign);
    check_verification(arguments.verification, campaign, options);
    if (!sources.repaired.empty()) options.repaired = io::read_plan(sources.repaired);
    options.richer = [&] { return io::richer_campaigns(campaign, arguments.prior); };
    options.stop = stop;
    const auto read = std::chrono::steady_clock::now();
    const TargetPlanning made = plan_with_progress(campaign, options, arguments);
    if (!arguments.verification.is_wanted) note_overtime(request.time_limit, stop, read, "plan");
    warn_of_few(made.planning->plan);
    warn_of_cell(made.planning->plan, arguments.is_strict);
    io::write_plan(out, made.planning->plan, {arguments.csv, arguments.targets},
                   made.planning->campaign, given_warnings());
    const auto simulated = verify_made(arguments.verification, made, options, arguments.progress);
    if (simulated) note_overtime(request.time_limit, stop, read, "plan and verify");
    interrupted.reset();
    report_plan({made, simulated, campaign, options, out}, arguments.page, arguments.plot, common);
}

// ---- The command line ----

void add_plan_problem(CLI::App& command, PlanArguments& problem) {
    PlanRequest& request = problem.request;
    PlanSources& sources = request.sources;
    command.add_option("CAMPAIGN", sources.campaign, "Campaign file (YAML): robot, sensor, cell")
        ->required()
        ->check(file_name());
    CLI::Option* const poses =
        command
            .add_option("-k,--poses", request.pose_count,
                        "How many configurations (with --plan: all together; default: as it has)")
            ->check(whole_number(1, 10000));
    add_criterion_option(command, problem,
                         "Criterion to plan by: o1, o2, o3, o4, o5, a, d, e, g or v; g and v: "
                         "worst and mean position error "
                         "over the workspace (default: v, with --focus d)");
    add_focus_option(command, problem);
    CLI::Option* const augment =
        command
            .add_option("--augment", sources.augment,
                        "Poses measured already (CSV or .mat; a list of points with "
                        "--augment-plan): held")
            ->check(file_name());
    add_points_options(command, sources.measured_plan, sources.points_unit,
                       "Plan whose poses --augment, a list of points, was measured at",
                       "--augment-plan");
    for (const char* const option : {"--augment-plan", "--points-unit"}) {
        command.get_option(option)->needs(augment);
    }
    CLI::Option* const repaired =
        command.add_option("--plan", sources.repaired, "Plan to repair: its poses are held")
            ->check(file_name());
    add_target_options(command, problem.target, {poses, repaired});
    add_ids_option(command, "--drop", request.dropped, "Ids of its poses to replace, by commas");
    add_prior_option(command, problem.prior, "; --poses may then be below what identifies");
    add_earlier_options(command, problem.earlier);
    command
        .add_option("--verification", request.verification_count,
                    "Poses to add that judge the calibration and are not calibrated with: random "
                    "and feasible, 5 deg or more from all others (with --plan: all together)")
        ->check(whole_number(1, 10000));
    command
        .add_option("--random-order", request.random_order,
                    "Visit the poses in a random order whose moves take at most so many times as "
                    "long as the shortest, such as 2: a drift is then not taken for a matter of "
                    "place")
        ->check(real_number(1, 1e6));
    command.add_option("--repeats", request.repeats, "Samples of each configuration")
        ->check(real_number(1, 1e9))
        ->default_val(1.0);
}

void add_plan_search(CLI::App& command, PlanArguments& arguments) {
    PlanRequest& request = arguments.request;
    command.add_option("--pool", request.pool_count, "Candidates to draw")
        ->check(whole_number(1, 10000000))
        ->default_val(Index{20000});
    command
        .add_option("--starts", request.starts,
                    "Plans refined before the best is kicked (default: 10; 16 in a cell and where "
                    "poses hardly suffice)")
        ->check(whole_number(1, 100000));
    add_effort_option(command, request.starts);
    add_search_options(command, arguments, "Seed of all draws (default: the campaign's)",
                       "<campaign>.poses.json");
    add_verification_options(command, arguments.verification);
    command
        .add_option("--csv", arguments.csv,
                    "Write the configurations as CSV, too, with the points to pass on the way")
        ->check(file_name());
    command
        .add_option(
            "--targets", arguments.targets,
            "Write where an instrument finds each target (CSV: name, x, y, z, visible, ...; "
            ".txt: name, x, y, z)")
        ->check(file_name());
    command.add_flag("--strict", arguments.is_strict,
                     "Refuse a plan with a move for which no free way was found (exit code 1)");
    add_report_option(command, arguments.page);
    add_plot_option(command, arguments.plot, "Draw the poses from the side and from above");
    add_progress_flag(command, arguments.progress);
}

}  // namespace

void add_plan(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<PlanArguments>();
    CLI::App* command =
        program.add_subcommand("plan", "Propose configurations to measure, from nothing");
    add_plan_problem(*command, *arguments);
    add_workspace_options(*command, arguments->request);
    add_plan_search(*command, *arguments);
    command->footer(plan_footer);
    command->callback([arguments, &common] { plan(*arguments, common); });
}

}  // namespace posewise::cli
