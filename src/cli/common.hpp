#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/task/answers.hpp"
#include "posewise/task/plan.hpp"
#include "report/sentences.hpp"
#include "report/table.hpp"

/// What several subcommands share: their arguments, how they print.
namespace posewise::cli {

/// The files most commands begin with.
struct InputPaths {
    std::string campaign;
    std::string measurements;
    std::string plan{};         ///< whose poses were measured
    std::string points_unit{};  ///< unit of a list of points
    /// If there are several measurements, each of a plan of its own: theirs, one by one; the names
    /// above are then all of them, by commas.
    std::vector<InputPaths> parts{};
};
CLI::Option* add_campaign_argument(CLI::App& command, InputPaths& paths);
CLI::Option* add_measurements_option(CLI::App& command, InputPaths& paths);

/// Accepts the name of a criterion; anything else is a usage error that lists them.
CLI::Validator criterion_check();

/// --digits: significant digits of what is printed as text.
void add_digits_option(CLI::App& command, int& digits);

/// `excluded`, and ids of a plan that are not among the measured ones: warns of these where nothing
/// is excluded and it is not said already. Throws InputError if that are all of them.
std::vector<std::string> leave_out_missing(const std::string& plan_path, const Plan& plan,
                                           const io::MeasurementsFile& measured,
                                           const std::vector<std::string>& excluded);

/// find_planned() of a plan in that file, less what is missing.
std::vector<Index> find_planned(const std::string& plan_path, const Plan& plan,
                                const Campaign& campaign, const io::MeasurementsFile& measured,
                                const std::vector<std::string>& excluded);

/// Everything is printed to standard output through these two.
void print(const std::string& text);
void print_section(const std::string& title, const detail::Table& table);

/// "posewise: warning: ..." on standard error, one line whatever it quotes; every document that is
/// printed or written from then on has the sentence, too.
void print_warning(const std::string& text);
/// Warns of limits that seem to be in another unit.
void warn_of_limits(const Campaign& campaign);
/// All that was warned of up to now.
const std::vector<std::string>& given_warnings();

/// Prints a document of io::to_json(), with its answers, if it has any, and what was warned of.
void print_document(const std::string& document,
                    const std::optional<std::vector<Answer>>& answers = std::nullopt);

/// A counter on standard error, shown if that is a terminal or the user asks for it.
class ProgressLine {
  public:
    ProgressLine(std::string label, bool asked_for);
    /// `note` is shown after the percentage.
    void operator()(const Progress& progress, const std::string& note = "");

  private:
    std::string label_;
    bool shown_;
    Index last_percent_ = -1;
};

}  // namespace posewise::cli
