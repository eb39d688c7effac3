#pragma once

#include <optional>

#include "posewise/measurement/campaign.hpp"

/// Where base and targets can be.
namespace posewise::detail {

inline constexpr double farthest_base = 1e3;     // m, of any frame
inline constexpr double farthest_target = 10;    // m
inline constexpr double nearest_targets = 1e-3;  // m: no two reflectors fit into that

/// Where a tracker stands, in the world: the one whose noise the sensor has, or of whose sight the
/// cell speaks. Nothing if there is none.
std::optional<Vector3d> tracker_position(const Campaign& campaign);

/// Throws InputError if base or targets are stated where no cell has them: numbers in another unit
/// by the look of them, which it names.
void check_places(const Campaign& campaign);

}  // namespace posewise::detail
