#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "commands.hpp"
#include "posewise/io/documents.hpp"

/// --report: what a command found as a page to look at.
namespace posewise::cli {

void add_report_option(CLI::App& command, std::string& path);

/// As it can be typed again: "posewise plan 'my cell.yaml' -k 12".
std::string join_command_line(int argc, char** argv);

/// "2026-11-23T13:14:29Z".
std::string format_time(std::filesystem::file_time_type time);

/// What a command prints, as text and as a document.
struct Printed {
    std::string text;
    std::string document;  ///< only where it is asked for, see needs_document()
};
/// Whether the document is to be printed or shown on a page.
bool needs_document(const CommonOptions& common, const std::string& page);
/// Prints one of them, at once.
void print(const Printed& printed, const CommonOptions& common);

/// The page of what was printed, now, by this command; nothing if there is no path.
void write_page(const std::string& path, io::PagePart part, const Printed& printed,
                const CommonOptions& common);

/// What `map` returns; where nothing can be mapped, nothing, and a warning says why.
std::optional<ErrorMap> map_if_possible(const std::function<ErrorMap()>& map);

}  // namespace posewise::cli
