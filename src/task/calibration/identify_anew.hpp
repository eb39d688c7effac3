#pragma once

#include <optional>

#include "posewise/calibrator/identification.hpp"

namespace posewise::detail {

/// Identified from nothing, base and targets registered first; nothing unless the measurements
/// identify all parameters.
std::optional<Estimate> identify_anew(const Campaign& campaign, const Measurements& measurements,
                                      const LevenbergMarquardtOptions& options = {});

}  // namespace posewise::detail
