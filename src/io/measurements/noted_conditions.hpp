#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posewise/task/answers.hpp"

/// Times and temperatures that stand beside samples.
namespace posewise::detail {

/// Configuration and cell of each sample.
using Notes = std::vector<std::pair<std::string, std::string>>;

/// Seconds of "12.5", of "12:30:05.2" (over midnight from one sample to the next a day later) or of
/// "2026-01-31 12:30:05" ("T" in the place of the blank, or "Z" or an offset behind: passed over);
/// degrees Celsius. Means of each configuration; times in h since the first. What is empty is left
/// out; a condition with a cell that cannot be read is left out altogether.
std::vector<Condition> mean_conditions(const Notes& times, const Notes& temperatures);

}  // namespace posewise::detail
