#pragma once

#include "posewise/task/calibration.hpp"
#include "table.hpp"

/// The robot's errors by class: lengths, angles of axes, joint offsets, ...
namespace posewise::detail {

/// How many each class has and their expected size, mm, mrad or per mille.
Table expected_class_table(const Campaign& campaign);

/// The same with the size that was learned, if it was, and with what they are: RMS, the largest and
/// which that is.
Table class_table(const Calibration& calibration);

}  // namespace posewise::detail
