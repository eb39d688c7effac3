#pragma once

#include "posewise/task/study.hpp"
#include "table.hpp"

namespace posewise::detail {

/// A study's held-out distance RMS in mm by pose count: one column each criterion, then the random
/// subsets' 10, 50 and 90 % quantiles and how many of them could not identify the model. "-" where
/// there is no number.
Table study_table(const Study& study);

/// Studies of several error models side by side: by pose count and model the median of the random
/// subsets and of each criterion's, with splits also the latter against random ones of that model,
/// with the 95 % interval, and of the first model.
Table models_table(const std::vector<Study>& studies);

}  // namespace posewise::detail
