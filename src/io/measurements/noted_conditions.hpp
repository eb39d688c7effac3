#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/io/measurements_file.hpp"

/// Times and temperatures that stand beside samples.
namespace posewise::detail {

/// Configuration and cell of each sample.
using Notes = std::vector<std::pair<std::string, std::string>>;

struct NotedConditions {
    std::vector<Condition> conditions;
    std::optional<io::NotedTimes> times;
};

/// Seconds of "12.5", of "12:30:05.2" (over midnight from one sample to the next a day later) or of
/// "2026-01-31 12:30:05" ("T" in the place of the blank, or "Z" or an offset behind: passed over);
/// degrees Celsius. Means of each configuration; times in h since the first. What is empty is left
/// out; a condition with a cell that cannot be read is left out altogether.
NotedConditions mean_conditions(const Notes& times, const Notes& temperatures);

/// Puts them into the file; a column that was there but could not be read is one that is not used.
void keep_conditions(NotedConditions noted, bool has_time, bool has_temperature,
                     io::MeasurementsFile& file);

}  // namespace posewise::detail
