#pragma once

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {

/// Errors of the robot within `bounds` (m or rad, zeros stay zero) that fit the measured means
/// well, base and targets registered anew for each: the best of a population search that draws from
/// `stream`. Nothing within `evaluation_limit` that can be registered: no errors.
VectorXd search_population(const Campaign& campaign, const Measurements& means,
                           const VectorXd& bounds, StartSearch search, Index evaluation_limit,
                           RandomStream stream);

}  // namespace posewise::detail
