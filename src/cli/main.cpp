#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "commands.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/version.hpp"

namespace {

constexpr int input_error = 1;
constexpr int usage_error = 2;
constexpr int internal_error = 70;  // EX_SOFTWARE of sysexits.h: a bug of ours

constexpr const char* footer = R"(
Start with:
  posewise inspect campaign.yaml                       what can be identified at all
  posewise study campaign.yaml -m measurements.csv     how many poses are enough
  posewise select campaign.yaml -m measurements.csv -k 12    which ones
  posewise plan campaign.yaml --poses 24               which to measure, from nothing
  posewise verify measurements.plan.json                     whether a plan is as good as it says
  posewise calibrate campaign.yaml -m measurements.csv       what came out, how sure

posewise COMMAND --help explains each with an example.
Exit code: 0 good, 1 unusable input (one line on standard error), 2 wrong usage.)";

/// A message is one line, whatever it quotes.
int fail(std::string message, int code) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    std::fprintf(stderr, "posewise: %s\n", message.c_str());
    return code;
}

void add_commands(CLI::App& program) {
    using namespace posewise::cli;
    program.require_subcommand(1);
    program.set_version_flag("--version", std::string("posewise ") + posewise::version);
    program.footer(footer);
    for (const auto add : {add_inspect, add_indices, add_select, add_plan, add_verify,
                           add_calibrate, add_study, add_simulate}) {
        add(program);
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App program{"Which poses to measure, how many, and what a calibration achieved.",
                     "posewise"};
    try {
        add_commands(program);
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return program.exit(error) == 0 ? 0 : usage_error;
    } catch (const posewise::InputError& error) {
        return fail(error.what(), input_error);
    } catch (const std::exception& error) {
        return fail(std::string("internal error: ") + error.what(), internal_error);
    }
    if (std::fflush(stdout) != 0) return fail("standard output cannot be written", input_error);
    return 0;
}
