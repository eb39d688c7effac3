#pragma once

#include <string>
#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// The factor that all lengths have, a line; empty where they tell of none.
std::string describe_length_factor(const ResidualLook& look);

/// A sentence for each thing that the look at the residuals has found; what leaving configurations
/// out gains only where no cure says it.
std::vector<std::string> describe_look(const ResidualLook& look, const Cures& cures,
                                       const Campaign& campaign);

}  // namespace posewise::detail
