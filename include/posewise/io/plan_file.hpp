#pragma once

#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/selection/plan.hpp"

namespace posewise::io {

/// Writes a plan as JSON: version, campaign, criterion, value, bound, efficiency, how it was made
/// (seed, starts, stop reason), what it assumes (noise, scales), and the poses: id, joints in rad
/// or m. `source` names the file of the candidates. A bound that is not known is null.
void write_plan(const std::string& path, const Plan& plan, const Campaign& campaign,
                const Measurements& candidates, const std::string& source);

/// The ids of the poses of a plan file, in order. Throws InputError for a file that is not a plan.
std::vector<std::string> read_plan_ids(const std::string& path);

}  // namespace posewise::io
