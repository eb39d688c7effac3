#pragma once

#include <string>

#include "posewise/task/planning.hpp"

/// Lines of a plan's report, empty where there is nothing to say.
namespace posewise::detail {

/// "RMS"
const char* name_of(ErrorQuantity quantity);

/// ", if the robot has no errors but those that are fitted" where those that are left out
/// matter, so that a limit that is kept may not be; else empty.
std::string condition_of_limit(const TargetPlanning& found);

/// How long measuring takes, if the robot stands still for its samples.
std::string describe_duration(const Planning& planning);

/// What the poses that hurt most cost if they are missing.
std::string describe_drop_outs(const Planning& planning);

}  // namespace posewise::detail
