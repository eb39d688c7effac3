#pragma once

#include "posewise/core/blocks.hpp"

namespace posewise::detail {

/// trace(B_i Z B_i^T) of every candidate, Z symmetric; with Z a criterion's gradient, the
/// candidate's sensitivity.
VectorXd sensitivities(const Blocks& candidates, const MatrixXd& Z);

}  // namespace posewise::detail
