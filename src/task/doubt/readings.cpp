#include "calibrator/readings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "calibrator/part_alone.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/task/doubts.hpp"
#include "task/calibration/expected_distance.hpp"

namespace posewise {
namespace {

using detail::FittedReading;

ReadingMisfit misfit_of(const Campaign& campaign, const FittedReading& reading) {
    return {reading.distance_rms, reading.orientation_rms, &campaign.sensor->units(true)};
}

/// Less those that change the same and more.
std::vector<std::string> describe_as_well(const Campaign& campaign,
                                          const std::vector<FittedReading>& readings,
                                          const FittedReading& better,
                                          OrientationNotation notation) {
    std::vector<std::string> words;
    for (const FittedReading& other : readings) {
        if (!fit_alike(other, better) || has_all(other.changes, better.changes)) continue;
        words.push_back(describe(other.changes, campaign, notation));
    }
    return words;
}

}  // namespace

ReadingSearch search_readings(const Campaign& stated, const Measurements& all,
                              const ProgressCallback& progress) {
    // Of several instruments one tells how joints are read, and many take long.
    const detail::PartAlone telling = detail::telling_part(stated, all, stated.nominal);
    const Campaign& campaign = telling.campaign;
    const Measurements& measurements = telling.measured;
    ReadingSearch search;
    search.of = campaign.sensor->words().readings;
    detail::FittedReadings fitted =
        detail::fit_readings(campaign, measurements, detail::most_registered, progress);
    search.undetermined = std::move(fitted.undetermined);
    if (!search.undetermined.empty()) return search;
    const std::vector<FittedReading>& readings = fitted.readings;
    for (const FittedReading& reading : readings) {
        const auto reversed = reversed_joints(reading.changes, campaign);
        search.tried.push_back({describe(reading.changes, campaign, measurements.notation),
                                reversed, std::ssize(reversed) == std::ssize(reading.changes),
                                misfit_of(campaign, reading),
                                fit_alike(reading, readings.front())});
    }
    const FittedReading* const better =
        find_clearly_better(readings, detail::credible_distance(campaign, measurements));
    if (better == nullptr) return search;
    search.better = {describe(better->changes, campaign, measurements.notation),
                     describe_cure(better->changes, campaign),
                     reversed_joints(better->changes, campaign),
                     count_changes(better->changes),
                     describe_as_well(campaign, readings, *better, measurements.notation),
                     misfit_of(campaign, *better),
                     misfit_of(campaign, as_stated(readings))};
    return search;
}

std::string describe(const BetterReading& reading) {
    constexpr std::size_t most = 3;
    std::string others;
    for (std::size_t k = 0; k < std::min(most, reading.as_well.size()); ++k) {
        others += ", or as well with " + reading.as_well[k];
    }
    if (reading.as_well.size() > most) {
        others += fmt::format(" and {} more", reading.as_well.size() - most);
    }
    std::vector<std::string> figures;
    const auto compare = [&](double found, double stated, const char* unit) {
        if (stated == 0) return;  // not measured
        figures.push_back(fmt::format("{} instead of {} {}", detail::format_short(found, 3),
                                      detail::format_short(stated, 3), unit));
    };
    const ReadingMisfit& found = reading.misfit;
    const ReadingMisfit& stated = reading.as_stated;
    compare(mm_per_m * found.distance_rms, mm_per_m * stated.distance_rms, "mm");
    compare(found.orientation_reading(), stated.orientation_reading(),
            stated.orientation_units->reading.data());
    return fmt::format("they fit clearly better with {}{} ({} RMS): {}", reading.words, others,
                       fmt::join(figures, " and "), reading.cure);
}

}  // namespace posewise
