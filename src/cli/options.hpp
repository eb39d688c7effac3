#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"

/// Checks of what an option may hold; anything else is a usage error.
namespace posewise::cli {

inline constexpr std::uint64_t largest_seed = std::numeric_limits<std::uint64_t>::max();

/// Decimal digits and nothing else (no sign, no blank, no 0x, no leading zero), within the range.
CLI::Validator whole_number(std::uint64_t least, std::uint64_t most);

/// A finite decimal number within the range.
CLI::Validator real_number(double least, double most);

/// Not empty.
CLI::Validator file_name();

/// Takes ids or names separated by commas, none empty; may be given several times. `allowed`: which
/// ones; empty: any.
CLI::Option* add_ids_option(CLI::App& command, const std::string& name,
                            std::vector<std::string>& ids, const std::string& help,
                            const std::vector<std::string>& allowed = {});

/// --effort: sets `starts` and, unless it is null, `proof`; excludes the options of these names.
CLI::Option* add_effort_option(CLI::App& command, Index& starts,
                               std::optional<double>* proof = nullptr);

/// --prior and --no-prior; `consequence` ends the help's sentence.
void add_prior_option(CLI::App& command, std::optional<bool>& prior,
                      const std::string& consequence);

/// --progress.
void add_progress_flag(CLI::App& command, bool& is_shown);

}  // namespace posewise::cli
