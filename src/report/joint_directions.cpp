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
    const std::vector<std::string> names = reversed_joints(robot, pattern);
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string describe_joint_directions(const Campaign& campaign,
                                      const std::vector<SignPattern>& patterns,
                                      const std::string& advice) {
    constexpr std::size_t shown = 5;
    const Chain& robot = campaign.robot;
    const Index alike = alike_count(patterns);
    const SignPattern& best = patterns.front();
    const SignPattern& stated = as_stated(patterns);
    const std::string others =
        alike == 1 ? "" : fmt::format(" ({} choices fit alike, by the robot's symmetry)", alike);
    if (&best == &stated) {
        const std::string otherwise =
            alike == std::ssize(patterns)
                ? ""
                : fmt::format(", otherwise by {} mm at least",
                              format_mm(patterns[static_cast<std::size_t>(alike)].distance_rms));
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
    return format_section("Joint directions that fit best", table) +
           fmt::format("as stated: {} mm\n", format_mm(stated.distance_rms)) +
           (has_clear_reversal(patterns)
                ? fmt::format("joint directions: reversed are {}{}; {}\n",
                              name_reversed(robot, best), others, advice)
                : "joint directions: none fits clearly better than all others; is the "
                  "nominal robot right (zero positions, lengths, units)?\n");
}

}  // namespace posewise::detail
