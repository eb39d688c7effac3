#pragma once

#include <string>
#include <vector>

#include "../calibrator/joint_signs.hpp"

namespace posewise::detail {

/// Says whether joints are reversed, and which; `patterns` are those of fit_joint_signs(), `advice`
/// says how to reverse them in the campaign.
std::string describe_joint_directions(const Campaign& campaign,
                                      const std::vector<SignPattern>& patterns,
                                      const std::string& advice);

}  // namespace posewise::detail
