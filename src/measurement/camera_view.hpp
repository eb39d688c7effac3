#pragma once

#include "camera_model.hpp"

namespace posewise::detail {

/// Where the first camera is and how what it sees moves, the same for every corner.
struct BoardFromCamera {
    bool is_on_flange = false;
    Isometry3d place;    ///< of what is on the flange, in its frame
    Isometry3d camera;   ///< CameraSensor::camera_from_board()
    Matrix3d flange;     ///< the flange's axes in the world
    Matrix3d turn_rate;  ///< of an unknown place by its rotation vector; else zero
};

/// One of the cameras.
struct CameraInFirst {
    Isometry3d in_first;
    /// With the unknown intrinsic parameters. Beyond the widest direction as stated, for
    /// brown_conrady at most 72 degrees, no place depends on the polynomial.
    Lens lens;
    Matrix3d turn_rate;  ///< of its place by its rotation vector; zero of the first

    /// A point of the first camera's frame in this one's.
    Vector3d seen(const Vector3d& point) const { return in_first.inverse() * point; }
};

/// The frame of a position and a rotation vector.
Isometry3d frame_from(const Eigen::Ref<const VectorXd>& six);

CameraInFirst camera_in_first(const CameraSensor& sensor, Index camera, const VectorXd& unknowns);

BoardFromCamera board_from_camera(const CameraSensor& sensor, const Isometry3d& world_from_flange,
                                  const VectorXd& unknowns);

/// Throws InputError for a number that no lens has.
void check_growth(const NoiseGrowth& growth);

}  // namespace posewise::detail
