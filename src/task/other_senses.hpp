#pragma once

#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// In which other sense of the orientations the nominal robot misses them by less than `tolerance`
/// (rad, RMS), into `doubt`.
void find_other_sense(const Campaign& campaign, const Measurements& measurements, double tolerance,
                      OrientationDoubt& doubt);

}  // namespace posewise::detail
