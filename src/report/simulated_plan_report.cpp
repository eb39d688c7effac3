#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "table.hpp"
#include "target_report.hpp"

namespace posewise {
namespace {

using detail::format_short;

std::string format_doubt(const SimulatedNumber& number) {
    if (std::isinf(number.uncertainty)) return "-";
    return format_short(mm_per_m * 2 * number.uncertainty, 2);
}

/// To the first digit that is not sure.
std::string format_found(const SimulatedNumber& number) {
    if (std::isinf(number.found)) return "-";
    const double decimals = -std::floor(std::log10(mm_per_m * 2 * number.uncertainty));
    return detail::format_mm(number.found, static_cast<int>(std::clamp(decimals, 0.0, 6.0)));
}

std::string describe_robots(const SimulatedPlan& simulated) {
    std::string text = detail::count_of(simulated.robot_count, "robot");
    if (simulated.expected_count > 0) {
        text += fmt::format(" and {} of expected sizes", simulated.expected_count);
    }
    return text;
}

std::string describe_doubt(const SimulatedPlan& simulated) {
    const std::string asked = fmt::format(
        "{} of {} mm, their standard deviation: to {} mm",
        detail::count_of(simulated.digits, "digit"),
        format_short(mm_per_m * simulated.deviation, static_cast<int>(simulated.digits) + 1),
        format_short(mm_per_m * simulated.tolerance, 2));
    if (simulated.is_sure()) return "sure as asked, " + asked;
    return fmt::format("not as sure as asked, {}: {}", asked,
                       simulated.ending == Ending::IterationLimit
                           ? "that was the most robots allowed (--verify-robots)"
                           : fmt::format("stopped ({})", ending_name(simulated.ending)));
}

}  // namespace

std::string format(const SimulatedPlan& simulated) {
    if (simulated.robot_count == 0) {
        return fmt::format(
            "\nverified:    no: stopped ({}) before the first robots were calibrated\n",
            ending_name(simulated.ending));
    }
    detail::Table table{{"quantity", "closed form/mm", "Monte Carlo/mm", "sure to/mm"}, {}};
    const auto add = [&](const std::string& name, const SimulatedNumber& number) {
        table.rows.push_back({name, detail::format_mm(number.predicted), format_found(number),
                              format_doubt(number)});
    };
    add(simulated.quantity == ErrorQuantity::Rms ? "expected" : "median", simulated.expected);
    add("5 % below", simulated.lower);
    add("95 % below", simulated.upper);
    if (simulated.assurance != 0.95) {
        add(format_short(100 * simulated.assurance) + " % below", simulated.assured);
    }
    std::string text = detail::format_section(
        fmt::format("Position error ({}) as predicted, and of robots that were drawn and "
                    "calibrated",
                    detail::name_of(simulated.quantity)),
        table);
    text += fmt::format("{}; {}\n", describe_robots(simulated), describe_doubt(simulated));
    if (simulated.uncalibrated_count > 0) {
        text += fmt::format("{} could not be calibrated, and count as the worst\n",
                            detail::count_of(simulated.uncalibrated_count, "robot"));
    }
    return text;
}

std::string describe_verified(const TargetPlanning& found_plan,
                              const std::optional<SimulatedPlan>& simulated) {
    const TargetOptions& target = found_plan.target;
    if (!simulated || !target.limit || simulated->robot_count == 0) return "";
    const SimulatedNumber& assured = simulated->assured;
    const double limit = mm_per_m * *target.limit;
    const std::string robots = fmt::format("with {} %, of {}", format_short(100 * target.assurance),
                                           describe_robots(*simulated));
    const std::string found =
        std::isinf(assured.found)
            ? fmt::format("{} of {} could not be calibrated", simulated->uncalibrated_count,
                          describe_robots(*simulated))
            : fmt::format("{} mm (sure to {}) {}", format_found(assured), format_doubt(assured),
                          robots);
    switch (judge_limit(*simulated, *target.limit)) {
        case LimitVerdict::Kept:
            return fmt::format("verified:    the limit is kept{}: {}\n",
                               detail::condition_of_limit(found_plan), found);
        case LimitVerdict::Open:
            return fmt::format(
                "verified:    too close to {} mm to say: {}; more digits tell (--verify-digits), "
                "one pose more is surer\n",
                format_short(limit), found);
        default:
            break;
    }
    std::string remedy = "plan more poses";
    if (std::isfinite(assured.found)) {
        remedy = fmt::format("plan with --target-mm {}",
                             format_short(limit * assured.predicted / assured.found, 3));
    }
    return fmt::format("verified:    THE LIMIT OF {} mm IS NOT KEPT: {}; {}\n", format_short(limit),
                       found, remedy);
}

}  // namespace posewise
