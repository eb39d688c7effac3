#include "joint_directions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "../core/format.hpp"
#include "sentences.hpp"
#include "table.hpp"

namespace posewise::detail {
namespace {

std::string name_reversed(const Chain& robot, const SignPattern& pattern) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < pattern.is_reversed.size(); ++j) {
        if (pattern.is_reversed[j]) names.push_back(robot.joints()[j].name);
    }
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// Fits alike: a symmetric robot's patterns differ by rounding only.
bool fits_as(const SignPattern& a, const SignPattern& b) {
    return a.distance_rms <= 1.001 * b.distance_rms;
}

}  // namespace

std::string describe_joint_directions(const Campaign& campaign,
                                      const std::vector<SignPattern>& patterns,
                                      const std::string& advice) {
    constexpr std::size_t shown = 5;
    const Chain& robot = campaign.robot;
    const auto reversed_count = [](const SignPattern& pattern) {
        return std::count(pattern.is_reversed.begin(), pattern.is_reversed.end(), true);
    };
    const auto alike_end = std::find_if(patterns.begin(), patterns.end(), [&](const auto& pattern) {
        return !fits_as(pattern, patterns[0]);
    });
    const SignPattern& best = *std::min_element(
        patterns.begin(), alike_end,
        [&](const auto& a, const auto& b) { return reversed_count(a) < reversed_count(b); });
    const SignPattern& stated =
        *std::find_if(patterns.begin(), patterns.end(),
                      [&](const auto& pattern) { return reversed_count(pattern) == 0; });
    const std::string others = alike_end - patterns.begin() == 1
                                   ? ""
                                   : fmt::format(" ({} choices fit alike, by the robot's symmetry)",
                                                 alike_end - patterns.begin());
    if (&best == &stated) {
        const std::string otherwise =
            alike_end == patterns.end()
                ? ""
                : fmt::format(", otherwise by {} mm at least", format_mm(alike_end->distance_rms));
        return fmt::format(
            "joint directions: as stated{}; the registered robot misses the {} by {} mm (RMS of "
            "the "
            "means of up to 60 configurations; calibrate's nominal is of all samples){}\n",
            others, campaign.sensor->words().readings, format_mm(stated.distance_rms), otherwise);
    }
    Table table{{"reversed joints", "RMS/mm"}, {}};
    for (std::size_t k = 0; k < std::min(shown, patterns.size()); ++k) {
        table.rows.push_back(
            {name_reversed(robot, patterns[k]), format_mm(patterns[k].distance_rms)});
    }
    const bool is_clear = best.distance_rms < 0.5 * stated.distance_rms;
    return format_section("Joint directions that fit best", table) +
           fmt::format("as stated: {} mm\n", format_mm(stated.distance_rms)) +
           (is_clear ? fmt::format("joint directions: reversed are {}{}; {}\n",
                                   name_reversed(robot, best), others, advice)
                     : "joint directions: none fits clearly better than those stated; is the "
                       "nominal robot right (zero positions, lengths, units)?\n");
}

}  // namespace posewise::detail
