#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

/// How else measurements may have been meant: joints reversed, exchanged, coupled to a neighbour,
/// in another unit or from another zero, lengths in another unit, a left-handed instrument,
/// orientations in another sense. Each is tried by fitting base and targets of the nominal robot.
namespace posewise {

/// By how much the nominal robot misses the means, base and targets fitted: RMS.
struct ReadingMisfit {
    double distance_rms = 0;     ///< m; 0: no length is measured
    double orientation_rms = 0;  ///< of angles, rad; 0: none is measured
};

/// A way to read measurements, and how well they fit then.
struct TriedReading {
    std::string words;                  ///< "q2, q6 reversed"; "as stated"
    std::vector<std::string> reversed;  ///< joints
    bool is_of_directions = true;       ///< nothing else is changed
    ReadingMisfit misfit;
    /// Whether it fits as well as the first in the list, as of a symmetric robot.
    bool is_as_good_as_best = false;
};

/// A reading in which the measurements fit clearly better than as stated.
struct BetterReading {
    std::string words;                  ///< "j3 - j2 in place of j3"
    std::string cure;                   ///< "write j3 - j2 into the column j3"
    std::vector<std::string> reversed;  ///< joints
    Index change_count = 1;
    std::vector<std::string> as_well;  ///< in words, others that fit exactly as well
    ReadingMisfit misfit;
    ReadingMisfit as_stated;
};

struct ReadingSearch {
    std::vector<TriedReading> tried;  ///< the best fitting first
    std::optional<BetterReading> better;
    /// Why base and targets cannot be registered, as Registration has it; then none was tried.
    std::string undetermined;
};

/// Tries all readings, with 60 configurations evenly taken. A better one misses by less than half
/// of what is missed as stated, half of the points by less than ten expected errors of the robot,
/// and there must be no other as simple that fits nearly as well. Throws InputError as
/// register_base_and_targets() does.
ReadingSearch search_readings(const Campaign& campaign, const Measurements& measurements);

/// "they fit clearly better with q2 reversed (1.97 instead of 666 mm RMS): write ...", for
/// messages.
std::string describe(const BetterReading& reading);

}  // namespace posewise
