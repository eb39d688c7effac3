#pragma once

#include <string>

#include "posewise/task/study.hpp"

namespace posewise::detail {

/// All that makes a series what it is, and the version of posewise, as JSON: the same text for the
/// same series. Throws InputError, which names the file it is for, if a text in it is not UTF-8.
std::string trial_statement(const TrialSeries& series, const std::string& path);

struct StatedSeries {
    std::string version;  ///< of posewise
    TrialSeries series;
};

/// Throws InputError for what is no such text.
StatedSeries read_trial_statement(const std::string& text, const std::string& path);

}  // namespace posewise::detail
