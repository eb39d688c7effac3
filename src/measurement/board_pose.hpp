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

/// Whether four corners are seen, or more, that are not all on one line of the board.
bool shows_enough(const BoardView& view);

struct BoardFit {
    Isometry3d board;  ///< in the camera's frame
    double rms = 0;    ///< of what is left of u and v, by the degrees of freedom left, px
    /// Whether that may be a view of the board: not if corners are at one place or on one line in
    /// the image, or more than a quarter of their spread is left over.
    bool is_good = false;
};

/// The board by least squares of the pixels, from whichever of board_starts() ends best. Nothing if
/// too little of it is seen.
std::optional<BoardFit> find_board(const BoardView& view, const Intrinsics& intrinsics);

/// Beyond which a view is not of this board, where the others leave so much over, px.
double most_left_over(const std::vector<double>& left_over);

/// Those of a plane board whose corners are not grossly wrong, whatever the lens; all of another.
std::vector<BoardView> keep_plane_views(const std::vector<BoardView>& views);

/// Intrinsic parameters from several views of a plane board: closed form without distortion
/// [Zhang 2000], then least squares of all pixels with all boards' poses. Those marked known are
/// kept; `image` (px) gives the principal point where the views do not. Nothing if the views do not
/// determine them.
std::optional<Intrinsics> find_intrinsics(const std::vector<BoardView>& views,
                                          const Intrinsics& stated,
                                          const std::vector<bool>& is_known,
                                          const std::optional<Vector2d>& image);

}  // namespace posewise::detail
