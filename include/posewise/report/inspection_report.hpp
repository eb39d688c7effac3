#pragma once

#include <string>

#include "posewise/task/inspection.hpp"

namespace posewise {

/// Elements, joints and axes of a robot, as text.
std::string format_robot(const Chain& robot);

/// The robot, and which of its errors can be found: every parameter with its expected error and, if
/// no measurement can tell it from others, the errors that do the same, as text.
std::string format(const Inspection& inspection);

/// Says that there is no clear gap between what is identifiable and what is not, where that is so.
std::string describe_gap(const Inspection& inspection);

}  // namespace posewise
