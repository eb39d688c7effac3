#pragma once

#include <cstdint>
#include <optional>

#include "posewise/measurement/campaign.hpp"

namespace posewise::detail {

/// Configurations of the robot at work, `count` at most: a low-discrepancy sample within its limits
/// and its cell (what the instrument sees does not matter) with every target in the box (in the
/// base frame), if there is one. Throws InputError if there is none.
RowMatrixXd workspace_configurations(const Campaign& campaign, const std::optional<Box>& target_box,
                                     Index count, std::uint64_t seed);

}  // namespace posewise::detail
