#pragma once

#include "posewise/task/study.hpp"
#include "table.hpp"

namespace posewise::detail {

/// A study's held-out distance RMS in mm by pose count: one column each criterion, then the random
/// subsets' 10, 50 and 90 % quantiles and how many of them could not identify the model. "-" where
/// there is no number.
Table study_table(const Study& study);

}  // namespace posewise::detail
