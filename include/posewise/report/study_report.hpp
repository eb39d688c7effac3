#pragma once

#include <string>
#include <vector>

#include "posewise/report/table.hpp"
#include "posewise/task/study.hpp"

namespace posewise {

/// A study's held-out distance RMS in mm by pose count: one column each criterion, then the random
/// subsets' 10, 50 and 90 % quantiles and how many of them could not identify the model. "-" where
/// there is no number. `criteria` are those the study was asked for.
Table study_table(const std::vector<Criterion>& criteria, const std::vector<StudyRow>& rows);

/// Every case of a study as CSV text: pose count, who chose (criterion or "random"), number of the
/// subset, whether it identified the model, held-out distance RMS and maximum in mm (9 digits), and
/// the configurations by id, separated by blanks.
std::string study_csv(const std::vector<Criterion>& criteria, const std::vector<StudyRow>& rows,
                      const std::vector<std::string>& configuration_ids);

}  // namespace posewise
