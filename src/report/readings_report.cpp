#include "readings_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/format.hpp"
#include "posewise/core/types.hpp"
#include "sentences.hpp"
#include "table.hpp"

namespace posewise::detail {
namespace {

const TriedReading& as_stated(const ReadingSearch& search) {
    return *std::ranges::find_if(search.tried, [](const TriedReading& reading) {
        return reading.is_of_directions && reading.reversed.empty();
    });
}

bool has_lengths(const ReadingMisfit& misfit) {
    return misfit.distance_rms > 0 || misfit.orientation_rms == 0;
}

/// "0.61 mm", where no length is measured "0.02 deg" or "0.4 px".
std::string format_misfit(const ReadingMisfit& misfit) {
    return has_lengths(misfit) ? format_mm(misfit.distance_rms) + " mm"
                               : format_short(misfit.orientation_reading(), 3) + ' ' +
                                     std::string(misfit.orientation_units->reading);
}

/// Whether none fits so much better that another than it could be meant: those that only turn
/// a symmetric robot, or the image with its camera, differ by how well each was registered.
bool fits_about_best(const ReadingSearch& search, const TriedReading& reading) {
    constexpr double about = 1.5;
    return reading.misfit.size() <= about * search.tried.front().misfit.size();
}

std::string describe_stated(const ReadingSearch& search) {
    const auto& tried = search.tried;
    const auto alike = std::ranges::count_if(tried, [](const TriedReading& reading) {
        return reading.is_of_directions && reading.is_as_good_as_best;
    });
    const std::string others =
        alike <= 1 ? "" : fmt::format(" ({} choices fit alike, by the robot's symmetry)", alike);
    const auto other = std::ranges::find_if_not(
        tried, [&](const TriedReading& reading) { return fits_about_best(search, reading); });
    const std::string otherwise = other == tried.end() ? ""
                                                       : fmt::format(", otherwise by {} at least",
                                                                     format_misfit(other->misfit));
    return fmt::format(
        "joint directions: as stated{}; the registered robot misses the {} by {} (RMS of the "
        "means of up to 60 configurations; calibrate's nominal is of all samples){}\n",
        others, search.of, format_misfit(as_stated(search).misfit), otherwise);
}

Table list_best(const ReadingSearch& search) {
    constexpr std::size_t shown = 5;
    const ReadingMisfit& stated = as_stated(search).misfit;
    Table table{{"read with"}, {}};
    if (has_lengths(stated)) table.header.emplace_back("RMS/mm");
    if (stated.orientation_rms > 0) {
        table.header.push_back("RMS/" + std::string(stated.orientation_units->reading));
    }
    for (std::size_t k = 0; k < std::min(shown, search.tried.size()); ++k) {
        const TriedReading& reading = search.tried[k];
        table.rows.push_back({reading.words});
        if (has_lengths(stated))
            table.rows.back().push_back(format_mm(reading.misfit.distance_rms));
        if (stated.orientation_rms == 0) continue;
        table.rows.back().push_back(format_short(reading.misfit.orientation_reading(), 3));
    }
    return table;
}

}  // namespace

std::string describe_readings(const ReadingSearch& search) {
    const TriedReading& stated = as_stated(search);
    if (!search.better && fits_about_best(search, stated)) return describe_stated(search);
    return format_section("Readings that fit best", list_best(search)) +
           fmt::format("as stated: {}\n", format_misfit(stated.misfit)) +
           (search.better ? describe(*search.better) + '\n'
                          : "no other reading fits clearly better than all others; is the nominal "
                            "robot right (zero positions, lengths, units)?\n");
}

}  // namespace posewise::detail
