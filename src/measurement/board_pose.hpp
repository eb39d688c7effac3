#pragma once

#include <optional>
#include <vector>

#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {

/// Corners seen in one view: where they are on the board (m) and in the image (px).
struct BoardView {
    std::vector<Vector3d> corners;
    std::vector<Vector2d> pixels;
};

/// The board in the camera's frame by least squares of the pixels, from whichever of board_starts()
/// ends best. Nothing if fewer than four corners are seen, or only some in one line.
std::optional<Isometry3d> find_board(const BoardView& view, const Intrinsics& intrinsics);

/// Intrinsic parameters from several views of a plane board: closed form without distortion
/// [Zhang 2000], then least squares of all pixels with all boards' poses. Those marked known are
/// kept; `image` (px) gives the principal point where the views do not. Nothing if the views do not
/// determine them.
std::optional<Intrinsics> find_intrinsics(const std::vector<BoardView>& views,
                                          const Intrinsics& stated,
                                          const std::vector<bool>& is_known,
                                          const std::optional<Vector2d>& image);

}  // namespace posewise::detail
