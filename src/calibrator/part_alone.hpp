#pragma once

#include <vector>

#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {

/// One of several instruments alone: the campaign in its own frame, and what it measured.
struct PartAlone {
    Campaign campaign;
    Measurements measured;    ///< configurations that show any of its targets
    Parameters registered{};  ///< what it has of those that are stated as registered
    Index part = 0;           ///< which of several
};

PartAlone take_part(const Campaign& campaign, const CombinedSensor& combined, Index part,
                    const Measurements& measurements, const Parameters& registered);

/// The same of a part that registers without a guess, points or poses rather than a camera; the
/// campaign as it is where it has one instrument, or none of several does.
PartAlone telling_part(const Campaign& campaign, const Measurements& measurements,
                       const Parameters& registered);

/// Every instrument that shows anything; the campaign as it is where it has one.
std::vector<PartAlone> parts_alone(const Campaign& campaign, const Measurements& measurements,
                                   const Parameters& registered);

}  // namespace posewise::detail
