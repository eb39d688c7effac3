#pragma once

#include "least_squares.hpp"

namespace posewise::detail {

/// The largest model error that is looked for, in expected ones: beyond, the model or a measurement
/// is wrong.
constexpr double most_model_errors = 40;

/// Whether identify() is to find the model error: it stands beside priors, and is not stated to be
/// none.
bool is_model_error_open(const Campaign& campaign);

/// The model errors (of lengths, of angles) under which each configuration is predicted best by all
/// the others. With G = B M^-1 B^T of a configuration's whitened rows B, linearised at
/// `parameters`, and e its residuals at the optimum, it is predicted with residuals (I - G)^-1 e
/// and covariance (I - G)^-1 [Rasmussen & Williams 2006, sec. 5.4.2, in parameter space]. The
/// logarithms of these densities are added up and count for the part of the observations, 1 - mean
/// of G's diagonal, that the parameters leave over: n predictions by the others tell no more than n
/// - p free observations (for numbers about an unknown mean this gives the variance its exact
/// density). With a log-normal density about what `expected` states (factor 2.5) that is taken as
/// the density of the logarithms of model errors, and their mean squares by it are returned. Of
/// many configurations a part of them, evenly. Under a robust loss without its outliers, the others
/// in full: weights would take them for less noise than there is [Rousseeuw & Leroy 1987,
/// sec. 5.2]. `problem` is of `expected` or of the same with other model errors. Returns `expected`
/// with the errors found.
Campaign find_model_error(const IdentificationProblem& problem, const Parameters& parameters,
                          const Campaign& expected);

}  // namespace posewise::detail
