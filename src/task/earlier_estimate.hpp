#pragma once

#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// Which of the robot's errors CalibrationOptions::only leaves as in the earlier estimate. Throws
/// InputError for a name that is none, and where base or sensor would be left.
std::vector<bool> known_errors(const Campaign& campaign, const std::vector<std::string>& only);

/// The campaign less the errors that are known, with the earlier estimate's values of them and its
/// model error, and the prior that it gives of the others, where it is one.
Campaign with_earlier(const Campaign& campaign, const Earlier& earlier,
                      const std::vector<bool>& is_known);

/// The values of those that are not known.
VectorXd open_values(const VectorXd& values, const std::vector<bool>& is_known);

/// An estimate of such a campaign as one of the whole: what was known has its earlier value and
/// covariance.
Estimate complete(const Campaign& campaign, const Estimate& earlier,
                  const std::vector<bool>& is_known, const Estimate& found);

}  // namespace posewise::detail
