#pragma once

#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::detail {

/// What EarlierUse::only leaves as it was.
struct KnownParameters {
    bool base = false;
    bool targets = false;
    std::vector<bool> robot;  ///< of its errors
};

/// Throws InputError for a name that is none, and where nothing would be left to identify.
KnownParameters known_parameters(const Campaign& campaign, const std::vector<std::string>& only);

/// Throws InputError where the campaign states a base as known and the estimate has another, unless
/// it was moved since.
void check_known_base(const Campaign& campaign, const Earlier& earlier);

/// The campaign with these values of what is known, less what is.
Campaign with_known(const Campaign& campaign, const KnownParameters& known,
                    const Parameters& values);

/// Parameters of such a campaign as those of the whole.
Parameters complete(const KnownParameters& known, const Parameters& values,
                    const Parameters& found);

/// An estimate of such a campaign, `reduced`, as one of the whole: what was known has its earlier
/// value and covariance, and what was `found` by these measurements follows its errors.
Estimate complete(const Campaign& campaign, const Estimate& earlier, const KnownParameters& known,
                  const Campaign& reduced, const Measurements& measured, const Estimate& found);

}  // namespace posewise::detail
