#pragma once

#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// Of each instrument of a CombinedSensor what it is missed by, from rows as residuals() has them
/// (`held_out` may have none); empty for another sensor.
std::vector<SensorAccuracy> accuracy_by_sensor(const Sensor& sensor, const Seen& is_seen,
                                               const RowMatrixXd& nominal, const RowMatrixXd& fit,
                                               const RowMatrixXd& held_out);

}  // namespace posewise::detail
