#pragma once

#include "objective.hpp"

namespace posewise::detail {

/// The criterion of stacked rows (those held and those of the poses chosen, rows x parameters): the
/// value that is stated, compared at the end and verified. By QR of the rows, so that its relative
/// error is about the rounding of numbers times the condition number of the rows; by their
/// information matrix (evaluate()) it is times its square. Minus infinity where the rows do not
/// identify all parameters, nuisance included, by count_independent_columns(); never NaN.
/// `objective.sharpness` must be infinite.
double evaluate_rows(const Objective& objective, const RowMatrixXd& stacked);

}  // namespace posewise::detail
