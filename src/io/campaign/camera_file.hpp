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
/// InputError with its place; `asked_by` names it. Of a file that holds
/// several (camera2_matrix, as write_camera() has them, or cam1) the one numbered `camera`, from 0.
CameraFile read_camera_file(const YamlValue& asked_by, Index camera);

/// A file that a campaign names, relative to it. Throws InputError at `asked_by` where there is
/// none that can be read, or nothing but comments in it, and for what is no regular file: a named
/// pipe would be waited for.
struct NamedFile {
    std::string path, content;
};
NamedFile read_named_file(const YamlValue& asked_by);

/// The YAML of a file of OpenCV's FileStorage, too.
YamlValue parse_opencv_yaml(NamedFile file);

}  // namespace posewise::detail
