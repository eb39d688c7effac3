#pragma once

#include <array>
#include <optional>

#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// The middle of a camera's image or, if its size is not stated, of what it sees; and its extents,
/// px. Cameras count from 0.
std::array<Vector2d, 2> image_of(const CameraSensor& sensor, Index camera,
                                 const Measurements& measured);

/// Whether the intrinsic parameters that are stated as known fit far better as those of the image
/// in another size, or turned by a quarter: tried where the principal point is away from the middle
/// or corners fit no pose of the board as they should. Nothing: not so, or of no camera.
std::optional<OtherImage> find_other_image(const Campaign& campaign, const Measurements& measured,
                                           const Parameters& registered);

/// By which half of the corners are missed if a camera on the flange stands still, with the board
/// on the flange, or the other way round; nothing: not as a robot misses them, not far less than
/// now, or of no camera.
std::optional<double> find_other_side(const Campaign& campaign, const Measurements& measured,
                                      const Misfit& misfit);

}  // namespace posewise::detail
