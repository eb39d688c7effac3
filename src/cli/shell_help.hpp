#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// What a shell and `man` show of the program, from the same descriptions as --help.
namespace posewise::cli {

std::string man_page(const CLI::App& program);

/// What completes commands and options; `shell` is bash or zsh.
std::string completion_of(const CLI::App& program, const std::string& shell);

}  // namespace posewise::cli
