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

/// "0.61 mm", of sensors of angles alone "0.02 deg".
std::string format_misfit(const Campaign& campaign, const ReadingMisfit& misfit) {
    return campaign.sensor->has_lengths() ? format_mm(misfit.distance_rms) + " mm"
                                          : format_short(misfit.orientation_reading(), 3) + ' ' +
                                                std::string(misfit.orientation_units->reading);
}

std::string describe_stated(const Campaign& campaign, const ReadingSearch& search) {
    const auto& tried = search.tried;
    const auto alike = std::ranges::count_if(tried, [](const TriedReading& reading) {
        return reading.is_of_directions && reading.is_as_good_as_best;
    });
    const std::string others =
        alike == 1 ? "" : fmt::format(" ({} choices fit alike, by the robot's symmetry)", alike);
    const auto other = std::ranges::find_if_not(tried, &TriedReading::is_as_good_as_best);
    const std::string otherwise =
        other == tried.end()
            ? ""
            : fmt::format(", otherwise by {} at least", format_misfit(campaign, other->misfit));
    return fmt::format(
        "joint directions: as stated{}; the registered robot misses the {} by {} (RMS of the "
        "means of up to 60 configurations; calibrate's nominal is of all samples){}\n",
        others, campaign.sensor->words().readings,
        format_misfit(campaign, as_stated(search).misfit), otherwise);
}

Table list_best(const Campaign& campaign, const ReadingSearch& search) {
    constexpr std::size_t shown = 5;
    const bool has_angles = campaign.sensor->has_angles();
    Table table{{"read with", "RMS/mm"}, {}};
    if (has_angles)
        table.header.push_back("RMS/" + std::string(campaign.sensor->units(true).reading));
    for (std::size_t k = 0; k < std::min(shown, search.tried.size()); ++k) {
        const TriedReading& reading = search.tried[k];
        table.rows.push_back({reading.words, format_mm(reading.misfit.distance_rms)});
        if (!has_angles) continue;
        table.rows.back().push_back(format_short(reading.misfit.orientation_reading(), 3));
    }
    return table;
}

}  // namespace

std::string describe_readings(const Campaign& campaign, const ReadingSearch& search) {
    const TriedReading& stated = as_stated(search);
    if (!search.better && stated.is_as_good_as_best) return describe_stated(campaign, search);
    return format_section("Readings that fit best", list_best(campaign, search)) +
           fmt::format("as stated: {}\n", format_misfit(campaign, stated.misfit)) +
           (search.better ? describe(*search.better) + '\n'
                          : "no other reading fits clearly better than all others; is the nominal "
                            "robot right (zero positions, lengths, units)?\n");
}

}  // namespace posewise::detail
