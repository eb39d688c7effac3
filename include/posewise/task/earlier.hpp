#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"

namespace posewise {

/// By how much a robot's errors may have changed since it was calibrated, standard deviations.
struct Drift {
    double length = 2e-5;  ///< m
    double offset = 1e-4;  ///< of joints that turn, rad
    double angle = 2e-5;   ///< all others, rad
};

/// How an earlier estimate is used.
struct EarlierUse {
    bool is_prior = false;  ///< its covariance, and drift of the robot's errors, are the prior
    Drift drift{};
    bool has_new_base = false;     ///< moved since: it tells nothing of the base
    bool has_new_targets = false;  ///< or of the targets (the sensor's unknowns)
    /// What is still to be identified: "base" and "targets" (the sensor's unknowns), "robot" or
    /// names of its errors; the others are known to be as they were. Empty: all.
    std::vector<std::string> only{};
};

/// An earlier estimate of the same robot.
struct Earlier {
    Estimate estimate;  ///< names as those of the campaign
    EarlierUse use{};
    std::optional<ParameterSpread> spread{};  ///< where sizes of errors were learned along: theirs
};

/// The campaign as an earlier estimate of it says it is: base, targets and the robot's errors are
/// expected where it found them, but for what was moved since, which is as the campaign states it;
/// the model error and the sizes of errors are as found; what shall not be identified is no
/// parameter any more. Where the estimate is a prior, so it is. To select and plan for, to study
/// and to identify with. Throws InputError for names in EarlierUse::only that are none, where they
/// leave nothing to identify, for an estimate of other parameters, and where it has a base that the
/// campaign states as known elsewhere, unless that was moved.
Campaign with_earlier(const Campaign& campaign, const Earlier& earlier);

/// The values of a robot's errors for the same robot with other loads: what gives way under a
/// torque is in proportion to the largest that occurs. Throws InputError for a robot with other
/// errors.
VectorXd errors_under_loads(const Chain& robot, const VectorXd& errors, const Chain& loaded);

}  // namespace posewise
