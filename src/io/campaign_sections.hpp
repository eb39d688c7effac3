#pragma once

#include <memory>

#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/point_sensor.hpp"
#include "yaml_reader.hpp"

/// The sections of a campaign file, one function each.
namespace posewise::io {

struct RobotSection {
    Chain declared;
    ErrorModel error_model = ErrorModel::Stated;
};
RobotSection read_robot(const YamlValue& robot);

struct SensorSection {
    std::shared_ptr<const PointSensor> sensor;
    VectorXd unknowns;  ///< nominal target positions, those that are not known; m
    bool has_positions = false;
};
SensorSection read_sensor(const YamlValue& sensor);

/// A measure that must be positive, or with `zero_allowed` not negative; m or rad.
double read_positive(const YamlMeasure& measure, bool zero_allowed = false);

}  // namespace posewise::io
