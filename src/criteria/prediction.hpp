#pragma once

#include <Eigen/Cholesky>

#include "spectral.hpp"

namespace posewise::detail {

/// The largest trace(B0 M^-1 B0^T) over the objective's test poses, softened by its sharpness, and
/// its slope by each of them.
Sloped worst_variance(const Objective& objective, const Eigen::LLT<MatrixXd>& cholesky);

/// sum_i weight_i B_i^T B_i.
MatrixXd weighted_information(const Blocks& blocks, const VectorXd& weights);

}  // namespace posewise::detail
