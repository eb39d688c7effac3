#pragma once

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {

/// Errors of the robot within `bounds` (m or rad, zeros stay zero) that fit the measured means
/// well, base and targets registered anew for each: the best of a search by covariance matrix
/// adaptation that draws from `stream`. Nothing within `evaluation_limit` that can be registered:
/// no errors.
VectorXd adapt_covariance(const Campaign& campaign, const Measurements& means,
                          const VectorXd& bounds, Index evaluation_limit,
                          const RandomStream& stream);

}  // namespace posewise::detail
