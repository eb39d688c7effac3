#pragma once

#include <optional>

#include "calibrate_options.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::cli {

/// Measurements to validate with, --validate, and their campaign, --validate-campaign, both of
/// which the calibration's options refer to.
struct Validation {
    std::optional<io::CampaignFile> campaign;
    std::optional<Measurements> measured;
    bool is_joined = false;  ///< from points and a plan
};
/// `file`: the campaign to calibrate with; `points`: for a list of points.
Validation read_validation(const CalibrateArguments& arguments, const io::CampaignFile& file,
                           const io::PointsSource& points);

/// Warns of measurements that went into the estimate, or into the one that it builds on.
void warn_of_no_validation(const CalibrateArguments& arguments, const Validation& validation,
                           const io::Provenance& made_from);

/// Calibrates with a plan's poses only (--plan), and judges on those that it has to verify.
void use_plan(const std::string& path, const Plan& plan, const Campaign& campaign,
              const io::MeasurementsFile& measured, CalibrationOptions& options);

/// Throws InputError for a limit where nothing is judged, or that is no length.
void check_limit(const CalibrateArguments& arguments, const Campaign& campaign,
                 const Measurements& measured, const CalibrationOptions& options);

}  // namespace posewise::cli
