#pragma once

#include <Eigen/Cholesky>

#include "spectral.hpp"

namespace posewise::detail {

/// The largest trace(B0 M^-1 B0^T) over the objective's test poses, softened by its sharpness, and
/// its slope by each of them.
Sloped worst_variance(const Objective& objective, const Eigen::LLT<MatrixXd>& cholesky);

/// The rows of sqrt(weight_i) B_i, without those of negligible weight.
RowMatrixXd weighted_rows(const Blocks& blocks, const VectorXd& weights);

}  // namespace posewise::detail
