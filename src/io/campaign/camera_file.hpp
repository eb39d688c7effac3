#pragma once

#include <optional>
#include <string>

#include "io/format/yaml_reader.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {

/// A camera as its own calibration left it.
struct CameraFile {
    Intrinsics intrinsics;
    std::optional<Vector2d> image;  ///< px
};

/// A YAML file of OpenCV's FileStorage or of ROS (camera_matrix, distortion_coefficients or
/// distortion_coeffs, image_width), or of Kalibr (cam0: intrinsics, distortion_coeffs). Throws
/// InputError with its place; `asked_by` names it where it cannot be read. Of a file that holds
/// several (camera2_matrix, as write_camera() has them, or cam1) the one numbered `camera`, from 0.
CameraFile read_camera_file(const std::string& path, const YamlValue& asked_by, Index camera);

}  // namespace posewise::detail
