#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "../core/format.hpp"
#include "../core/text.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "plan_inputs.hpp"
#include "plan_options.hpp"
#include "posewise/io/json_reports.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

constexpr const char* plan_footer = R"(
Example:
  posewise plan campaign.yaml --poses 24 --out plan.json --csv poses.csv
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
and tables of the poses, of the accuracy for other numbers of poses, and of how sure each parameter
will be. The workspace is drawn within the limits and the cell's target boxes, collisions excluded,
sight not asked for; --workspace or --workspace-box-mm state another.

--from plans for the robot as an earlier calibration found it, --as-prior for what that left open;
the 90 % interval is then as narrow as that knows the model error, and sizes that it learned;
--only base,targets for finding them again after the instrument or the tool was moved.
--augment counts what was measured already. --plan with --drop keeps the other poses of a plan as
they are and finds new ones, at least 5 deg in some joint from those that could not be reached.
Ctrl-C or --time end the search with the best plan so far, marked as interrupted; exit code 0.
Before there is one, while it looks for what is identifiable, they end it with an error. What a
limit that was not kept went to is said.
The same seed gives the same plan, on any number of threads, unless time ended it.)";

struct PlanArguments : RequestArguments {
    std::string csv;
};

/// "best 12.3, efficiency 0.95, about 7 s left".
class ProgressNote {
  public:
    std::string operator()(const Progress& state) const {
        using Seconds = std::chrono::duration<double>;
        const double elapsed = Seconds(std::chrono::steady_clock::now() - begin_).count();
        const double left = elapsed * static_cast<double>(state.total - state.done) /
                            static_cast<double>(state.done);
        // Unknown while the choice from the whole pool is still being made.
        const std::string efficiency = state.efficiency > 0
                                           ? fmt::format(", efficiency {} over the pool",
                                                         detail::format_fixed(state.efficiency, 3))
                                           : "";
        return fmt::format("best {}{}, about {:.0f} s left", detail::format_short(state.value),
                           efficiency, left);
    }

  private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

void check_plan_usage(const PlanArguments& arguments) {
    const PlanRequest& request = arguments.request;
    if (!request.sources.repaired.empty()) return;
    if (!request.dropped.empty()) {
        throw CLI::ValidationError("--drop", "needs the plan to drop from, --plan");
    }
    if (request.pose_count == 0) throw CLI::RequiredError("--poses");
}

std::string default_plan_out(const std::string& campaign) {
    return std::filesystem::path(campaign).stem().string() + ".poses.json";
}

void print_planning(const Planning& planning, const io::CampaignFile& campaign,
                    const std::string& out, const CommonOptions& common) {
    const Plan& plan = planning.plan;
    const bool is_stopped = plan.is_stopped_early();
    const auto counts = is_stopped ? std::vector<CountAccuracy>() : predict_other_counts(planning);
    if (is_stopped) std::fputs("posewise: stopped early; the plan is the best so far\n", stderr);
    if (common.json) return print(io::to_json(planning, counts, out));
    print(format_planning(planning));
    print(is_stopped
              ? "\nPredicted position error by number of poses: left out, planning was stopped\n"
              : format_other_counts(counts, planning.campaign));
    print(format_deviations(plan));
    print(fmt::format("\n{}{}plan:        {}\n", describe_planned(campaign, plan.request.repeats),
                      describe_earlier(plan.request), detail::escape_controls(out)));
}

Planning plan_with_progress(const io::CampaignFile& campaign, PlanningOptions& options,
                            bool shows_progress) {
    ProgressLine line("planning", shows_progress);
    const ProgressNote note;
    line(Progress{.total = 1}, "choosing from the pool");
    options.progress = [&](const Progress& state) { line(state, note(state)); };
    return make_plan(campaign, options);
}

void plan(const PlanArguments& arguments, const CommonOptions& common) {
    check_plan_usage(arguments);
    const PlanSources& sources = arguments.request.sources;
    const std::string out =
        arguments.out.empty() ? default_plan_out(sources.campaign) : arguments.out;
    std::optional<InterruptFlag> interrupted(std::in_place);
    const StopSignal stop{interrupted->get(), deadline_after(arguments.request.time_limit)};
    const io::CampaignFile campaign = read_planned(arguments, stop);
    check_outputs({&campaign},
                  {arguments.earlier.from, sources.augment, sources.repaired, sources.workspace},
                  {out, arguments.csv}, common);
    const PlanRequest request = make_request(arguments, &campaign, Criterion::V);
    PlanningOptions options = read_planning_inputs(request, campaign);
    if (!sources.repaired.empty()) options.repaired = io::read_plan(sources.repaired);
    options.stop = stop;
    const auto read = std::chrono::steady_clock::now();
    const Planning planning = plan_with_progress(campaign, options, arguments.progress);
    note_overtime(request.time_limit, stop, read, "plan");
    io::write_plan(out, planning.plan, arguments.csv, planning.campaign);
    interrupted.reset();
    print_planning(planning, campaign, out, common);
}

// ---- The command line ----

void add_plan_problem(CLI::App& command, PlanArguments& problem) {
    PlanRequest& request = problem.request;
    PlanSources& sources = request.sources;
    command.add_option("CAMPAIGN", sources.campaign, "Campaign file (YAML): robot, sensor, cell")
        ->required()
        ->check(file_name());
    command
        .add_option("-k,--poses", request.pose_count,
                    "How many configurations (with --plan: all together; default: as it has)")
        ->check(whole_number(1, 10000));
    add_criterion_option(
        command, problem,
        "o1, o2, o3, o4, o5, a, d, e, g or v; g and v: worst and mean position error "
        "over the workspace (default: v, with --focus robot d)");
    add_focus_option(command, problem);
    command.add_option("--augment", sources.augment, "Poses measured already (CSV or .mat): held")
        ->check(file_name());
    command.add_option("--plan", sources.repaired, "Plan to repair: its poses are held")
        ->check(file_name());
    add_ids_option(command, "--drop", request.dropped, "Ids of its poses to replace, by commas");
    add_prior_option(command, problem.prior, "; --poses may then be below what identifies");
    add_earlier_options(command, problem.earlier);
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
                    "Plans refined before the best is kicked (default: until five agree, 1 to 16)")
        ->check(whole_number(1, 100000));
    add_search_options(command, arguments, "Of all draws (default: the campaign's)",
                       "<campaign>.poses.json");
    command.add_option("--csv", arguments.csv, "Write the configurations as CSV, too")
        ->check(file_name());
    add_progress_flag(command, arguments);
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
