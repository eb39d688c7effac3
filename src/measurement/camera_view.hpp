#pragma once

#include "camera_model.hpp"

namespace posewise::detail {

/// Where a camera is and how what it sees moves, the same for every corner.
struct BoardFromCamera {
    bool is_on_flange = false;
    Isometry3d place;   ///< of what is on the flange, in its frame
    Isometry3d camera;  ///< CameraSensor::camera_from_board()
    Matrix3d flange;    ///< the flange's axes in the world
    /// With the unknown intrinsic parameters. Beyond the widest direction as stated, for
    /// brown_conrady at most 72 degrees, no place depends on the polynomial.
    Lens lens;
    double factor = 1;   ///< of the board's size
    Matrix3d turn_rate;  ///< of an unknown place by its rotation vector; else zero
};

BoardFromCamera board_from_camera(const CameraSensor& sensor, const Isometry3d& world_from_flange,
                                  const VectorXd& unknowns);

}  // namespace posewise::detail
