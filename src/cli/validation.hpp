#pragma once

#include <optional>

#include "calibrate_options.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/estimate_file.hpp"

namespace posewise::cli {

/// Measurements to validate with, --validate, and their campaign, --validate-campaign, both of
/// which the calibration's options refer to.
struct Validation {
    std::optional<io::CampaignFile> campaign;
    std::optional<Measurements> measured;
};
/// `file`: the campaign to calibrate with.
Validation read_validation(const CalibrateArguments& arguments, const io::CampaignFile& file);

/// Warns of measurements that went into the estimate, or into the one that it builds on.
void warn_of_no_validation(const CalibrateArguments& arguments, const Validation& validation,
                           const io::Provenance& made_from);

}  // namespace posewise::cli
