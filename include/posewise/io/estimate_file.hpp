#pragma once

#include <optional>
#include <string>

#include "posewise/calibrator/identification.hpp"

namespace posewise::io {

/// What `calibrate` reports beside the estimate itself.
struct CalibrationReport {
    std::string method;        ///< "lm" or "two-step"
    std::string measurements;  ///< path they came from
    Estimate estimate;
    Metrics nominal;                      ///< base and targets fitted only, all samples
    std::optional<double> repeatability;  ///< m
    std::optional<CrossValidation> held_out;
    std::optional<Metrics> validation;  ///< on a separate file
};

/// Writes the report as JSON, SI units in the names, 17 digits.
void write_estimate(const std::string& path, const Campaign& campaign,
                    const CalibrationReport& report);

}  // namespace posewise::io
