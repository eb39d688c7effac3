#pragma once

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// What a calibration was made from.
struct CalibrationData {
    const Campaign& campaign;  ///< as it was identified, with the model error as stated
    const Chain& robot;        ///< with all errors, those that are held, too
    const Measurements& measurements;
    const Parameters& registered;
    LevenbergMarquardtOptions options{};  ///< of what is fitted beside it
};

/// Puts before the faults of a calibration that converged what its data say against it, see
/// Calibration::faults, with the doubt that it predicts no better than the nominal robot, and tries
/// cures where there are doubts. Groups are those held out; where none were, ten.
void judge_data(const CalibrationData& data, const CalibrationOptions& options,
                Calibration& calibration);

}  // namespace posewise::detail
