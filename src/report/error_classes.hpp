#pragma once

#include "posewise/calibrator/estimate.hpp"
#include "table.hpp"

/// The robot's errors by class: lengths, angles of axes, joint offsets, ...
namespace posewise::detail {

/// How many each class has and their expected size, mm or mrad.
Table expected_class_table(const Campaign& campaign);

/// The same with what they are: RMS, the largest and which that is.
Table class_table(const Campaign& campaign, const Estimate& estimate);

}  // namespace posewise::detail
