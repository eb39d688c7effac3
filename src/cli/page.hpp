#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/task/answers.hpp"

/// --report: what a command found as a page to look at.
namespace posewise::cli {

void add_report_option(CLI::App& command, std::string& path);

/// As it can be typed again: "posewise plan 'my cell.yaml' -k 12".
std::string join_command_line(int argc, char** argv);

/// "2026-11-23T13:14:29Z".
std::string format_time(std::filesystem::file_time_type time);

/// What a command prints: the answers and the text after them, or a document, made where it is
/// asked for.
struct Printed {
    std::vector<Answer> answers;
    std::string text;
    std::function<std::string()> document;
};
/// Prints one of them, at once.
void print(const Printed& printed, const CommonOptions& common);

/// The page of what was printed, now, by this command; nothing if there is no path.
void write_page(const std::string& path, io::PagePart part, const Printed& printed,
                const CommonOptions& common);

/// What `map` returns; where nothing can be mapped, nothing, and a warning says why.
std::optional<ErrorMap> map_if_possible(const std::function<ErrorMap()>& map);

}  // namespace posewise::cli
