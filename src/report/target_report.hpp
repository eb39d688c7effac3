#pragma once

#include <string>

#include "posewise/task/planning.hpp"

/// Lines of a plan's report, empty where there is nothing to say.
namespace posewise::detail {

/// "RMS"
const char* name_of(ErrorQuantity quantity);

/// How long measuring takes, if the robot stands still for its samples.
std::string describe_duration(const Planning& planning);

/// What the poses that hurt most cost if they are missing.
std::string describe_drop_outs(const Planning& planning);

}  // namespace posewise::detail
