#pragma once

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// Of columns of residuals() the length of each row, in the rows' order; what a target does not
/// have (NaN) counts 0, and rows of targets that have none of them are left out.
VectorXd residual_lengths(const Eigen::Ref<const RowMatrixXd>& residuals);

}  // namespace posewise::detail
