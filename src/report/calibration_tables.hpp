#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posewise/task/calibration.hpp"
#include "table.hpp"

namespace posewise::detail {

/// Metrics side by side in mm, one named column each: distance RMS, maximum, mean and 95 %, then
/// RMS and maximum of x, y and z. A column without points shows "-".
Table metrics_table(const std::vector<std::pair<std::string, Metrics>>& columns);
/// Of several instruments each, in its own unit.
Table sensor_table(const std::vector<SensorAccuracy>& sensors);

/// Every parameter with its value: errors of the robot in mm and mrad, targets in mm, the base's
/// position in mm and its turn as the rotation vector in degrees.
Table value_table(const Campaign& campaign, const Parameters& parameters);
/// The same of an estimate, with standard deviations.
Table parameter_table(const Campaign& campaign, const Estimate& estimate);

/// Base and targets that the validation was judged with, refitted to it. No rows if nothing was.
Table refitted_table(const Calibration& calibration);

/// Beside the standard deviations those without the uncertainty of what is held, as `plan --only`
/// counts; "-" for what is held. Nothing where nothing is.
void add_sigmas_beside_held(const Calibration& calibration, Table& parameters);

/// The compliance of each joint that has one, in urad/(N m) (um/N), with its standard deviation and
/// the largest torque, at which the parameter is what gives way. No rows if there is none.
Table compliance_table(const Campaign& campaign, const Estimate& estimate);

/// The `count` strongest correlations between two parameters, by name.
Table correlation_table(const Estimate& estimate, Index count);

/// The `count` outliers that are farthest off, farthest first.
Table outlier_table(const Campaign& campaign, const Estimate& estimate, Index count);
/// Where sockets at a known distance are, of which the parameters are tilts; empty if there are
/// none.
Table socket_table(const Campaign& campaign, const Estimate& estimate);

/// Each parameter set with its errors in mm; the best and the recommended are marked.
Table model_table(const ModelSelection& selection);

}  // namespace posewise::detail
