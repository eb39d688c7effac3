#include "judgement_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "sentences.hpp"
#include "task/calibration/judgement.hpp"

namespace posewise::detail {
namespace {

/// What the poses of a judgement are called, and what it means if they are worse than expected.
struct Kind {
    const char* name;
    std::string cause;
};

/// "12 new poses", "3 poses beyond the joint ranges calibrated with (q2, q3)".
std::string describe_poses(const JudgedGroup& group) {
    const Index count = std::ssize(group.configurations);
    if (group.group == PoseGroup::New) return count_of(count, "new pose");
    if (group.group == PoseGroup::Repeated) return count_of(count, "pose") + " calibrated with";
    return escape_controls(fmt::format("{} beyond the joint ranges calibrated with ({})",
                                       count_of(count, "pose"), fmt::join(group.joints, ", ")));
}

std::string describe_interval(const JudgedGroup& group, const AmountUnits& units) {
    if (!group.interval) return ", interval unknown: as much was fitted to them as they tell";
    const auto& [lower, upper, freedom] = *group.interval;
    return fmt::format(", with 95 % {}..{} ({} degrees of freedom)",
                       format_short(mm_per_m * lower, 4), format_error(upper, units),
                       format_short(freedom, 3));
}

std::string describe_limit(const JudgedGroup& group, const std::optional<double>& limit) {
    if (!limit) return "";
    const std::string text = fmt::format(", limit {}: ", format_error(*limit, false));
    const std::optional<LimitVerdict> verdict = judge_limit(group, *limit);
    if (!verdict) return text + "not judged";
    const std::string word(name_of(limit_verdicts, *verdict));
    if (*verdict != LimitVerdict::Open) return text + word;
    const std::optional<Index> count = poses_to_decide(group, *limit);
    return text + word + (count ? fmt::format(" (if the RMS stays, {} poses decide)", *count) : "");
}

std::string describe_verdict(const Calibration& calibration, const Kind& kind, bool has_moved,
                             const JudgedGroup& group, const AmountUnits& units) {
    const bool is_repeated = group.group == PoseGroup::Repeated;
    const std::string unjudged =
        is_repeated ? "; they were calibrated with and say nothing of other poses" : "";
    if (!group.expected) return unjudged;
    const std::string times =
        fmt::format("; {} times what is expected", format_short(group.ratio(), 3));
    const bool is_calibration = calibration.faults.empty() &&
                                &units == &calibration.campaign.sensor->main_units() &&
                                group.found.rms() < calibration.nominal.rms();
    const bool exceeds_limit =
        calibration.limit && judge_limit(group, *calibration.limit) == LimitVerdict::NotKept;
    const auto as_expected = [&](const std::string& chance, const char* holds) {
        if (exceeds_limit) return times + chance + ": as expected, but more than the limit";
        return times + chance + (is_calibration ? holds : "");
    };
    switch (group.verdict) {
        case ChanceVerdict::NotJudged:
            return unjudged;
        case ChanceVerdict::Within:
            return as_expected(", within chance", ": the calibration holds there");
        case ChanceVerdict::Below:
            return as_expected(", less than chance would have it", ": it holds there");
        case ChanceVerdict::Beyond:
            break;
    }
    const std::string beyond =
        fmt::format("{}, beyond chance (up to {}): ", times, format_short(group.chance, 3));
    if (group.worst && !has_moved) {
        return beyond + fmt::format("most of it is of {}, the others have {}",
                                    quote(group.worst->id),
                                    format_error(group.worst->without, units));
    }
    return beyond + (has_moved     ? "measured with another set-up"
                     : is_repeated ? "the robot or its set-up has changed since"
                     : group.group == PoseGroup::Beyond
                         ? "what is expected there is extrapolated; calibrate with poses like "
                           "those, too"
                         : kind.cause.c_str());
}

std::string describe(const Calibration& calibration, const Kind& kind,
                     const std::optional<Judgement>& judgement) {
    if (!judgement) return "";
    const AmountUnits& units = *judgement->units;
    const bool has_moved =
        judgement->moved || (calibration.moved && &judgement == &calibration.validation);
    std::string text;
    for (const JudgedGroup& group : judgement->groups) {
        text += fmt::format("{}, {}: RMS {}{}{}{}\n", kind.name, describe_poses(group),
                            format_error(group.found.rms(), units), describe_interval(group, units),
                            describe_limit(group, calibration.limit),
                            describe_verdict(calibration, kind, has_moved, group, units));
    }
    return text;
}

}  // namespace

std::string describe_judgements(const Calibration& calibration) {
    const std::string unlike = fmt::format(
        "the robot's errors there are unlike those calibrated with, or the model error "
        "is larger than {}",
        is_model_error_found(calibration) ? "the one found" : "the one stated");
    const std::string changed = "the robot has changed, or " + unlike;
    return describe(calibration, {"verification", unlike}, calibration.verification) +
           describe(calibration, {"not in plan", unlike}, calibration.left_out) +
           describe(calibration, {"validation", changed}, calibration.validation);
}

}  // namespace posewise::detail
