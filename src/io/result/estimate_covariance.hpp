#pragma once

#include <vector>

#include "io/format/json_reader.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/task/calibration.hpp"

/// What estimate files say of covariances.
namespace posewise::detail {

/// What to do where the estimate has more or fewer unknowns than the campaign.
inline constexpr const char* as_then =
    "; what is known of base and sensor must be stated as when the estimate was made, unless "
    "'--moved' says that they are others";

/// A list of so many numbers.
std::vector<double> read_numbers(const JsonValue& value, std::size_t count);

/// Of all parameters of the campaign, checked against the standard deviations that are stated, too;
/// 0 of what was moved since.
MatrixXd read_covariance(const JsonValue& root, const Campaign& campaign, const EarlierUse& use);

/// Throws InputError where it is clearly not positive definite, less what has variance 0. Drift may
/// make so what is not by rounding.
void check_definite(const JsonValue& root, const MatrixXd& covariance);

}  // namespace posewise::detail
