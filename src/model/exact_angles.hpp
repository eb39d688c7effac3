#pragma once

#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// A chain and how many of its angles were taken for others.
struct ExactAngles {
    Chain chain;
    Index count = 0;
};

/// Nominal angles within 1e-6 rad of a multiple of a quarter turn are taken as that, which files
/// round: 1.570796, 3.1415926535. Beside it what is identifiable is decided by the rounding. Those
/// of 16 digits and more are computed, of a calibrated robot, and stay.
ExactAngles with_exact_angles(const Chain& chain);

}  // namespace posewise::detail
