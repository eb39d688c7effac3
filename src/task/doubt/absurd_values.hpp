#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"

namespace posewise::detail {

/// Residuals in units of those stated, of lengths or of angles, whichever are larger; where they
/// are beyond the model error that was found, too, that counts.
double times_stated(const Campaign& stated, const Estimate& estimate);

/// What no calibration has, whatever is expected of the robot, added to `faults` in words: a model
/// error beyond 100 mm or 100 mrad, a base more than 1 km from the instrument and from where it is
/// stated, a target more than 10 m from the flange or within 1 mm of another, a variance that
/// rounding alone exceeds. Estimates of files may have been written by hand.
void add_absurd_values(const Campaign& campaign, const Estimate& estimate,
                       std::vector<std::string>& faults);

}  // namespace posewise::detail
