#pragma once

#include <string>

#include "posewise/io/measurements_file.hpp"

namespace posewise::cli {

/// io::read_measurements(). Configurations beyond the joint limits are taken, since they were
/// measured; a warning on standard error says so.
Measurements read_measured(const std::string& path, const io::CampaignFile& file);

/// Throws InputError, which names the file, if another robot's measurements are in it.
void check_is_of_robot(const Campaign& campaign, const Measurements& measured,
                       const std::string& path);

}  // namespace posewise::cli
