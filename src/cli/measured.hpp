#pragma once

#include <string>

#include "posewise/io/measurements_file.hpp"

/// Measurements, and whether they can be what they are said to be.
namespace posewise::cli {

/// io::read_measurements(). Configurations beyond the joint limits are taken, since they were
/// measured; a warning on standard error says so.
Measurements read_measured(const std::string& path, const io::CampaignFile& file);

/// The nominal robot explains its own measurements to about the error expected of it, another's
/// not: says by how much it misses these, and which unit may be wrong. Empty: it explains them, or
/// they are too few to tell.
std::string describe_misfit(const Campaign& campaign, const Measurements& measured);

/// Throws InputError if there is a misfit.
void check_is_of_robot(const Campaign& campaign, const Measurements& measured,
                       const std::string& path);

}  // namespace posewise::cli
