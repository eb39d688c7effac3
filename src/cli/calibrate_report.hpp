#pragma once

#include "calibrate_options.hpp"
#include "page.hpp"
#include "posewise/io/result_files.hpp"

/// What calibrate says of a calibration.
namespace posewise::cli {

/// Refers to the result and to what it was made from.
Printed describe_calibration(const CalibrateArguments& arguments, const Calibration& result,
                             const io::Provenance& made_from);

/// What a page shows of an estimate beside its document: the robot calibrated, where it was
/// measured, and its errors over the workspace.
io::PagePart show_estimate(const Campaign& campaign, const Estimate& estimate,
                           const Measurements* measurements);

/// The page, with this part, and the plot of one that was made with some of these measurements, as
/// the options say, if there are paths for them.
void show_calibration(const CalibrateArguments& arguments, const CommonOptions& common,
                      const Calibration& result, const Measurements& measured,
                      const CalibrationOptions& options, io::PagePart part, const Printed& printed);

}  // namespace posewise::cli
