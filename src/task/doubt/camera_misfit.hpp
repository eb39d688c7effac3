#pragma once

#include <optional>

#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// Where several cameras together are missed by `misfit`: whether that is one camera's, or none's
/// by itself. Nothing: of one camera, where all are missed alike, or where one shows too little by
/// itself.
std::optional<Misfit> find_camera_misfit(const Campaign& campaign, const Measurements& measured,
                                         const Misfit& misfit);

/// Whether most views of a camera fit no pose of the board by far, as the sensor's sigma is:
/// whatever the robot does, something is wrong with image or board. Only of a plane board that is
/// exactly known: few markers of a body often find no pose.
bool fits_no_pose(const Campaign& campaign, const Measurements& measured,
                  const Parameters& registered);

}  // namespace posewise::detail
