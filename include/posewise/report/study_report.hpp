#pragma once

#include <string>

#include "posewise/report/table.hpp"
#include "posewise/task/study.hpp"

namespace posewise {

/// A study's held-out distance RMS in mm by pose count: one column each criterion, then the random
/// subsets' 10, 50 and 90 % quantiles and how many of them could not identify the model. "-" where
/// there is no number.
Table study_table(const Study& study);

/// The table as text, or why there is nothing to study.
std::string format(const Study& study);

/// Every case of a study as CSV text: pose count, who chose (criterion or "random"), number of the
/// subset, whether it identified the model, held-out distance RMS and maximum in mm (9 digits), and
/// the configurations by id, separated by blanks.
std::string study_csv(const Study& study);

}  // namespace posewise
