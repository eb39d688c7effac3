#pragma once

#include "posewise/task/planning.hpp"

namespace posewise::detail {

/// Fills in Planning::left_out of a plan made with these options. Where C0 and C1 are the columns
/// of the prediction by the errors that are fitted and by those left out, and M that of the fitted
/// ones, errors of the expected sizes leave the positions off by
///
///     C1 - C0 M^-1 B0^T B1
///
/// since the fit takes what the poses show of them, B0^T B1, for errors that it has: the bias of
/// least squares by variables left out [Box and Draper 1959, JASA 54].
void judge_left_out(Planning& planning, const PlanningOptions& options);

}  // namespace posewise::detail
