#pragma once

#include "io/format/yaml_reader.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {

/// Corners, pattern and numbering of the board that a camera sees, and which side is its front.
void read_board(const YamlValue& board, CameraSetup& setup);

}  // namespace posewise::detail
