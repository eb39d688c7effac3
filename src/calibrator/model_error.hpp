#pragma once

#include "least_squares.hpp"

namespace posewise::detail {

/// Whether identify() is to find the model error: it stands beside priors, and is not stated to be
/// none.
bool is_model_error_open(const Campaign& campaign);

/// The model errors (of lengths, of angles) under which each configuration is predicted best by all
/// the others: the sum of the logarithms of their predictive densities, linearised at `parameters`,
/// and of a log-normal density about what `expected` states (factor 2.5) is taken as that of their
/// own densities, normal about the maximum, and their mean squares by it returned. With G =
/// B M^-1 B^T of a configuration's whitened rows B and e its residuals at the optimum, it is
/// predicted with residuals (I - G)^-1 e and covariance (I - G)^-1 [Rasmussen & Williams 2006, sec.
/// 5.4.2, in parameter space]. Of many configurations a part of them, evenly. Under a robust loss
/// targets count by their weights. `problem` is of `expected` or of the same with other model
/// errors. Returns `expected` with the errors found.
Campaign find_model_error(const IdentificationProblem& problem, const Parameters& parameters,
                          const Campaign& expected);

}  // namespace posewise::detail
