#pragma once

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// Base pose and the sensor's unknowns with no initial guess, the robot at nominal. For points,
/// with X = R_base^T and c = -R_base^T p_base, the equations X p_ij + c - R_i t_j = p_i are linear
/// in (X, c, t): least squares, X projected on SO(3), then polished on the true residuals. A pose
/// is four points. Lengths, and a base that is partly known, are polished from the campaign's
/// nominal values instead. Throws InputError if a target with unknown position is seen in no
/// sample, if the configurations do not determine base and targets, or if nominal values are needed
/// and not stated.
Parameters register_base_and_targets(const Campaign& campaign, const Measurements& measurements);

/// The same without the polish.
Parameters register_roughly(const Campaign& campaign, const Measurements& measurements);

}  // namespace posewise
