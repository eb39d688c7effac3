#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "blocks_options.hpp"
#include "commands.hpp"
#include "core/text.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "io/format/atomic_file.hpp"
#include "plot.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"
#include "report/plot.hpp"
#include "study_blocks.hpp"
#include "study_options.hpp"
#include "study_runs.hpp"

namespace posewise::cli {
namespace {

constexpr const char* study_footer = R"(
Example:
  posewise study campaign.yaml -m measurements.csv --criteria v,d --random 100 --report study.html
  posewise study campaign.yaml --simulate --poses 8,12,20 --trials 1000 --store results.sqlite
  posewise study --from results.sqlite

For each pose count: chooses that many of the measured configurations by each criterion and at
random, calibrates with them from nothing, and judges on configurations held out, the same ones for
all, over ten random splits. Prints the distance RMS there, in mm:
  poses    v/mm  expected  v/random  95 %        random 10 %/mm  50 %/mm  90 %/mm  subsets  unidentified
      8  0.2773    0.2065      0.57  0.43..0.78          0.2431   0.4535   1.2347      100             0
is read: eight configurations chosen by V leave 0.28 mm, median of the splits, where the calibrations
themselves expect 0.21; half of all random eights leave more than 0.45. Planned against random it is
0.57, geometric mean over the splits with its 95 % interval: better where all of it is below 1, loses
where all is above 1, within chance else. Subsets that do not identify the model count as the worst
("-": no number); splits of which half the random ones do not are left out of the ratio. The pose count from which a column stays flat is enough.

--from studies the robot as an earlier calibration found it; with --as-prior each subset is calibrated
with what that knew, with --only base,targets only these are found.

With few configurations there are no splits (--splits 0): each subset is judged on what it leaves,
and one that takes the telling configurations is judged on easier ones than others are.

