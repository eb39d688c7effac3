#include <charconv>

#include "core/text.hpp"
#include "options.hpp"
#include "study_options.hpp"

namespace posewise::cli {
namespace {

/// "2%" or "0.02".
double parse_part(const std::string& text) {
    const bool is_percent = text.ends_with('%');
    const char* const end = text.data() + text.size() - (is_percent ? 1 : 0);
    double part = 0;
    const auto [after, error] = std::from_chars(text.data(), end, part);
    if (is_percent) part /= 100;
    if (error != std::errc() || after != end || !(part > 0 && part < 1)) {
        throw CLI::ValidationError(
            "--precision", "is " + detail::quote(text) + "; must be a part such as 2% or 0.02");
    }
    return part;
}

Index parse_count(const char* begin, const char* end) {
    Index count = 0;
    const auto [after, error] = std::from_chars(begin, end, count);
    return error == std::errc() && after == end ? count : 0;
}

/// "3/16".
Shard parse_shard(const std::string& text) {
    const auto slash = std::min(text.find('/'), text.size() - 1);
    const char* const begin = text.data();
    const Shard shard{parse_count(begin, begin + slash),
                      parse_count(begin + slash + 1, begin + text.size())};
    if (shard.number < 1 || shard.number > shard.count) {
        throw CLI::ValidationError(
            "--shard", "is " + detail::quote(text) +
                           "; must be a number and how many there are, from 1/16 to 16/16");
    }
    return shard;
}

}  // namespace

void add_simulation_options(CLI::App& command, StudyArguments& arguments) {
    SimulatedStudyOptions& options = arguments.options;
    CLI::Option* const simulate =
        command.add_flag("--simulate", arguments.is_simulated,
                         "Of robots that are drawn, not of measured configurations");
    const auto only_simulated = [simulate](CLI::Option* option) {
        return option->needs(simulate)->group("Simulation");
    };
    simulate->group("Simulation");
    only_simulated(command.add_option("--trials", arguments.trials,
                                      "Robots drawn; with --precision at most (default: 100, with "
                                      "--precision 100000)"))
        ->check(whole_number(1, 1000000000));
    only_simulated(command.add_option_function<std::string>(
        "--precision",
        [&options](const std::string& text) { options.precision = parse_part(text); },
        "Draw robots until the 95 % interval of planned against random is as narrow as this part "
        "of the ratio on either side, 2%, for each pose count and criterion"));
    only_simulated(command.add_option("--truth", arguments.truth,
                                      "Campaign file of the robots drawn, with errors that the "
                                      "fitted model lacks (default: the campaign fitted)"))
        ->check(file_name())
        ->excludes("--from");
    only_simulated(
        command.add_option("--vary", arguments.varied,
                           "A key of the campaign file and values that it takes in turn, "
                           "sensor.sigma_mm=0.01,0.05; several: every combination; or a range, "
                           "sensor.sigma_mm=0.01..0.1, with --points"))
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    only_simulated(command.add_option("--points", arguments.points,
                                      "Low-discrepancy points that fill all ranges of --vary "
                                      "together; more begin with the same ones"))
        ->check(whole_number(1, 10000));
    only_simulated(
        command.add_option("--pool", options.pool_count, "Configurations drawn to choose from"))
        ->check(whole_number(1, 1000000))
        ->capture_default_str();
    only_simulated(command.add_option("--test-poses", options.test_count,
                                      "Configurations of the workspace that robots are judged at"))
        ->check(whole_number(1, 100000))
        ->capture_default_str();
    only_simulated(
        command.add_option("--repeats", options.repeats, "Samples of each configuration"))
        ->check(whole_number(1, 100000))
        ->capture_default_str();
    only_simulated(command.add_flag("--refine", options.is_refined,
                                    "Plan as plan does, not only choose from the pool"));
}

void add_store_options(CLI::App& command, StudyArguments& arguments) {
    CLI::Option* const store =
        command
            .add_option("--store", arguments.store,
                        "SQLite file that keeps what is finished: it never runs again")
            ->check(file_name())
            ->group("Store");
    command
        .add_option_function<std::string>(
            "--shard",
            [&arguments](const std::string& text) { arguments.options.shard = parse_shard(text); },
            "Run one part of the trials only, 3/16: each part with a store of its own, on any "
            "machine; then --merge")
        ->needs(store)
        ->group("Store");
    command
        .add_option("--merge", arguments.merged,
                    "Stores whose trials are put into that of --store; prints what there is then")
        ->needs(store)
        ->group("Store");
}

}  // namespace posewise::cli
