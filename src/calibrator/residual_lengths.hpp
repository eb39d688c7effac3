#pragma once

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// The length of each row of some columns of residuals(), in the rows' order. NaN is what a target
/// does not have: it counts as 0, and rows of nothing else are left out.
VectorXd residual_lengths(const Eigen::Ref<const RowMatrixXd>& residuals);

}  // namespace posewise::detail
