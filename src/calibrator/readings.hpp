#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "reading_change.hpp"

namespace posewise::detail {

/// How well the nominal robot fits measurements that are read in some way.
struct FittedReading {
    ReadingChanges changes;
    double distance_rms = 0;     ///< of the means, base and targets registered, m; 0: no lengths
    double orientation_rms = 0;  ///< of the angles that are left, rad; 0: not measured
    double median = 0;           ///< of the distances (m), of angles (rad) where there are none
    double misfit = 0;           ///< distances and orientations in one: hypot(m, rad * 1 m)
};

struct FittedReadings {
    /// The best fitting first, of those that fit alike the one with the fewest changes.
    std::vector<FittedReading> readings;
    /// Why the measurements cannot be registered at all, as Registration has it; then there are no
    /// readings.
    std::string undetermined;
};

/// This many configurations are enough to tell one reading from another.
constexpr Index most_registered = 60;

/// All readings that all_readings() lists, but degrees read as rad where no joint is beyond a turn
/// (mm as m: 20 m). Those of a symmetric robot may fit exactly alike. Each
/// is registered from nothing, what is stated and the best 63 others with polish, but those that
/// are so far off that no polish brings them near the best, with at most `most_configurations`
/// configurations evenly taken from the measurements (all if those do not show every target).
/// Throws InputError as register_base_and_targets() does.
FittedReadings fit_readings(const Campaign& campaign, const Measurements& measurements,
                            Index most_configurations = most_registered,
                            const ProgressCallback& progress = {});

/// Whether two fit as well as each other: a symmetric robot's differ by rounding only.
bool fit_alike(const FittedReading& reading, const FittedReading& other);

/// The one without changes.
const FittedReading& as_stated(const std::vector<FittedReading>& readings);

/// The simplest of those that fit far better than what is stated, and by less than `credible` in
/// the median; nullptr where none does, or where others as simple fit nearly as well.
const FittedReading* find_clearly_better(const std::vector<FittedReading>& readings,
                                         double credible);

}  // namespace posewise::detail
