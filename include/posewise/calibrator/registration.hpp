#pragma once

#include <string>

#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// Base and targets, the robot as expected (its errors as Campaign::nominal has them: zero, unless
/// with_earlier() says otherwise).
struct Registration {
    Parameters parameters;
    /// Why the measurements do not determine them, as a sentence; empty: they do.
    std::string undetermined;

    bool is_determined() const { return undetermined.empty(); }
};

/// Base pose and the sensor's unknowns with no initial guess, the robot as expected. For points,
/// with X = R_base^T and c = -R_base^T p_base, the equations X p_ij + c - R_i t_j = p_i are linear
/// in (X, c, t): least squares, X projected on SO(3), then polished on the true residuals. Where
/// they leave a part of X open (points that lie in planes, axes that cross) X is searched among the
/// rotations. A pose is four points. Lengths, and a base that is partly known, are polished from
/// the campaign's nominal values instead. What
/// few configurations leave open is where an earlier estimate that is the prior found it. Not
/// determined where a target with unknown position is
/// seen in no sample, or by configurations that are too few or too much alike. Throws InputError if
/// nominal values are needed and not stated, or for measurements that do not fit the campaign.
Registration register_base_and_targets(const Campaign& campaign, const Measurements& measurements);

/// The same without the polish.
Registration register_roughly(const Campaign& campaign, const Measurements& measurements);

/// Smallest number of generic configurations that a calibration can do with: they identify what can
/// be identified (least_pose_count()) and, where no nominal values are needed for it, determine
/// base and targets, or what an earlier estimate that is the prior leaves open of them. No fewer
/// than Campaign::fitted_pose_count, unless there is such an estimate.
Index least_calibration_count(const Campaign& campaign, const StopSignal& stop = {});

/// The parameters, for those to whom measurements that do not determine them are no input: throws
/// InputError with the reason.
Parameters determined(Registration registration);

}  // namespace posewise
