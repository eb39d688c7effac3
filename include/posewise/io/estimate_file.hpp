#pragma once

#include <string>
#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::io {

/// Writes a calibration as JSON, units in the names (accuracy in mm, all else in m and rad),
/// numbers with as many digits as it takes to read them back exactly. `measurements` says where
/// they came from, a path. Same input, same bytes. The calibration must be identified.
void write_estimate(const std::string& path, const Calibration& calibration,
                    const std::string& measurements);

/// Writes CSV, a row a configuration: config, then parameters, left_over, noise, total (RMS) and
/// p95 (95 % of points are off by less), each with _mm, of orientations with _mrad. `ids` are those
/// of the configurations predicted.
void write_predictions_csv(const std::string& path, const std::vector<std::string>& ids,
                           const std::vector<ErrorPrediction>& predictions);

/// What such a file holds, exactly as it was: parameters, names, covariance, ending, variance
/// factor, degrees of freedom, model errors. Throws InputError with the place if it is none, if it
/// is of another robot than the campaign's (see designs/README.md) or of another kind of sensor.
/// Whether it can be used is for find_faults() to say.
Estimate read_estimate(const std::string& path, const Campaign& campaign);

}  // namespace posewise::io
