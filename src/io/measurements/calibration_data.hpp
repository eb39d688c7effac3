#pragma once

#include <string>

#include "posewise/io/measurements_file.hpp"

/// Messages CalibrationData of the ROS package robot_calibration as text.
namespace posewise::detail {

bool is_calibration_data(const std::string& content);

/// Reads robot_calibration_msgs/CalibrationData as `ros2 topic echo` and `rostopic echo` print
/// them, a YAML document each, or as a JSON list: joint_states, by the names of the campaign's
/// joints (rad, m), and of the observation `observation` (empty: the only one whose features move)
/// the features in m, as many as the sensor has targets; nan: not seen. Clouds and images are not
/// looked at. Configurations are called 1, 2, ... in the file's order. `table`: the campaign whose
/// joints they are. Throws InputError with path:line:column.
io::MeasurementsFile read_calibration_data(const std::string& path, const std::string& content,
                                           const Campaign& table, const std::string& observation);

}  // namespace posewise::detail
