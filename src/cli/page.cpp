#include "page.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <ctime>

#include "common.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

/// As a shell takes it for one argument.
std::string quote_argument(const std::string& argument) {
    const bool is_plain =
        !argument.empty() && argument.find_first_not_of(
                                 "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                 "_-+=:,./@%") == std::string::npos;
    if (is_plain) return argument;
    std::string quoted = "'";
    for (const char c : argument) quoted += c == '\'' ? "'\\''" : std::string(1, c);
    return quoted + "'";
}

std::string text_of(const Printed& printed) { return format(printed.answers) + printed.text; }

}  // namespace

void add_report_option(CLI::App& command, std::string& path) {
    command
        .add_option("--report", path,
                    "Write it as one HTML file to look at, too: opens in any browser, needs no "
                    "network")
        ->check(file_name());
}

std::string join_command_line(int argc, char** argv) {
    std::string line = "posewise";
    for (int k = 1; k < argc; ++k) line += ' ' + quote_argument(argv[k]);
    return line;
}

std::string format_time(std::filesystem::file_time_type time) {
    using std::chrono::system_clock;
    const auto since = std::chrono::duration_cast<system_clock::duration>(
        time - std::filesystem::file_time_type::clock::now());
    const std::time_t seconds = system_clock::to_time_t(system_clock::now() + since);
    std::tm utc{};
    ::gmtime_r(&seconds, &utc);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                       utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

void print(const Printed& printed, const CommonOptions& common) {
    if (common.json) {
        print_document(printed.document(), printed.answers);
    } else {
        print(text_of(printed));
    }
    std::fflush(stdout);  // what comes behind may take its time, or fail
}

void write_page(const std::string& path, io::PagePart part, const Printed& printed,
                const CommonOptions& common) {
    if (path.empty()) return;
    part.command = common.command_line;
    part.made_at = format_time(std::filesystem::file_time_type::clock::now());
    part.printed = text_of(printed);
    part.document = io::with_sentences(printed.document(), given_warnings(), printed.answers);
    io::write_page(path, {part}, given_warnings());
}

std::optional<ErrorMap> map_if_possible(const std::function<ErrorMap()>& map) {
    try {
        return map();
    } catch (const InputError& error) {
        print_warning(std::string("the page shows no map of errors: ") + error.what());
        return std::nullopt;
    }
}

}  // namespace posewise::cli
