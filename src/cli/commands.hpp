#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// The subcommands, one file each. Every function adds its command to the program; the work is done
/// in the command's callback, once the whole command line is known to be right.
namespace posewise::cli {

/// What every command takes beside its own options.
struct CommonOptions {
    bool json = false;         ///< print the result as a JSON document instead of text
    std::string command_line;  ///< as it was typed
};
void add_common_options(CLI::App& command, CommonOptions& common);

void add_inspect(CLI::App& program, const CommonOptions& common);
void add_indices(CLI::App& program, const CommonOptions& common);
void add_select(CLI::App& program, const CommonOptions& common);
void add_plan(CLI::App& program, const CommonOptions& common);
void add_verify(CLI::App& program, const CommonOptions& common);
void add_calibrate(CLI::App& program, const CommonOptions& common);
void add_export(CLI::App& program, const CommonOptions& common);
void add_correct(CLI::App& program, const CommonOptions& common);
void add_program(CLI::App& program, const CommonOptions& common);
void add_study(CLI::App& program, const CommonOptions& common);
void add_simulate(CLI::App& program, const CommonOptions& common);
void add_report(CLI::App& program, const CommonOptions& common);

}  // namespace posewise::cli
