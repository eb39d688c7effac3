#pragma once

#include <CLI/CLI.hpp>
#include <memory>

namespace posewise::cli {

/// What `posewise COMMAND --help` prints: examples first, then a line an option, within 100
/// columns.
std::shared_ptr<CLI::FormatterBase> make_brief_help();

/// `posewise help [TOPIC]` and `posewise completion SHELL`.
void add_help_commands(CLI::App& program);

}  // namespace posewise::cli
