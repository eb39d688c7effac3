#pragma once

#include "posewise/core/blocks.hpp"

namespace posewise {

/// trace(B_i Z B_i^T) of every candidate; with Z a criterion's gradient, its sensitivity.
VectorXd sensitivities(const Blocks& candidates, const MatrixXd& Z);

/// Indices of the `count` largest values, the lower index first among equals.
std::vector<Index> largest_indices(const VectorXd& values, Index count);

}  // namespace posewise
