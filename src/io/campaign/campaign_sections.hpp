#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "io/format/yaml_reader.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/camera_sensor.hpp"

/// The sections of a campaign file, one function each.
namespace posewise::detail {

struct RobotSection {
    Chain declared;
    RobotClass robot_class = RobotClass::Unknown;
    io::ErrorModel error_model = io::ErrorModel::Stated;
    std::vector<YamlValue> free = {};       ///< the only errors of that model; empty: all
    Vector3d gravity = -Vector3d::UnitZ();  ///< its direction in the base frame
    VectorXd joint_repeatability;           ///< rad or m; empty if not stated
    std::optional<io::UrdfSource> urdf;     ///< where the robot comes from
    std::vector<std::string> warnings;      ///< of the URDF
    VectorXd speed;                         ///< of the joints, rad/s or m/s; empty if not stated
};
/// "stated", "geometric" or "full".
io::ErrorModel read_error_model(const YamlValue& errors);

/// `errors`: instead of those that it states.
RobotSection read_robot(const YamlValue& robot, std::optional<io::ErrorModel> errors);

struct SensorSection {
    std::shared_ptr<const Sensor> sensor;
    VectorXd unknowns;          ///< nominal values of the sensor's unknowns, m or rad
    bool has_positions = true;  ///< whether they were stated, not made up
    /// Whether the world is the robot's base frame: nothing in the world is known that tells
    /// another.
    bool is_in_base_frame = false;
    /// Unknowns that are the first coordinates of places which the robot reaches, nobody said
    /// where.
    std::vector<Index> reached = {};
};
SensorSection read_sensor(const YamlValue& sensor);
/// Several that measure together, a list.
SensorSection read_sensors(const YamlValue& sensors);
/// Of kind camera.
SensorSection read_camera(const YamlValue& sensor);
/// Of kind camera, with the key same_camera: `camera`, which sees another board.
SensorSection read_another_board(const YamlValue& sensor, const CameraSensor& camera);

/// How the controller's joints follow from those of `robot`.
struct ControllerSection {
    ControllerJoints joints;
    std::string maker = "";  ///< empty: not stated
};
ControllerSection read_controller(const YamlValue& controller, const Chain& robot);

/// `robot` gives the joints' names and limits, `controller` further names of joint sums.
Cell read_cell(const YamlValue& cell, const Chain& robot, const Sensor& sensor,
               const ControllerJoints& controller);

/// Whether such a key is there and says so.
bool is_true(const YamlMap& map, std::string_view key);

/// Position and `rpy` of a frame.
Isometry3d read_frame(const YamlMap& map);

/// `true`, `false` or the names of those known, out of `names`: one mark each.
std::vector<bool> read_known(const YamlValue& known, const std::vector<std::string>& names);

inline constexpr double largest_amount = 1e3;  // m or rad
/// The largest size that errors may be expected to have, m or rad.
double largest_error(Quantity quantity);

/// Whether a positive amount, m or rad, is at most so large, and large enough to be meant.
bool is_plausible_amount(double si, double largest);
/// That rule in words and in this unit, "from 1e-09 to 1e+06 mm".
std::string plausible_amount(const Unit& unit, double largest);

/// A measure that must be positive, or with `zero_allowed` not negative, and at most so large; m or
/// rad.
double read_positive(const YamlMeasure& measure, bool zero_allowed = false,
                     double largest = largest_amount);

enum class Sign { Positive, Any };

/// A number and its unit in the value itself, `0.5 mrad`; m or rad. Positive ones at most so large.
double read_amount(const YamlValue& value, Quantity quantity, Sign sign,
                   double largest = largest_amount);

}  // namespace posewise::detail
