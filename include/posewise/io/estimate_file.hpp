#pragma once

#include <optional>
#include <string>

#include "posewise/calibrator/model_selection.hpp"

namespace posewise::io {

/// Distance RMS of the means that are no outliers, m.
struct WithoutOutliers {
    double fit_rms = 0;
    std::optional<double> held_out_rms;
};

/// What `calibrate` reports beside the estimate itself.
struct CalibrationReport {
    std::string method;        ///< "lm", "two-step" or "global"
    std::string measurements;  ///< path they came from
    Estimate estimate;
    Metrics nominal;  ///< base and targets fitted only, all samples
    std::optional<Repeatability> repeatability;
    std::optional<CrossValidation> held_out;
    std::optional<Metrics> left_out;    ///< on the measured configurations not in the plan
    std::optional<Metrics> validation;  ///< on a separate file
    std::optional<WithoutOutliers> without_outliers;  ///< if there are some
    std::optional<ModelSelection> selection;
};

/// Writes the report as JSON, units in the names (accuracy in mm, all else in m and rad), numbers
/// with as many digits as it takes to read them back exactly. Same input, same bytes.
void write_estimate(const std::string& path, const Campaign& campaign,
                    const CalibrationReport& report);

/// The identified parameters that such a file holds, exactly as they were. Throws InputError with
/// the place if it is none, or not one of this campaign's parameters.
Parameters read_estimate(const std::string& path, const Campaign& campaign);

}  // namespace posewise::io
