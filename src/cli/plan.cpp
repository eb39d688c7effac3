#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "options.hpp"
#include "plan_report.hpp"
#include "planning_problem.hpp"
#include "posewise/core/format.hpp"
#include "posewise/selection/bound.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise plan campaign.yaml --poses 24 --out plan.json --csv poses.csv
  posewise plan campaign.yaml --poses 12 --augment measured.csv --criterion d
  posewise plan campaign.yaml --plan plan.json --drop p7,p12 --out repaired.json

Proposes configurations to measure: draws a pool within the joint limits, keeps what the campaign's
cell allows, chooses from it, moves each pose continuously to where it tells most, and puts the
poses in an order that is quick to visit. Nothing needs to be measured before; base and targets must
be stated in the campaign file, if only roughly. Prints
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

--augment counts what was measured already. --plan with --drop keeps the other poses of a plan as
they are and finds new ones, at least 5 deg in some joint from those that could not be reached.
Ctrl-C or --time end the search with the best plan so far, marked as interrupted; exit code 0.
The same seed gives the same plan, on any number of threads, unless time ended it.)";

struct Arguments {
    PlanningArguments problem;
    std::string focus = "all";
    std::string out;
    std::string csv;
    bool progress = false;
};

/// "best 12.3, efficiency 0.95, about 7 s left".
class ProgressNote {
  public:
    std::string operator()(const Progress& progress) const {
        using Seconds = std::chrono::duration<double>;
        const double elapsed = Seconds(std::chrono::steady_clock::now() - begin_).count();
        const double left = elapsed * static_cast<double>(progress.total - progress.done) /
                            static_cast<double>(progress.done);
        // Unknown while the choice from the whole pool is still being made.
        const std::string efficiency =
            progress.efficiency > 0
                ? fmt::format(", efficiency {} over the pool", format_fixed(progress.efficiency, 3))
                : "";
        return fmt::format("best {}{}, about {:.0f} s left", format_short(progress.value),
                           efficiency, left);
    }

  private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

PlannedPoses search(PlanningProblem& problem, const StopSignal& stop, bool shows_progress) {
    PlanOptions options = problem.options;
    options.stop = stop;
    if (needs_test_poses(options.criterion)) {
        options.test_poses = &problem.prediction;
    }
    ProgressLine line("planning", shows_progress);
    const ProgressNote note;
    line({.total = options.starts}, "choosing from the pool");
    options.progress = [&](const Progress& progress) { line(progress, note(progress)); };
    return plan_poses(problem.campaign, problem.constraints, problem.pool, problem.request.repeats,
                      options);
}

/// p1, p2, ... but for those that poses kept have.
class NewIds {
  public:
    explicit NewIds(const PlanningProblem& problem)
        : taken_(problem.request.dropped.begin(), problem.request.dropped.end()) {
        for (const io::ContinuousPose& pose : problem.kept) taken_.insert(pose.id);
    }
    std::string next() {
        std::string id;
        do id = fmt::format("p{}", ++last_);
        while (taken_.count(id) > 0);
        return id;
    }

