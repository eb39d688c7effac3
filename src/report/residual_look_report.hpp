#pragma once

#include <string>
#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// A sentence for each thing that the look at the residuals has found.
std::vector<std::string> describe_look(const ResidualLook& look, const Campaign& campaign);

}  // namespace posewise::detail
