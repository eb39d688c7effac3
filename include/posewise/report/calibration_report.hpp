#pragma once

#include <string>
#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise {

/// What was identified, how accurate the robot is with it and how sure each parameter is, as text:
/// all that `posewise calibrate` prints. Of a calibration that is not identified, why.
std::string format(const Calibration& calibration);

/// Parameter sets side by side, and which is recommended.
std::string format(const ModelSelection& selection);

/// One sentence each: what looks wrong with the measurements, which `measurements` names if it is
/// not empty, or with the errors found. What format() says already is not repeated.
std::vector<std::string> describe_doubts(const Calibration& calibration,
                                         const std::string& measurements = "");

/// "2 of 24 measured configurations are beyond ..."
std::string describe(const BeyondLimits& beyond, const Measurements& measurements);

}  // namespace posewise
