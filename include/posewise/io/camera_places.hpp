#pragma once

#include <optional>
#include <string>

#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::io {

/// Where an estimate has camera and board.
struct CameraPlaces {
    bool is_on_flange = false;  ///< the camera; else the board
    /// Where the camera is, z forwards and x to the right of its image: in the flange frame; a
    /// fixed one in the robot's base frame.
    Isometry3d camera = Isometry3d::Identity();
    /// Where the board is, in the other frame.
    Isometry3d board = Isometry3d::Identity();
    std::optional<Intrinsics> intrinsics;  ///< known if corners were measured
    std::optional<Vector2d> image;         ///< width and height, px
    std::vector<PlacedCamera> others{};
};
/// The sensor must measure corners in an image, or poses of a board; else the result is empty.
std::optional<CameraPlaces> camera_places(const Campaign& campaign, const Parameters& found);

/// Throws InputError if the name does not end in .yaml, .yml, .urdf or .xacro.
void check_camera_path(const std::string& path);
/// The ending chooses the format. YAML is a file for OpenCV's FileStorage: intrinsic parameters,
/// and both frames as 4 x 4 matrices (m); of further cameras likewise, `camera2_matrix` and
/// `camera_from_camera2`. URDF has fixed joints to the frames camera_optical_frame (further ones
/// camera2_optical_frame on it) and calibration_board; their parents are the campaign's base and
/// tip link, base_link and tool0 without a URDF. Throws InputError as check_camera_path(), or if no
/// file can be there.
void write_camera(const std::string& path, const CampaignFile& file, const CameraPlaces& places);
/// The camera's place as arguments of ROS 2's static_transform_publisher.
std::string static_transform(const CampaignFile& file, const CameraPlaces& places);

}  // namespace posewise::io
