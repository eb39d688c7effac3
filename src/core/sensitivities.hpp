#pragma once

#include "posewise/core/blocks.hpp"

namespace posewise::detail {

/// trace(B_i Z B_i^T) of every candidate, Z symmetric; with Z a criterion's gradient, the
/// candidate's sensitivity.
VectorXd sensitivities(const Blocks& candidates, const MatrixXd& Z);

/// The same by a lower triangular root F of Z = F F^T.
VectorXd root_sensitivities(const Blocks& candidates, const MatrixXd& F);

}  // namespace posewise::detail
