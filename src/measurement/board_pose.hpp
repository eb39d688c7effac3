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

/// The frame of the plane that corners lie in: z is its normal, its origin their middle. Nothing if
/// they are in no plane (to 1e-6 of their extent). Corners in line have any of the planes.
std::optional<Isometry3d> plane_of(const std::vector<Vector3d>& corners);
/// Whether all are on one line, to 1e-6 of their extent.
bool are_in_line(const std::vector<Vector3d>& corners);

/// The board in the camera's frame: by the homography of corners in a plane (at least 4, no three
/// quarters of them in line) or the linear equations of others (at least 6) [Hartley & Zisserman
/// 2004, algorithms 4.2 and 7.1], then by least squares of the pixels. Nothing if too few are seen.
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
