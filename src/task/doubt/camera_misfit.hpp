#pragma once

#include <optional>

#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// Where several cameras together are missed by `misfit`: whether that is one camera's, or none's
/// by itself. Nothing: of one camera, where all are missed alike, or where one shows too little by
/// itself.
std::optional<Misfit> find_camera_misfit(const Campaign& campaign, const Measurements& measured,
                                         const Misfit& misfit);

}  // namespace posewise::detail
