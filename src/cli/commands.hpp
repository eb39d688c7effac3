#pragma once

#include <CLI/CLI.hpp>

/// The subcommands, one file each. Every function adds its command to the program; the work is done
/// in the command's callback, once the whole command line is known to be right.
namespace posewise::cli {

void add_inspect(CLI::App& program);
void add_indices(CLI::App& program);
void add_select(CLI::App& program);
void add_plan(CLI::App& program);
void add_verify(CLI::App& program);
void add_calibrate(CLI::App& program);
void add_export(CLI::App& program);
void add_correct(CLI::App& program);
void add_study(CLI::App& program);
void add_simulate(CLI::App& program);

}  // namespace posewise::cli
