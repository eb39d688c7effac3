#pragma once

#include <optional>

#include "posewise/task/judgement.hpp"

namespace posewise::detail {

/// Wilcoxon's statistic of log(after / before) over configurations for which both sums of squares
/// are above 0, in its standard deviations by chance; 0 of none. `count` of them, if asked for.
double rank_deviations(const VectorXd& after, const VectorXd& before, Index* count = nullptr);

/// RMS of squared distances of the points that are marked.
double rms_of(const RowMatrixXd& squares, const Seen& is_judged);

/// Points that were held out: seen, and of configurations whose group could be predicted.
Seen points_held_out(const Measurements& measurements, const CrossValidation& held_out);

/// Groups to hold out, so many if any were asked for; else up to ten. 0: there is one
/// configuration.
Index comparable_folds(Index asked, Index configuration_count);

/// Holds out of the nominal robot, `robot` without its errors, what was held out of the calibrated
/// one. Nothing where no group of either could be predicted.
std::optional<HeldOutComparison> compare_with_nominal(const Campaign& campaign, const Chain& robot,
                                                      const Measurements& measurements,
                                                      Parameters registered,
                                                      const CrossValidation& calibrated,
                                                      const LevenbergMarquardtOptions& options);

}  // namespace posewise::detail
