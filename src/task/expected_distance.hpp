#pragma once

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::detail {

/// Another robot's measurements are off by more than so many expected errors.
inline constexpr double credible_errors = 10;

/// By how much the nominal robot is expected to miss the points measured, as the spread and the
/// model error say: RMS, m.
double expected_distance(const Campaign& campaign, const Measurements& measured);

}  // namespace posewise::detail
