#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

namespace posewise::cli {

/// What `posewise COMMAND --help` prints: examples first, then a line an option, within 100
/// columns.
std::shared_ptr<CLI::FormatterBase> make_brief_help();

/// What `posewise help COMMAND` prints.
std::string full_help_of(const CLI::App& command);

/// Also those of its groups of which one is asked for.
std::vector<const CLI::Option*> options_of(const CLI::App& command);

std::vector<const CLI::App*> commands_of(const CLI::App& program);

/// `posewise help [TOPIC]` and `posewise completion SHELL`.
void add_help_commands(CLI::App& program);

}  // namespace posewise::cli
