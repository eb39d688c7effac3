#include <fmt/format.h>

#include <cmath>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "table.hpp"

namespace posewise {
namespace {

using detail::Table;

/// RMS and maximum before and after.
Table error_table(const std::vector<Correction>& corrections) {
    const auto count = static_cast<Index>(corrections.size());
    Eigen::ArrayXXd errors(count, 4);
    for (Index i = 0; i < count; ++i) {
        const Correction& correction = corrections[static_cast<std::size_t>(i)];
        errors.row(i) << correction.uncorrected.position, correction.residual.position,
            correction.uncorrected.orientation, correction.residual.orientation;
    }
    const auto row = [&](const char* name, Index first, const auto& measure) {
        return std::vector<std::string>{name, detail::format_mm(measure(errors.col(first))),
                                        detail::format_mm(measure(errors.col(first + 1)))};
    };
    const auto rms = [&](const auto& column) { return std::sqrt(column.square().mean()); };
    const auto largest = [](const auto& column) { return column.maxCoeff(); };
    return {{"pose error", "uncorrected", "corrected"},
            {row("position RMS/mm", 0, rms), row("position max/mm", 0, largest),
             row("orientation RMS/mrad", 2, rms), row("orientation max/mrad", 2, largest)}};
}

Table change_table(const CorrectedPoses& poses) {
    const std::vector<Correction>& corrections = poses.corrections;
    Table table{{"joint", "largest change", ""}, {}};
    for (Index j = 0; j < poses.robot.joint_count(); ++j) {
        double largest = 0;
        for (std::size_t i = 0; i < corrections.size(); ++i) {
            const double change =
                corrections[i].joints[j] - poses.nominal(static_cast<Index>(i), j);
            largest = std::max(largest, std::abs(change));
        }
        const Joint& joint = poses.robot.joint(j);
        const AmountUnits& units = units_of(joint.motion);
        table.rows.push_back({joint.name, detail::format_fixed(units.to_reading(largest), 4),
                              std::string(units.reading)});
    }
    return table;
}

/// The poses whose correction is not complete, the first ones.
std::string format_shortfalls(const CorrectedPoses& poses) {
    constexpr std::size_t most = 20;
    Table table{{"config", "left/mm", "left/mrad", "why"}, {}};
    std::size_t count = 0;
    for (std::size_t i = 0; i < poses.corrections.size(); ++i) {
        const Correction& correction = poses.corrections[i];
        const std::string why = describe_shortfall(poses.robot, correction);
        if (why.empty() || ++count > most) continue;
        const PoseError& left = correction.residual;
        table.rows.push_back({poses.ids[i], detail::format_mm(left.position),
                              detail::format_mm(left.orientation), why});
    }
    if (count == 0) return "";
    std::string text = format_section(
        fmt::format("Not corrected completely: {} of {}", count, poses.corrections.size()), table);
    if (count > most) text += fmt::format("... and {} more\n", count - most);
    return text;
}

}  // namespace

std::string format(const CorrectedPoses& poses) {
    return format_section("Accuracy as the estimate predicts it", error_table(poses.corrections)) +
           format_section("Corrections", change_table(poses)) + format_shortfalls(poses);
}

}  // namespace posewise
