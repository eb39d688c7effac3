#pragma once

#include <string>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

/// What may be stated wrongly, by how else the measurements fit: the end of a message, or empty.
namespace posewise::cli {

/// Planes whose normal looks reversed or, where planes are known, whose offset has the wrong sign:
/// fitted to base and robot as stated, they are there.
std::string suspect_planes(const Campaign& campaign, const Measurements& measured);

/// In which other sense of the orientations the nominal robot misses them by less than `tolerance`
/// (rad, RMS).
std::string suspect_orientations(const Campaign& campaign, const Measurements& measured,
                                 double tolerance);

}  // namespace posewise::cli
