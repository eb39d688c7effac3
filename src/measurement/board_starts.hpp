#pragma once

#include <optional>
#include <vector>

#include "posewise/measurement/camera_sensor.hpp"

/// Where a board may be, from one view of it: where least squares begin.
namespace posewise::detail {

/// The vector that A makes smallest.
VectorXd null_vector(const MatrixXd& A);
/// From places on a plane to places in an image [Hartley & Zisserman 2004, algorithm 4.2].
Matrix3d homography(const std::vector<Vector2d>& plane, const std::vector<Vector2d>& image);

/// The frame of the plane that corners lie in: z is its normal, its origin their middle. Nothing if
/// they are in no plane (to 1e-6 of their extent). Corners in line have any of the planes.
std::optional<Isometry3d> plane_of(const std::vector<Vector3d>& corners);
/// Places of corners on their plane.
std::vector<Vector2d> in_plane(const std::vector<Vector3d>& corners, const Isometry3d& plane);
/// Whether all are on one line, to 1e-6 of their extent.
bool are_in_line(const std::vector<Vector3d>& corners);

/// Poses of the board in the camera's frame from directions (x/z, y/z) to at least four corners
/// that are not in line: of a plane board by its homography, and leant over to the other side; of
/// others as if they were far away and, of six at least, by the linear equations of the projection
/// [Hartley & Zisserman 2004, algorithm 7.1].
std::vector<Isometry3d> board_starts(const std::vector<Vector3d>& corners,
                                     const std::vector<Vector2d>& directions);

}  // namespace posewise::detail
