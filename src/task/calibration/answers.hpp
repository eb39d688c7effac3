#pragma once

#include <optional>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/answers.hpp"
#include "posewise/task/judgement.hpp"

/// What the residuals of a calibration tell beyond their size. Residuals are those of residuals().
namespace posewise::detail {

/// A line through the means of the configurations in the order measured, each axis by itself. Its
/// error grows with the correlation of neighbours, as of a process that remembers one step (AR(1)).
/// The probability is Bonferroni's. Nothing with fewer than four configurations.
std::optional<OrderTrend> find_order_trend(const Campaign& campaign,
                                           const Measurements& measurements,
                                           const RowMatrixXd& residuals);

/// The same lines over each condition instead of the order. Conditions of which fewer than four
/// configurations are known, or that are the same at all of them, are left out.
std::vector<ConditionTrend> find_condition_trends(const Campaign& campaign,
                                                  const Measurements& measurements,
                                                  const RowMatrixXd& residuals,
                                                  const std::vector<Condition>& conditions);

/// Nothing if no configuration could be predicted without itself.
std::optional<Influence> find_influence(const Campaign& campaign, const Measurements& measurements,
                                        const RowMatrixXd& residuals,
                                        const CrossValidation& held_out);

/// 95 % interval of the held-out RMS, by how much the mean squares of configurations differ
/// (Student's t of their mean, on the logarithm). Nothing with fewer than three configurations.
std::optional<RmsInterval> held_out_interval(const Campaign& campaign,
                                             const Measurements& measurements,
                                             const CrossValidation& held_out);

}  // namespace posewise::detail
