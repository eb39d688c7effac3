#pragma once

#include <string>

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// What a calibration does at poses that it was not made with, a line each group of them: RMS with
/// its interval, whether it keeps the limit, whether it is as expected. Empty if there are none.
std::string describe_judgements(const Calibration& calibration);

}  // namespace posewise::detail
