#pragma once

#include "least_squares.hpp"

/// What a robust loss adds to least squares; the formulas stand at LevenbergMarquardtOptions.
namespace posewise::detail {

/// With the default width for this sensor where it is 0. Throws InputError for a width that is
/// negative or not finite.
Loss complete_loss(const Loss& loss, const Campaign& campaign);

/// Standard deviation of a whitened coordinate from the median length of the residuals: half of the
/// targets may be anywhere. At least 1e-6, 1 without a degree of freedom.
double robust_deviation(const IdentificationProblem& problem, const Parameters& parameters);

/// What the inverse of the weighted equations is multiplied by to be the covariance.
double robust_covariance_factor(const IdentificationProblem& problem, const Estimate& estimate);

std::vector<Outlier> find_outliers(const IdentificationProblem& problem,
                                   const Parameters& parameters);

}  // namespace posewise::detail