  posewise study campaign.yaml -m measurements.csv --models geometric,full
repeats the study with each of these in the place of the campaign's robot.errors, all else the same:
the splits, the pose counts and the random subsets. A line for each pose count and model says what
random and planned subsets leave, planned against random of that model, and of the first one.

--simulate needs no measurements: it draws robots with errors as large as the campaign expects, and a
model error (as surely as that is known), measures each at the configurations chosen for the nominal
robot and at random ones that its cell allows, calibrates, and judges how far targets are then from
where the calibrated model has them, over configurations of the workspace, model error included. The
columns are the same, one split a robot. With --from the robots are such as the one calibrated, with
--as-prior they are that one, as surely as it is known. --truth draws from another campaign, with
errors that the fitted model lacks; --vary repeats the study with other values of keys of the campaign,
on the same robots draw by draw. Where the model is varied, too, robots have the errors of each model, so
that to compare models --truth must say what robots are like (here truth.yaml: errors: full):
  posewise study campaign.yaml --simulate --vary sensor.sigma_mm=0.01,0.05
  posewise study campaign.yaml --simulate --vary robot.errors=geometric,full --truth truth.yaml

--blocks needs no robot: it takes plain blocks, as select --blocks does, and shows what each number of
poses can tell: the best choice by each criterion with its proven bound, random subsets (5, 50 and
95 % of them), and subsets of your own, each against the bound for its number:
  posewise study --blocks jacobians.npy --poses 7..40 --criteria d,a --subset mine.txt --plot sweep.svg

Ctrl-C, SIGTERM or --time end it with the splits (robots) that are finished; a column says how many
splits a pose count has, where not all are.

--store keeps each trial as it ends: a study that was stopped, or killed, goes on where it was, and
--from prints what is in a store at any moment, also while it runs. --shard runs a part, each with a
store of its own on any machine, --merge puts stores together:
  posewise study --merge part1.sqlite part2.sqlite --store all.sqlite
Under mpirun or srun trials are shared out to all processes (designs/cluster). The numbers are the
same for any threads, processes, shards and order, and however often it was killed.)";

void print_studies(const std::vector<Study>& studies, const StudyArguments& arguments,
                   const CommonOptions& common, StudyExtras extras) {
    const Printed printed{answer(studies), describe_studies(studies) + extras.notes,
                          [&] { return io::to_json(studies); }};
    print(printed, common);
    if (!arguments.csv.empty()) {
        detail::write_files({{arguments.csv, "", {}, [&](const WriteText& write) {
                                  const bool compares =
                                      studies.size() > 1 || !studies.front().model.empty();
                                  if (compares) return write_study_csv(studies, write);
                                  write_study_csv(studies.front(), write);
                              }}});
    }
    extras.page.title = studies.front().campaign;
    write_page(arguments.page, std::move(extras.page), printed, common);
    if (arguments.plot.empty()) return;
    draw_plot(arguments.plot,
              [&](const std::string& image) { return detail::study_plot_script(studies, image); });
}

/// A table for those studies of a store that belong together each.
void print_store(const std::string& path, const StudyArguments& arguments,
                 const CommonOptions& common) {
    check_study_outputs(arguments, {}, {path}, common);
    const std::vector<std::vector<Study>> groups = read_store_groups(path);
    const bool makes_one =
        common.json || !(arguments.csv + arguments.plot + arguments.page).empty();
    if (groups.size() > 1 && makes_one) {
        throw input_error_at(
            {path}, fmt::format("holds {} studies of which no single table can be made; --json, "
                                "--csv, --plot and --report must be of one",
                                groups.size()));
    }
    for (const std::vector<Study>& one : groups) {
        if (groups.size() > 1) {
            print((&one == &groups.front() ? "" : "\n") +
                  detail::escape_controls(one.front().campaign) + '\n');
        }
        print_studies(one, arguments, common, {});
    }
}

/// A store says all that the trials in it depend on: beside these options others have no effect.
void check_printing_only(const CLI::App& command, std::vector<std::string> used, const char* what) {
    used.insert(used.end(), {"--csv", "--plot", "--report", "--json", "--help"});
    check_only(command, used,
               fmt::format("is not looked at where {}; leave it out, or run the study with --store",
                           what));
}

void check_study_usage(const CLI::App& command, const StudyArguments& arguments, bool reads_store) {
    if (arguments.earlier.is_forced && command.count("--from") == 0 && arguments.is_simulated) {
        throw CLI::ValidationError("--force",
                                   "is of an estimate or of measurements; needs --from or -m");
    }
    const bool has_splits = arguments.options.splits != Index{0};
    if (!has_splits && command.count("--holdout") > 0) {
        throw CLI::ValidationError("--holdout", "is of splits, and --splits 0 makes none");
    }
    for (const char* option :
         {"--exclude", "--splits", "--holdout", "--models", "--plan", "--points-unit"}) {
        if (!arguments.is_simulated || command.count(option) == 0) continue;
        throw CLI::ValidationError(option,
                                   "is of measured configurations; leave it out, or --simulate");
    }
    if (reads_store) {
        return check_printing_only(command, {"--from"}, "--from prints what a store holds");
    }
    if (!arguments.merged.empty()) {
        return check_printing_only(command, {"--merge", "--store"}, "--merge puts stores together");
    }
    const std::string& from = arguments.earlier.from;
    if (arguments.paths.campaign.empty() && !from.empty()) {
        std::error_code ignored;
        throw input_error_at({from}, std::filesystem::exists(from, ignored)
                                         ? "is no store of trials, or damaged from its beginning; "
                                           "must be one, or an estimate and then a campaign, too"
                                         : "is not there; must be a store of trials");
    }
    if (arguments.paths.campaign.empty()) throw CLI::RequiredError("CAMPAIGN");
    const bool is_measured = !arguments.paths.measurements.empty();
    if (arguments.is_simulated == is_measured) {
        throw CLI::ValidationError(
            "study", is_measured ? "has measured configurations (-m) and --simulate; leave one out"
                                 : "needs measured configurations (-m), --simulate or --blocks");
    }
}

void warn_of_precision(const std::vector<Study>& studies) {
    for (const Study& study : studies) {
        if (study.ending != Ending::IterationLimit) continue;
        const std::string of = study.model.empty() ? "" : " of " + study.model;
        print_warning(fmt::format(
            "the results{} are not as precise as asked (--precision) after {} robots; more may be "
            "allowed (--trials)",
            of, study.splits));
    }
}

void study(const CLI::App& command, const StudyArguments& arguments, const CommonOptions& common) {
    if (!arguments.plain.blocks.empty()) return study_blocks(command, arguments, common);
    check_blocks_usage("", arguments.plain.sources);
    const bool reads_store = io::is_trial_store(arguments.earlier.from);
    check_study_usage(command, arguments, reads_store);
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    if (reads_store) return print_store(arguments.earlier.from, arguments, common);
    if (!arguments.merged.empty()) {
        check_study_outputs(arguments, {}, arguments.merged, common);
        io::merge_trial_stores(arguments.merged, arguments.store);
        return print_store(arguments.store, arguments, common);
    }
    std::optional<InterruptFlag> interrupted(std::in_place);
    const StopSignal stop{interrupted->get(), deadline_after(arguments.time_limit)};
    StudyExtras extras;
    const std::vector<Study> studies = arguments.is_simulated
                                           ? study_simulated(arguments, common, stop, extras)
                                           : study_measured(arguments, common, stop, extras);
    interrupted.reset();
    const std::string early = describe_early_end(studies.front());
    if (studies.front().rows.empty()) {
        // What this shard was to do is done, and kept.
        std::fputs(
            "posewise: no split is finished by this shard; when the others have run, their stores "
            "must be merged (--merge)\n",
            stderr);
        return;
    }
    if (!early.empty()) print_warning(early);
    if (const std::string few = describe_few_judged(studies.front()); !few.empty()) {
        print_warning(few);
    }
    warn_of_precision(studies);
    print_studies(studies, arguments, common, std::move(extras));
}

}  // namespace

void add_study(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<StudyArguments>();
    CLI::App* command =
        program.add_subcommand("study", "Accuracy against number of poses, optimal and random");
    add_campaign_argument(*command, arguments->paths)->required(false);
    add_measurements_option(*command, arguments->paths)->required(false);
    add_study_options(*command, *arguments);
    add_simulation_options(*command, *arguments);
    add_blocks_study_options(*command, *arguments);
    add_store_options(*command, *arguments);
    command->footer(study_footer);
    command->callback([command, arguments, &common] { study(*command, *arguments, common); });
}

}  // namespace posewise::cli
