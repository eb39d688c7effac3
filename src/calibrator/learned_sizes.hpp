#pragma once

#include "least_squares.hpp"

namespace posewise::detail {

/// Whether identify() learns the sizes of the robot's errors, see ParameterSpread::is_open.
bool are_sizes_open(const Campaign& campaign, const Loss& loss);

/// Variance of the logarithm of a size that was learned, where the measurements tell so many of its
/// errors.
double log_size_variance(double told);

/// The sizes of the robot's errors under which the measurements are most probable, with a
/// log-normal density about the expected ones, its deviation a factor of error_size_factor; in the
/// system linearised at these parameters. Sizes stated by parameter name are kept.
ParameterSpread learn_sizes(const IdentificationProblem& problem, const Parameters& parameters,
                            const ParameterSpread& expected);

}  // namespace posewise::detail
