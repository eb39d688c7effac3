#pragma once

#include <string>

#include "posewise/io/estimate_file.hpp"

namespace posewise::cli {

void print_model_selection(const ModelSelection& selection);

/// What was identified from `used`, how accurate it is, and in words what looks wrong with it.
void print_calibration(const Campaign& campaign, const Measurements& used,
                       const io::CalibrationReport& report);

/// Warnings on standard error: a nominal robot far from what was measured (another robot's? planes
/// or orientations read in another sense?), errors far above their expected size.
void warn_about_calibration(const std::string& measurements_path, const Campaign& campaign,
                            const Measurements& used, const io::CalibrationReport& report);

}  // namespace posewise::cli