  private:
    std::set<std::string> taken_;
    int last_ = 0;
};

/// All poses, kept and new, in the order of the tour; new ones are named in it.
std::vector<io::ContinuousPose> arrange(const PlanningProblem& problem, const RowMatrixXd& poses,
                                        const Tour& tour) {
    NewIds ids(problem);
    std::vector<io::ContinuousPose> arranged;
    const auto kept = static_cast<Index>(problem.kept.size());
    for (const Visit& visit : tour.visits) {
        io::ContinuousPose pose;
        if (visit.pose < kept) {
            pose = problem.kept[static_cast<std::size_t>(visit.pose)];
        } else {
            pose.id = ids.next();
            pose.joints = poses.row(visit.pose).transpose();
            pose.visible = visible_targets(problem, pose.joints);
        }
        pose.via = visit.via;
        pose.is_blocked = visit.is_blocked;
        arranged.push_back(std::move(pose));
    }
    return arranged;
}

RowMatrixXd all_poses(const PlanningProblem& problem, const RowMatrixXd& planned) {
    const auto kept = static_cast<Index>(problem.kept.size());
    RowMatrixXd poses(kept + planned.rows(), planned.cols());
    for (Index i = 0; i < kept; ++i) {
        poses.row(i) = problem.kept[static_cast<std::size_t>(i)].joints.transpose();
    }
    poses.bottomRows(planned.rows()) = planned;
    return poses;
}

io::PosePlanFile make_file(const PlanningProblem& problem, const PlannedPoses& planned,
                           const PredictedAccuracy& accuracy, const Tour& tour) {
    io::PosePlanFile file;
    file.request = problem.request;
    file.poses = arrange(problem, all_poses(problem, planned.configurations), tour);
    file.value = planned.value;
    file.feasible_count = problem.pool.configurations.rows();
    file.pool_value = planned.pool_choice.value;
    file.pool_bound = planned.pool_choice.bound;
    file.pool_efficiency = planned.pool_choice.efficiency;
    file.searched_bound = planned.searched_bound;
    file.searched_efficiency = planned.efficiency;
    file.starts_at_best = planned.starts_at_best;
    file.is_interrupted = planned.is_interrupted;
    file.predicted_rms = accuracy.rms;
    file.predicted_p95 = accuracy.percentile95;
    file.standard_deviations = standard_deviations(problem.campaign, planned.information);
    file.visiting_time = tour.time;
    return file;
}

std::string default_out(const std::string& campaign) {
    return std::filesystem::path(campaign).stem().string() + ".poses.json";
}

void plan(Arguments arguments) {
    PlanningArguments& asked = arguments.problem;
    asked.request.is_focused_on_robot = arguments.focus == "robot";
    if (asked.request.repaired.empty() && !asked.request.dropped.empty()) {
        throw CLI::ValidationError("--drop", "needs the plan to drop from, --plan");
    }
    if (asked.request.repaired.empty() && asked.pose_count == 0)
        throw CLI::RequiredError("--poses");
    const io::PosePlanRequest& request = asked.request;
    const std::string out = arguments.out.empty() ? default_out(request.campaign) : arguments.out;
    check_outputs({request.campaign, request.augment, request.repaired, request.workspace},
                  {out, arguments.csv});
    const InterruptFlag interrupted;
    const StopSignal stop{interrupted.get(), deadline_after(request.time_limit)};
    PlanningProblem problem = read_planning_problem(asked, stop.with_half_the_time());
    PlannedPoses planned = search(problem, stop, arguments.progress);
    planned.is_interrupted |= problem.pool.candidate_count < request.pool_count;
    const PredictedAccuracy accuracy = predict_accuracy(problem.prediction, planned.information);
    TourOptions tour_options;
    tour_options.order.seed = problem.request.seed;
    const Tour tour =
        plan_tour(problem.constraints, all_poses(problem, planned.configurations), tour_options);
    const io::PosePlanFile file = make_file(problem, planned, accuracy, tour);
    io::write_pose_plan(out, file, problem.campaign);
    if (!arguments.csv.empty()) {
        io::write_configurations_csv(arguments.csv, problem.campaign, file.poses);
    }
    print_pose_plan(problem, file, tour);
    if (file.is_interrupted) {
        print("\nPredicted position error by number of poses: left out, planning was stopped\n");
    } else {
        print_other_counts(problem, accuracy);
    }
    print_deviations(problem.campaign, file.standard_deviations);
    print(fmt::format("\n{}plan:        {}\n",
                      describe_scaling(problem.campaign, problem.request.repeats), out));
    if (file.is_interrupted) {
        std::fputs("posewise: stopped early; the plan is the best so far\n", stderr);
    }
}

// ---- The command line ----

void add_problem(CLI::App& command, PlanningArguments& problem, std::string& focus) {
    io::PosePlanRequest& request = problem.request;
    command.add_option("CAMPAIGN", request.campaign, "Campaign file (YAML): robot, sensor, cell")
        ->required()
        ->check(file_name());
    command
        .add_option("-k,--poses", problem.pose_count,
                    "How many configurations (with --plan: all together; default: as it has)")
        ->check(whole_number(1, 10000));
    command
        .add_option("-c,--criterion", problem.criterion,
                    "o1, o2, o3, o4, o5, a, d, e, g or v; g and v: worst and mean position error "
                    "over the workspace (default: v, with --focus robot d)")
        ->check(criterion_check());
    command
        .add_option("--focus", focus,
                    "all, or robot: base and targets are estimated along, but do not count")
        ->check(CLI::IsMember({"all", "robot"}))
        ->capture_default_str();
    command.add_option("--augment", request.augment, "Poses measured already (CSV or .mat): held")
        ->check(file_name());
    command.add_option("--plan", request.repaired, "Plan to repair: its poses are held")
        ->check(file_name());
    add_ids_option(command, "--drop", request.dropped, "Ids of its poses to replace, by commas");
    add_prior_option(command, problem.prior, "; --poses may then be below what identifies");
    command.add_option("--repeats", request.repeats, "Samples of each configuration")
        ->check(real_number(1, 1e9))
        ->capture_default_str();
}

void add_workspace(CLI::App& command, PlanningArguments& problem) {
    io::PosePlanRequest& request = problem.request;
    CLI::Option* const given =
        command
            .add_option("--workspace", request.workspace,
                        "Configurations (CSV) where the robot shall be accurate (default: drawn)")
            ->check(file_name());
    command
        .add_option("--workspace-poses", request.workspace_count,
                    "How many are drawn for it otherwise")
        ->check(whole_number(1, 20000))
        ->default_val(Index{500})
        ->excludes(given);
    command
        .add_option("--workspace-box-mm", request.workspace_box_mm,
                    "Box of the base frame that targets are in then: least x,y,z,largest x,y,z "
                    "(default: the cell's target boxes)")
        ->delimiter(',')
        ->expected(6)
        ->excludes(given);
    command
        .add_option("--workspace-target", request.workspace_target,
                    "Target whose position counts, from 1 (0: all of them)")
        ->check(whole_number(0, 10000))
        ->capture_default_str();
}

void add_search(CLI::App& command, Arguments& arguments) {
    io::PosePlanRequest& request = arguments.problem.request;
    command.add_option("--pool", request.pool_count, "Candidates to draw")
        ->check(whole_number(1, 10000000))
        ->default_val(Index{20000});
    command.add_option("--starts", request.starts, "Plans that are refined")
        ->check(whole_number(1, 100000))
        ->default_val(Index{16});
    command.add_option("--seed", arguments.problem.seed, "Of all draws (default: the campaign's)")
        ->check(whole_number(0, largest_seed));
    command.add_option("--time", request.time_limit, "Seconds after which to stop")
        ->check(real_number(1e-3, 1e9));
    command
        .add_option("-o,--out", arguments.out,
                    "Plan file (default: <campaign>.poses.json in this folder)")
        ->check(file_name());
    command.add_option("--csv", arguments.csv, "Write the configurations as CSV, too")
        ->check(file_name());
    command.add_flag("--progress", arguments.progress,
                     "Show progress on standard error even if it is no terminal");
}

}  // namespace

void add_plan(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("plan", "Propose configurations to measure, from nothing");
    add_problem(*command, arguments->problem, arguments->focus);
    add_workspace(*command, arguments->problem);
    add_search(*command, *arguments);
    command->footer(footer);
    command->callback([arguments] { plan(*arguments); });
}

}  // namespace posewise::cli
