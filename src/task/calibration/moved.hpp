#pragma once

#include "posewise/task/calibration.hpp"

/// Base and targets that are not where they were.
namespace posewise::detail {

/// How base and targets are identified anew.
struct Refitting {
    LevenbergMarquardtOptions options;
    /// Of another campaign the estimate has no covariance that tells of all its parameters.
    bool is_of_other_campaign = false;
};

/// The estimate with these parts of it identified anew by others' measurements.
Estimate refit_parts(const Refitting& refitting, const Campaign& campaign, const Estimate& before,
                     const Measurements& others, const std::vector<std::string>& parts);

/// Nothing unless others are off by far more than the estimate expects there, and fit with base,
/// targets or both identified anew: as few as it takes to be as expected, else both.
std::optional<Moved> find_moved(const Refitting& refitting, const Campaign& campaign,
                                const Estimate& before, const Measurements& others);

}  // namespace posewise::detail
