#include <fmt/format.h>

#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/measurement/measurements.hpp"
#include "report/calibration_tables.hpp"

namespace posewise::cli {
namespace {

constexpr const char* simulate_footer = R"(
Example:
  posewise simulate campaign.yaml --truth 7 --poses 24 --repeats 10 --out simulated.csv
  posewise simulate campaign.yaml --configurations poses.csv --out simulated.csv

Draws a robot with errors of the campaign's spread (by the seed --truth), sends it to random
configurations that the joint limits and the campaign's cell allow, or to those of a file (a warning
says which of them the cell does not allow), and measures with the sensor's noise, and with the model
error and repeatability that the campaign expects.
In the column visible_targets that file may list which targets each configuration shows ("1 3"), as
plan --csv writes it; the cells of the others stay empty. With sockets it has a column socket, and
joints are those with which the ball sits in it. Joints are those that the campaign says its
measurements have, the model's or the controller's. The file written starts with comment lines
that hold the command, so it can be made again. Prints the true parameters as
calibrate prints those it finds:
  parameter    value
  Tx1        -0.8412  mm)";

struct SimulateArguments {
    InputPaths paths;
    std::string configurations;
    std::optional<std::uint64_t> seed;
    std::string out;
    SimulateOptions options;
};

std::vector<std::string> make_comments(const SimulateArguments& arguments,
                                       const Campaign& campaign) {
    const SimulateOptions& options = arguments.options;
    return {fmt::format("{}: simulated, not measured, by posewise {}", campaign.name, version),
            fmt::format("posewise simulate {} --truth {} --seed {} {} --repeats {}",
                        arguments.paths.campaign, options.truth_seed, options.seed,
                        arguments.configurations.empty()
                            ? fmt::format("--poses {}", options.pose_count)
                            : "--configurations " + arguments.configurations,
                        options.repeats)};
}

/// At random configurations, or at those of a file.
Simulation simulate_as_asked(const SimulateArguments& arguments, const io::CampaignFile& file) {
    if (arguments.configurations.empty()) return simulate(file, arguments.options);
    const auto asked = io::read_configurations(arguments.configurations, file);
    warn_of_violations(arguments.configurations, file, asked);
    Simulation simulation = simulate(file, asked.joints, asked.is_seen, arguments.options);
    simulation.measurements.ids = asked.ids;
    return simulation;
}

void run_simulation(SimulateArguments arguments, const CommonOptions& common) {
    const auto file = io::read_campaign(arguments.paths.campaign);
    check_outputs({&file}, {arguments.configurations}, {arguments.out}, common);
    arguments.options.seed = arguments.seed.value_or(file.seed);
    const Simulation simulation = simulate_as_asked(arguments, file);
    warn_of_unchecked_bodies(file);
    io::write_measurements(arguments.out, file, simulation.measurements,
                           make_comments(arguments, file));
    if (common.json) return print_document(io::to_json(simulation, file));
    print(fmt::format(
        "{}, {}: {}\n",
        detail::count_of(simulation.measurements.configuration_count(), "configuration"),
        detail::count_of(simulation.measurements.observations.rows(), "sample"), arguments.out));
    print_section(fmt::format("True parameters (errors of the robot, base, {})",
                              file.sensor->words().unknowns),
                  detail::value_table(file, simulation.truth));
}

void add_simulate_options(CLI::App& command, SimulateArguments& arguments) {
    const auto count = whole_number(1, 100000);
    command.add_option("--truth", arguments.options.truth_seed, "Seed of the true parameters")
        ->check(whole_number(0, largest_seed))
        ->capture_default_str();
    command
        .add_option("--seed", arguments.seed,
                    "Seed of configurations and noise (default: the campaign's)")
        ->check(whole_number(0, largest_seed));
    CLI::Option_group& group = *command.add_option_group("Configurations", "one of these");
    group.add_option("-k,--poses", arguments.options.pose_count, "As many, drawn at random")
        ->check(count);
    group
        .add_option("--configurations", arguments.configurations,
                    "File of configurations (CSV), as plan --csv writes it")
        ->check(file_name());
    group.require_option(1);
    command.add_option("--repeats", arguments.options.repeats, "Samples of each configuration")
        ->check(count)
        ->capture_default_str();
    command.add_option("-o,--out", arguments.out, "Measurement file to write (CSV)")
        ->required()
        ->check(file_name());
}

}  // namespace

void add_simulate(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<SimulateArguments>();
    CLI::App* command = program.add_subcommand("simulate", "Make a synthetic measurement file");
    add_campaign_argument(*command, arguments->paths);
    add_simulate_options(*command, *arguments);
    command->footer(simulate_footer);
    command->callback([arguments, &common] { run_simulation(*arguments, common); });
}

}  // namespace posewise::cli
