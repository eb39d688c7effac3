#pragma once

#include "least_squares.hpp"

namespace posewise::detail {

/// Fills the estimate's variances by kind, where lengths and angles are measured, and returns the
/// covariance of coordinates: root root^T without noise other than stated, root the inverse of the
/// triangle of `system`, the system at the estimate under squares. A prior states the noise, too:
/// residuals that are larger or smaller do not change it.
MatrixXd find_variances(const IdentificationProblem& problem, const LinearisedSystem& system,
                        const MatrixXd& root, Estimate& estimate);

}  // namespace posewise::detail
