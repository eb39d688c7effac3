#pragma once

#include "core/names.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise::detail {

inline constexpr Names<CalibrationMethod, 3> method_names{{{CalibrationMethod::Joint, "lm"},
                                                           {CalibrationMethod::TwoStep, "two-step"},
                                                           {CalibrationMethod::Global, "global"}}};

/// Throws InputError for options that contradict each other.
void check_options(const CalibrationOptions& options, Index configuration_count);

/// Calibrates with all, without figures of what was held out, and lets it be judged; nothing where
/// they do not identify the model, or if it is stopped. Says why they do not; else is empty.
std::string judge_measured(const Campaign& campaign, const Measurements& measurements,
                           const JudgeCalibration& judge, const StopSignal& stop);

}  // namespace posewise::detail
