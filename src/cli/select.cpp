#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/report/units.hpp"
#include "posewise/selection/exchange.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise select campaign.yaml -m measurements.csv -k 12 --criterion d

Chooses the configurations of the file that tell most about the parameters, by a greedy start and
exchanges from many random starts, and writes them as a plan file (JSON) that calibrate --plan
takes. Prints the chosen ids, the criterion's value, and what is proven about it:
  bound       no choice of as many configurations has a larger value
  efficiency  part of the best possible information per measurement that is surely reached
  starts      how many of the starts ended at this same value; many of them: hard to beat
The same seed gives the same plan, on any number of threads.)";

struct Arguments {
    InputPaths paths;
    std::string criterion;
    std::optional<std::uint64_t> seed;
    std::optional<double> repeats;
    std::string out;
    SelectOptions options;
};

void print_plan(const Plan& plan, const Measurements& candidates) {
    std::string ids;
    for (const Index pose : plan.poses) {
        ids += (ids.empty() ? "" : " ") + candidates.ids[static_cast<std::size_t>(pose)];
    }
    print(
        fmt::format("chosen:     {}\ncriterion:  {}\nvalue:      {}\nbound:      {}\n"
                    "efficiency: {} proven\nstarts:     {} of {} ended here, {}\n",
                    ids, criterion_name(plan.criterion), format_short(plan.value, 8),
                    format_short(plan.bound, 8), format_fixed(plan.efficiency, 4),
                    plan.starts_at_best, plan.starts, stop_reason_name(plan.stop_reason)));
}

void select(const Arguments& arguments) {
    const auto file = io::read_campaign(arguments.paths.campaign);
    const auto candidates = io::read_measurements(arguments.paths.measurements, file);
    SelectOptions options = arguments.options;
    options.criterion =
        arguments.criterion.empty() ? file.criterion : parse_criterion(arguments.criterion);
    options.seed = arguments.seed.value_or(file.seed);
    const double repeats = arguments.repeats.value_or(mean_repeats(candidates));
    const Blocks blocks =
        make_blocks(file.campaign, register_base_and_targets(file.campaign, candidates),
                    candidates.configurations, repeats);
    const Plan plan = select_poses(blocks, options);
    const std::string out =
        arguments.out.empty()
            ? std::filesystem::path(arguments.paths.measurements).stem().string() + ".plan.json"
            : arguments.out;
    io::write_plan(out, plan, file.campaign, candidates, arguments.paths.measurements);
    print_plan(plan, candidates);
    print(describe_scaling(file.campaign, repeats) + "plan:       " + out + '\n');
}

void add_options(CLI::App& command, Arguments& arguments) {
    command.add_option("-k,--poses", arguments.options.pose_count, "How many to choose")
        ->required()
        ->check(CLI::Range(Index{1}, Index{1000000}));
    command
        .add_option("-c,--criterion", arguments.criterion,
                    "o1, o2, o3, o4, o5, a, d, e, g or v (default: the campaign's)")
        ->check(criterion_check());
    command.add_option("--starts", arguments.options.starts, "Starts of the exchange")
        ->check(CLI::Range(Index{1}, Index{1000000}))
        ->capture_default_str();
    command.add_option("--seed", arguments.seed, "Of the random starts (default: the campaign's)")
        ->check(CLI::NonNegativeNumber);
    command
        .add_option("--repeats", arguments.repeats,
                    "Samples of each chosen configuration (default: as in the file)")
        ->check(CLI::Range(1.0, 1e9));
    command.add_option("-o,--out", arguments.out,
                       "Plan file (default: <measurements>.plan.json in this folder)");
}

}  // namespace

void add_select(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("select", "Choose the most informative configurations");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_options(*command, *arguments);
    command->footer(footer);
    command->callback([arguments] { select(*arguments); });
}

}  // namespace posewise::cli
