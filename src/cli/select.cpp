#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "blocks_options.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "measured.hpp"
#include "plan_inputs.hpp"
#include "plan_report.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/report/reports.hpp"
#include "select_options.hpp"

namespace posewise::cli {
namespace {

constexpr const char* select_footer = R"(
Example:
  posewise select campaign.yaml -m measurements.csv -k 12 -c d --proof 60 --report plan.html
  posewise select campaign.yaml --random 2000 -k 20 --prior --least-distance-deg 10
  posewise select campaign.yaml --candidates pool.csv -k 6 --augment measured.csv
  posewise select --blocks jacobians.csv --rows 9 -k 40 --criterion a
  posewise select --blocks jacobians.npy -k 40
  posewise select campaign.yaml -m points.txt --plan plan.json -k 12
  posewise select campaign.yaml --random 2000 -k 20 --relax --out weights.csv

Chooses the candidates that tell most about the parameters, writes them as a plan file (JSON) for
calibrate --plan and verify, prints the chosen ids, the criterion's value and what is proven:
  bound       no choice of as many candidates has a larger value
  efficiency  part of the best possible information per measurement that is surely reached
  starts      how many of the starts ended at this same value; ten that agree end the search,
              the ends of fewer are combined, too
  proof       optimal: branch and bound ruled out or tried all other choices; else what it tried

Measurements register the base and the targets; other candidates need them in the campaign file (or
measured poses, --augment), or from an earlier estimate, --from, which tells the robot's errors, too. A candidate file has the columns config,q1_deg,... and perhaps
visible_targets (as plan --csv writes it), or is a measurement file; --random draws a scrambled Halton
sequence of what the joint limits and the campaign's cell allow; listed candidates that the cell does
not allow are not chosen, a warning names them. A file of blocks has a row of numbers a line (or is a
matrix of MATLAB or NumPy), each --rows of them one candidate, named 0, 1, ...; an array of NumPy with
three dimensions, candidates x rows x parameters, says so itself. One of --groups: columns
config,group.

--relax chooses nothing: it weights the candidates (an approximate design), 0 to --repeat-limit each and
-k in sum, by what an experiment that could be split at will would take of each, and proves the bound.

Ctrl-C, SIGTERM or --time end the search with the best plan so far, written with its bound; exit
code 0. Before there is one, while it looks for what is identifiable, they end it with an error.
The same seed gives the same plan, on any number of threads, unless time ended it.)";

CandidateKind kind_of(const SelectArguments& arguments) {
    if (arguments.random > 0) return CandidateKind::Random;
    if (!arguments.candidates.empty()) return CandidateKind::Configurations;
    return arguments.blocks.empty() ? CandidateKind::Measurements : CandidateKind::Blocks;
}

PlanRequest request_of(const SelectArguments& arguments) {
    PlanRequest request = make_request(arguments);
    request.sources.candidates = arguments.measurements + arguments.candidates + arguments.blocks;
    request.least_distance = to_radians(arguments.least_distance_deg);
    return request;
}

std::string default_select_out(const PlanSources& sources) {
    const std::string& path = sources.candidates.empty() ? sources.campaign : sources.candidates;
    return std::filesystem::path(path).stem().string() + ".plan.json";
}

/// Noise and scales, an earlier estimate; nothing of plain blocks.
std::string describe_robot(const ChoiceInputs& inputs, const PlanRequest& request) {
    if (!inputs.campaign) return "";
    return describe_planned(*inputs.campaign, request.repeats) + describe_earlier(request);
}

/// On standard error.
void note_interrupt(Ending ending, const char* what) {
    if (ending != Ending::Interrupted) return;
    print_warning(fmt::format("interrupted; the {} the best so far", what));
}

void warn_of_few(Index count, Index asked) {
    if (count >= asked) return;
    print_warning(fmt::format(
        "only {} of the {} random candidates were drawn in the time there was", count, asked));
}

void print_design(const ApproximateDesign& design, const SelectArguments& arguments,
                  const ChoiceInputs& inputs, const CommonOptions& common) {
    note_interrupt(design.ending, "weights are");
    if (common.json) return print_document(io::to_json(design));
    print(format(design, arguments.digits) + '\n' + describe_robot(inputs, design.request));
}

/// A copy where a page needs them again; random ones, which may be many, it draws.
Candidates candidates_to_spend(ChoiceInputs& inputs, const SelectArguments& arguments) {
    const bool are_needed = !arguments.page.empty() && arguments.random == 0;
    return are_needed ? inputs.candidates : std::move(inputs.candidates);
}

/// On the page, too, if there is a path for one.
void print_plan(const Plan& plan, const SelectArguments& arguments, ChoiceInputs& inputs,
                const std::string& out, const CommonOptions& common) {
    const Printed printed{answer(plan),
                          format_choice(plan, arguments.digits) +
                              describe_robot(inputs, plan.request) +
                              "plan:       " + detail::escape_controls(out) + '\n',
                          [&] { return io::to_json(plan, out); }};
    io::PagePart part;
    if (!arguments.page.empty()) {
        static_cast<PlanRequest&>(inputs.options) = plan.request;
        part = show_choice(plan, inputs);
    }
    note_interrupt(plan.ending, "plan is");
    print(printed, common);
    write_page(arguments.page, std::move(part), printed, common);
}

void select(const SelectArguments& arguments, const CommonOptions& common) {
    check_select_usage(arguments);
    std::optional<InterruptFlag> interrupted(std::in_place);
    const StopSignal stop{interrupted->get(), deadline_after(arguments.request.time_limit)};
    std::optional<io::CampaignFile> file;
    if (!arguments.request.sources.campaign.empty()) file = read_planned(arguments, stop);
    const PlanRequest request = request_of(arguments);
    const PlanSources& sources = request.sources;
    const bool has_default = arguments.out.empty() && !arguments.relaxes;
    const std::string out = has_default ? default_select_out(sources) : arguments.out;
    check_outputs({file ? &*file : nullptr},
                  {sources.estimate, sources.candidates, sources.augment, sources.measured_plan,
                   sources.test_poses, sources.groups},
                  {out, arguments.page}, common);
    ChoiceInputs inputs =
        read_choice_inputs(request, kind_of(arguments), arguments.random, std::move(file));
    if (!inputs.campaign) print_size(inputs.blocks, common);
    inputs.options.stop = stop;
    inputs.options.judge = judge_of(sources.candidates, arguments.earlier.is_forced);
    const auto read = std::chrono::steady_clock::now();
    if (arguments.relaxes) {
        const ApproximateDesign design =
            inputs.campaign
                ? relax_choice(*inputs.campaign, std::move(inputs.candidates), inputs.options)
                : relax_choice(std::move(inputs.blocks), inputs.options);
        note_overtime(request.time_limit, stop, read, "weight the candidates");
        warn_of_few(design.candidate_count, arguments.random);
        if (!out.empty()) io::write_weights(out, design, given_warnings());
        interrupted.reset();
        return print_design(design, arguments, inputs, common);
    }
    ProgressLine line("selecting", arguments.progress);
    inputs.options.progress = [&](const Progress& state) { line(state); };
    const Plan plan =
        inputs.campaign
            ? choose(*inputs.campaign, candidates_to_spend(inputs, arguments), inputs.options)
            : choose(std::move(inputs.blocks), inputs.options);
    note_overtime(request.time_limit, stop, read, "choose");
    warn_of_few(plan.candidate_count, arguments.random);
    std::ranges::for_each(plan.cell_doubts, print_warning);
    io::write_plan(out, plan, given_warnings());
    interrupted.reset();
    print_plan(plan, arguments, inputs, out, common);
}

}  // namespace

void add_select(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<SelectArguments>();
    CLI::App* command = program.add_subcommand(
        "select", "Choose the most informative configurations, with a proven bound");
    add_select_options(*command, *arguments);
    command->footer(select_footer);
    command->callback([arguments, &common] { select(*arguments, common); });
}

}  // namespace posewise::cli
