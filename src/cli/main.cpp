#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include "commands.hpp"
#include "core/text.hpp"
#include "crew.hpp"
#include "estimates.hpp"
#include "flags.hpp"
#include "help.hpp"
#include "page.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/core/version.hpp"
#include "threads.hpp"

#ifdef __GLIBC__  // only after another header
#include <malloc.h>
#endif

namespace {

using posewise::cli::ProgramEnd;

constexpr int input_error = 1;
constexpr int usage_error = 2;
constexpr int no_calibration = 3;
constexpr int internal_error = 70;  // EX_SOFTWARE of sysexits.h: a bug of ours

constexpr const char* program_footer = R"(
Start with:
  posewise inspect campaign.yaml                       what can be identified at all
  posewise study campaign.yaml -m measurements.csv     how many poses are enough
  posewise select campaign.yaml -m measurements.csv -k 12    which ones
  posewise plan campaign.yaml --poses 24               which to measure, from nothing
  posewise verify measurements.plan.json                     whether a plan is as good as it says
  posewise calibrate campaign.yaml -m measurements.csv       what came out, how sure
  posewise program measurements.plan.json --for fanuc -o CELL.LS    a program for the robot
  posewise export campaign.yaml estimate.json --urdf out.urdf    the calibrated robot
  posewise correct campaign.yaml estimate.json --poses p.csv     joint values that hit the poses
  posewise report plan.json estimate.json --out page.html        a page to look at

posewise COMMAND --help lists its options, posewise help COMMAND explains all. With --json each
prints one JSON document, which posewise help json explains, and nothing else.
Exit code: 0 good, 1 unusable input (the last line on standard error), 2 wrong usage,
3 a calibration that must not be used, 70 internal error, a bug of posewise.)";

/// The end of good work, if all of its output went out.
ProgramEnd finish() {
    if (!std::cout.flush() || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
        return {input_error, "standard output cannot be written; must be writable"};
    }
    return {};
}

/// What is wrong, where an option is given again in words of ours.
std::string describe(const CLI::ParseError& error) {
    const std::string problem = error.what();
    const std::size_t end = problem.find(": At Most 1 required but received");
    return end == std::string::npos ? problem
                                    : problem.substr(0, end) + ": is given twice; keep one";
}

ProgramEnd fail_usage(const CLI::App& program, const std::string& problem) {
    const auto chosen = program.get_subcommands();
    const std::string command = chosen.empty() ? "" : ' ' + chosen.front()->get_name();
    return {usage_error, problem + "; see posewise" + command + " --help"};
}

/// What is wrong with the first argument if it should be a command and is none; else empty.
std::string find_unknown_command(const CLI::App& program, int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') return "";
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands(nullptr)) {
        names.push_back(command->get_name());
    }
    const std::string first = argv[1];
    if (std::find(names.begin(), names.end(), first) != names.end()) return "";
    return posewise::detail::quote(first) + " is no command; " +
           posewise::detail::suggest(first, names);
}

/// Freed memory stays with the program: matrices come and go by the thousand, and pages from the
/// system cost more than what is written to them.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int mebibyte = 1 << 20;
    mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);  // the most there is
    mallopt(M_TRIM_THRESHOLD, 256 * mebibyte);
#endif
}

/// The first thread's stack has its size from the start. It would grow as it is used, and where
/// memory is limited (`ulimit -v`) and other threads have taken the rest, that ends by a signal.
[[gnu::noinline]] void grow_stack() {
    constexpr std::size_t mebibyte = 1 << 20;
    [[maybe_unused]] volatile char stack[mebibyte];
    stack[0] = 0;  // its far end: one page is written, all between belongs to the stack then
}

void add_commands(CLI::App& program, posewise::cli::CommonOptions& common) {
    using namespace posewise::cli;
    program.require_subcommand(1);
    program.set_version_flag("--version", std::string("posewise ") + posewise::version);
    program.footer(program_footer);
    program.formatter(make_brief_help());
    for (const auto add :
         {add_inspect, add_indices, add_select, add_plan, add_verify, add_calibrate, add_export,
          add_correct, add_program, add_study, add_simulate, add_report}) {
        add(program, common);
    }
    for (CLI::App* command : program.get_subcommands(nullptr)) add_common_options(*command, common);
    add_help_commands(program);
    program.parse_complete_callback(warn_of_many_threads);
}

ProgramEnd run(int argc, char** argv) {
    CLI::App program{"Which poses to measure, how many, and what a calibration achieved.",
                     "posewise"};
    posewise::cli::CommonOptions common;
    common.command_line = posewise::cli::join_command_line(argc, argv);
    try {
        add_commands(program, common);
        const std::string unknown = find_unknown_command(program, argc, argv);
        if (!unknown.empty()) return fail_usage(program, unknown);
        program.parse(argc, argv);
    } catch (const CLI::Success& request) {  // --help or --version
        program.exit(request);
    } catch (const CLI::ParseError& error) {
        return fail_usage(program, describe(error));
    } catch (const posewise::InputError& error) {
        return {input_error, posewise::cli::with_flags(error.what())};
    } catch (const posewise::cli::NoCalibration& error) {
        return {no_calibration, posewise::cli::with_flags(error.what())};
    } catch (const std::bad_alloc&) {
        return {input_error,
                "out of memory; take fewer candidates (--random, --pool) or --threads 1"};
    } catch (const std::exception& error) {
        return {internal_error, std::string("internal error: ") + error.what()};
    }
    return finish();
}

}  // namespace

int main(int argc, char** argv) {
    posewise::cli::wait_passively(argv);
    grow_stack();
    keep_freed_memory();
    posewise::fix_cache_sizes();
    std::signal(SIGXFSZ, SIG_IGN);  // a file beyond `ulimit -f` is an error like a full disk
    return posewise::cli::run_in_crew(argc, argv, [&] { return run(argc, argv); });
}
