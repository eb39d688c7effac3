#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "io/format/units.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensor.hpp"

/// Columns of CSV files of measurements and configurations, for reader and writers.
namespace posewise::detail {

/// Of a configuration: the numbers of the targets it shows, from 1, separated by blanks.
inline constexpr std::string_view visible_targets = "visible_targets";
/// Of a sample or a configuration: the name of what the robot touches, of sensors with
/// has_contacts(); it stands for the columns observed, and for visible_targets.
inline constexpr std::string_view contact = "socket";

/// Of a row that is one corner in an image: the corner's number, and the camera's where there are
/// several, and before it the sensor's of several.
inline constexpr std::string_view point_column = "point";
inline constexpr std::string_view sensor_column = "sensor";
inline constexpr std::string_view camera_column = "camera";

/// Of a row of configurations: what the robot is sent there for.
inline constexpr std::string_view purpose_column = "purpose";
inline constexpr std::string_view to_calibrate = "calibrate";
inline constexpr std::string_view to_verify = "verify";
inline constexpr std::string_view on_the_way = "via";  ///< nothing is measured there

/// What plan writes beside the configurations: it is not read.
inline constexpr std::string_view way_column = "way";
inline constexpr std::string_view clearance_column = "clearance_mm";
inline constexpr std::string_view nearest_column = "nearest";

/// What correct writes beside the joints, and configurations may hold: it is not read.
inline constexpr std::array<std::string_view, 5> correction_columns{
    "residual_mm", "residual_mrad", "uncorrected_mm", "uncorrected_mrad", "note"};

/// What was noted beside a sample: seconds, or a date and a time of day, or the latter alone.
inline constexpr std::string_view time_column = "time";
inline constexpr std::string_view time_seconds_column = "time_s";
inline constexpr std::string_view temperature_column = "temperature_C";

enum class Role {
    Configuration,
    Sample,
    VisibleTargets,
    Purpose,
    Contact,
    Point,
    Camera,
    Sensor,
    Joint,  ///< or a measured torque: a number of the configuration
    Observation,
    Orientation,
    Time,         ///< of a sample, of measurements
    Temperature,  ///< likewise
    Unused,  ///< torque that the campaign makes no use of, what plan and correct write beside, or
             ///< of measurements whatever else there is
};

/// Other columns for an orientation than its rotation vector: a quaternion without units, or turns
/// about the fixed axes x, y and z.
struct OrientationForm {
    std::vector<std::string> stems;
    bool has_unit;
    OrientationNotation notation;
};
inline const std::array<OrientationForm, 2> orientation_forms{
    {{{"qw", "qx", "qy", "qz"}, false, OrientationNotation::Quaternion},
     {{"roll", "pitch", "yaw"}, true, OrientationNotation::RollPitchYaw}}};

/// Names of a pose's position as ROS has them (in m, REP 103), for x, y and z.
inline constexpr std::array<std::string_view, 3> ros_position{"tx", "ty", "tz"};

/// A column with a unit that a campaign's measurements must have.
struct WantedColumn {
    std::string stem;
    Role role = Role::Joint;
    Index index = 0;
    Quantity quantity = Quantity::Angle;

    std::string example() const;
};

/// What a row of measurements holds: a sample, or one corner of it as its number, u and v.
enum class Form { RowEachSample, RowEachCorner };

/// One of the sensors whose corners are rows, itself or of several.
struct CornerSensor {
    const Sensor* sensor = nullptr;
    Index first_target = 0;  ///< of the campaign's

    Index cameras() const { return camera_count(*sensor); }
    Index corners() const { return sensor->target_count() / cameras(); }
};
std::vector<CornerSensor> corner_sensors(const Sensor& sensor);
/// The index of the one that sees a target.
std::size_t sensor_of(const std::vector<CornerSensor>& sensors, Index target);
/// "point", and "camera" and "sensor" where a row must state them.
std::vector<std::string_view> corner_columns(const Sensor& sensor);

/// Joints, measured torques, then observations, but for contacts.
std::vector<WantedColumn> wanted_columns(const Campaign& campaign, Form form = Form::RowEachSample);

/// What the number in a row of an observation is measured in.
Quantity quantity_of_row(const Sensor& sensor, Index row);

/// The name of the column of a joint's torque without unit, "tau_q2".
std::string torque_stem(const Joint& joint);

/// A joint value in degrees or millimetres, a torque as it is.
double for_people(const Campaign& campaign, Index joint, double value);

/// Columns of a configuration for people and controllers: "q1_deg", "q2_mm", "tau_q2_Nm".
std::vector<std::string> reading_columns(const Campaign& campaign);

/// The same, each after a comma, and the values (rad or m, N m) for them to 12 digits.
std::string joint_header(const Campaign& campaign);
std::string joint_cells(const Campaign& campaign, const VectorXd& q);

/// The column that says which targets a configuration shows, and its cell.
std::string_view seen_header(const Campaign& campaign);
std::string seen_cell(const Campaign& campaign, const SeenTargets& is_seen);

}  // namespace posewise::detail
