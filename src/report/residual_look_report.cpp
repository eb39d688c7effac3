#include "residual_look_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"

namespace posewise::detail {
namespace {

/// "0.16 instead of 38 mm held out".
std::string describe(const HeldOutChange& change, const Campaign& campaign) {
    return fmt::format("{} instead of {} {} held out", format_short(1e3 * change.after, 3),
                       format_short(1e3 * change.before, 3), campaign.sensor->main_units().error);
}

/// "[1.2, -1.6, 0.01]", of m or rad as mm or mrad.
std::string describe_vector(const Vector3d& v) {
    const auto number = [&](double value) {
        return format_fixed(1e3 * value, v.norm() < 1e-3 ? 2 : 1);
    };
    return fmt::format("[{}, {}, {}]", number(v.x()), number(v.y()), number(v.z()));
}

std::string describe(const OutlyingConfigurations& outlying, const Cures& cures,
                     const Campaign& campaign) {
    const bool is_one = outlying.ids.size() == 1;
    std::string text =
        fmt::format("{} {} {} not fit the others, without {} {} % of the squares is left",
                    is_one ? "configuration" : "configurations", fmt::join(outlying.ids, ", "),
                    is_one ? "does" : "do", is_one ? "it" : "them",
                    format_short(100 * outlying.squares_left, 2));
    if (outlying.exchanged) {
        text += fmt::format(" ({} and {} fit with each other's joint values: rows exchanged?)",
                            outlying.exchanged->first, outlying.exchanged->second);
    }
    const Remedy remedy = exclusion(outlying.ids);
    if (std::ranges::count(cures.found, remedy, &Cure::remedy) > 0) return text;
    return text +
           fmt::format("; with {}: {}", spell(remedy), describe(outlying.held_out, campaign));
}

std::string describe(const SetUpChange& change, const Campaign& campaign) {
    const bool is_base = change.part == "base";
    std::string text = fmt::format(
        "{} {} configurations {} and {}, by {} mm", is_base ? "base or instrument" : change.part,
        change.is_gradual ? "drifts between" : "moved between", change.last_before,
        change.first_after, describe_vector(change.translation));
    if (change.rotation.norm() > 0) {
        text += fmt::format(" and {} mrad", describe_vector(change.rotation));
    }
    const bool is_in_world =
        is_base || change.part.starts_with("socket") || change.part.starts_with("readings");
    text += is_in_world ? " in the instrument's frame" : " in the flange's frame";
    if (!change.excluded.empty()) {
        return text + fmt::format("; with {}: {}", spell(exclusion({change.excluded})),
                                  describe(change.held_out, campaign));
    }
    return text +
           fmt::format("; with that as one more unknown: {}", describe(change.held_out, campaign));
}

std::string describe(const LengthFactor& factor) {
    const double percent = 100 * factor.excess;
    return fmt::format(
        "all lengths are {} % {} than the robot's (give or take {} %): is the instrument's scale "
        "right, and the robot's temperature? With readings scaled by {} the robot's errors are {} "
        "instead of {} times what is expected of them (RMS)",
        format_short(std::abs(percent), 2), percent > 0 ? "longer" : "shorter",
        format_short(100 * factor.deviation, 1), format_fixed(1 / (1 + factor.excess), 5),
        format_short(factor.errors->after, 3), format_short(factor.errors->before, 3));
}

std::string describe(const JointPattern& pattern, const Campaign& campaign) {
    const std::string held_out = describe(pattern.held_out, campaign);
    if (pattern.kind == JointPattern::Kind::Scale) {
        return fmt::format(
            "residuals follow the value of {}, as if it moved by {} % more than it says: is the "
            "scale of its readings right? With that as one more unknown: {}",
            pattern.joint, format_short(100 * pattern.size, 3), held_out);
    }
    return fmt::format(
        "residuals follow the direction that {} came from, {} {} from one side to the other: "
        "backlash? Come to each pose from the same side; with that as one more unknown: {}",
        pattern.joint, format_short(1e3 * std::abs(pattern.size), 2),
        units_of(pattern.is_angle).error, held_out);
}

std::string describe(const RoundedJoints& rounded, const Campaign& campaign) {
    const double degrees = to_degrees(rounded.step);
    return fmt::format(
        "all joint angles are multiples of {} deg, and rounding them so leaves {} {} by itself: "
        "record more digits; with repeatability_mrad: {} of each joint: {}",
        format_short(degrees, 2), format_short(1e3 * rounded.effect, 2),
        campaign.sensor->main_units().error, format_short(1e3 * rounded.step / std::sqrt(12.0), 2),
        describe(rounded.held_out, campaign));
}

std::string describe(const RoundedReadings& rounded) {
    return fmt::format(
        "all lengths read are multiples of {} mm; rounding them so leaves {} mm by itself, the fit "
        "leaves {} mm: record more digits",
        format_short(1e3 * rounded.step, 2), format_short(1e3 * rounded.effect, 2),
        format_short(1e3 * rounded.left, 2));
}

std::string describe(const ShiftedRows& shifted, const Campaign& campaign) {
    return fmt::format(
        "from configuration {} on, readings fit the joint values of the row {}: was a row lost? "
        "The nominal robot then misses half of the readings by {} instead of {} {}",
        quote(shifted.first), shifted.shift > 0 ? "before" : "after",
        format_short(1e3 * shifted.after, 3), format_short(1e3 * shifted.before, 3),
        campaign.sensor->main_units().error);
}

}  // namespace

std::string describe_length_factor(const ResidualLook& look) {
    if (!look.lengths) return "";
    const auto& [excess, deviation, errors] = *look.lengths;
    return fmt::format(
        "all lengths together, as by temperature or scale: {} % {} than the robot's, give or take "
        "{} %\n",
        format_short(100 * std::abs(excess), 2), excess > 0 ? "longer" : "shorter",
        format_short(100 * deviation, 1));
}

std::vector<std::string> describe_look(const ResidualLook& look, const Cures& cures,
                                       const Campaign& campaign) {
    std::vector<std::string> sentences;
    if (look.shifted) sentences.push_back(describe(*look.shifted, campaign));
    if (look.outlying) sentences.push_back(describe(*look.outlying, cures, campaign));
    for (const SetUpChange& change : look.changes) sentences.push_back(describe(change, campaign));
    if (look.lengths && look.lengths->errors) sentences.push_back(describe(*look.lengths));
    for (const JointPattern& joint : look.joints) sentences.push_back(describe(joint, campaign));
    if (look.rounded) sentences.push_back(describe(*look.rounded, campaign));
    if (look.rounded_readings) sentences.push_back(describe(*look.rounded_readings));
    return sentences;
}

}  // namespace posewise::detail
