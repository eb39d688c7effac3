#pragma once

#include "posewise/task/planning.hpp"

namespace posewise::detail {

/// Fills in Planning::left_out of a plan made with these options, where errors that the robot has
/// and its model has not make a tenth of the error or more. With B0 and C0 the columns of the
/// fitted parameters at the poses and at the workspace, B and C those of all errors of the richer
/// model, scaled by their expected sizes, and M the fitted information, H of it known before, the
/// square error over the workspace is
///
///     |C - C0 M^-1 B0^T B|^2 + trace(C0 M^-1 (M - H) M^-1 C0^T)
///
/// The fit takes what the poses show of all errors for those that it has: bias and variance of
/// least squares with variables left out [Box and Draper 1959, JASA 54].
void judge_left_out(Planning& planning, const PlanningOptions& options);

}  // namespace posewise::detail
