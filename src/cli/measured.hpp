#pragma once

#include <string>

#include "posewise/io/measurements_file.hpp"

namespace posewise::cli {

/// io::read_measurements(). Configurations beyond the joint limits are taken, since they were
/// measured; a warning on standard error says so.
Measurements read_measured(const std::string& path, const io::CampaignFile& file);

}  // namespace posewise::cli
