#pragma once

#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/task/plan.hpp"

namespace posewise::detail {

/// The CSV of io::write_configurations_csv(); verification poses come last.
std::string configurations_text(const Campaign& campaign, const std::vector<PlannedPose>& poses,
                                const std::vector<PlannedPose>& verification = {});

}  // namespace posewise::detail
