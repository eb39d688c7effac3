#pragma once

#include <optional>

#include "posewise/calibrator/estimate.hpp"

namespace posewise::detail {

/// Residuals over what noise and model error let expect, where that is beyond chance and more than
/// a fifth off.
std::optional<double> clear_ratio(const ResidualVariance& variance, LossKind loss);

/// The model error (m or rad) with which residuals of a kind would be as `expected`, what
/// expected_error() says of `found` and its estimate.
double fitting_model_error(const Campaign& found, const Estimate& estimate,
                           const ExpectedError& expected, bool is_angle);

}  // namespace posewise::detail
