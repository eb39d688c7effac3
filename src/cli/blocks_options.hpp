#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "commands.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/task/plan.hpp"

/// What commands that take plain blocks in the place of a robot have in common.
namespace posewise::cli {

/// --blocks; --rows and --variable of the command, which go with it.
CLI::Option* add_blocks_option(CLI::App& group, std::string& blocks);
void add_blocks_layout(CLI::App& command, PlanSources& sources);

/// Throws a usage error for --rows and --variable that are missing or of another kind of file.
void check_blocks_usage(const std::string& blocks, const PlanSources& sources);

/// Throws a usage error for any option that was given but is not among `used`.
void check_only(const CLI::App& command, const std::vector<std::string>& used,
                const std::string& rule);

/// Reads blocks with that layout, and warns of what the file says against it.
io::BlocksFile read_blocks(const std::string& path, const PlanSources& sources);

/// Prints "200 candidates, 3 rows, 21 parameters", but for a document.
void print_size(const Blocks& blocks, const CommonOptions& common);

}  // namespace posewise::cli
