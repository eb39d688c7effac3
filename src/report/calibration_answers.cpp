#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "core/names.hpp"
#include "core/text.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/report/reports.hpp"
#include "sentences.hpp"
#include "task/calibration/judgement.hpp"

namespace posewise {
namespace {

using detail::count_of;
using detail::format_error;
using detail::format_short;

/// The error where it was judged most honestly.
struct Judged {
    const Metrics& found;
    std::optional<RmsInterval> interval;
    std::string where;
    const AmountUnits& units;
    const JudgedGroup* group = nullptr;
};

/// "4 of 5 poses", and why the others are not among them.
std::string describe_part(const Judgement& judgement, const JudgedGroup& part,
                          const std::string& name) {
    Index all = 0;
    std::string others;
    for (const JudgedGroup& group : judgement.groups) {
        const auto count = std::ssize(group.configurations);
        all += count;
        if (&group == &part) continue;
        others += fmt::format(
            "{}{} {}", others.empty() ? "" : ", ", count,
            group.group == PoseGroup::Repeated ? "calibrated with"
            : group.group == PoseGroup::New
                ? "within the joint ranges"
                : "beyond the range of " + fmt::format("{}", fmt::join(group.joints, ", ")));
    }
    const auto count = std::ssize(part.configurations);
    if (others.empty()) return fmt::format("{} {}", count_of(count, "pose"), name);
    return fmt::format("{} of {} {} (judged apart: {})", count, count_of(all, "pose"), name,
                       others);
}

/// The poses of this kind that were judged, if there are any; `name`: which they are.
std::optional<Judged> judge_at(const std::optional<Judgement>& judgement, const std::string& name,
                               PoseGroup kind) {
    if (!judgement) return std::nullopt;
    const auto group = std::ranges::find(judgement->groups, kind, &JudgedGroup::group);
    if (group == judgement->groups.end()) return std::nullopt;
    return Judged{
        group->found, group->interval,
        fmt::format("at {}{}", describe_part(*judgement, *group, name),
                    kind == PoseGroup::New ? "" : ", beyond the joint ranges calibrated with"),
        *judgement->units, &*group};
}

/// Judgements at poses that were not calibrated with, and which poses these are.
std::vector<std::pair<const std::optional<Judgement>*, const char*>> judgements(
    const Calibration& calibration) {
    return {{&calibration.validation, "of the validation"},
            {&calibration.verification, "that the plan set aside to verify"},
            {&calibration.left_out, "not in the plan"}};
}

/// Poses that were not calibrated with come first, those like the ones calibrated with before
/// others.
Judged judge(const Calibration& calibration) {
    for (const PoseGroup kind : {PoseGroup::New, PoseGroup::Beyond}) {
        for (const auto& [judgement, name] : judgements(calibration)) {
            if (const auto judged = judge_at(*judgement, name, kind)) return *judged;
        }
    }
    const Metrics& fit = calibration.estimate.fit;
    const AmountUnits& units = calibration.campaign.sensor->main_units();
    if (!calibration.held_out) {
        return {fit, std::nullopt, "at the poses it was made with; nothing was held out", units};
    }
    if (calibration.held_out->samples.point_count == 0) {
        return {fit, std::nullopt, "at the poses it was made with, none of which can be left out",
                units};
    }
    return {calibration.held_out->samples, calibration.held_out_interval,
            "at poses held out in turn", units};
}

/// "0.1234 to 0.2 mm".
std::string format_interval(const RmsInterval& interval, const AmountUnits& units) {
    return fmt::format("{} to {}", format_short(mm_per_m * interval.lower, 4),
                       format_error(interval.upper, units));
}

/// What was found at the validation or the verification beside the one that `judged` is of.
std::string describe_others(const Calibration& calibration, const Judged& judged) {
    std::string text;
    if (!judged.group || !calibration.validation || !calibration.verification) return text;
    for (const auto& [judgement, name] : judgements(calibration)) {
        if (judgement == &calibration.left_out) continue;
        const auto is_told = [&](const JudgedGroup& group) { return &group == judged.group; };
        if (std::ranges::any_of((*judgement)->groups, is_told)) continue;
        const auto found = judge_at(*judgement, name, PoseGroup::New);
        const auto beyond = judge_at(*judgement, name, PoseGroup::Beyond);
        const auto& other = found ? found : beyond;
        if (!other) continue;
        text += fmt::format(", {} RMS", format_error(other->found.rms(), other->units));
        if (other->interval) {
            text += fmt::format(" (95 %: {})", format_interval(*other->interval, other->units));
        }
        text += fmt::format(" {}", other->where);
    }
    return text;
}

std::string sum_up(const Calibration& calibration, const Judged& judged, const AmountUnits& units) {
    // The nominal robot at the same poses, base and targets fitted to the others as well.
    const auto& comparison = calibration.held_out_comparison;
    const bool is_compared = !judged.group && comparison;
    const double nominal = is_compared ? comparison->nominal : calibration.nominal.rms();
    const double found = judged.found.rms();
    std::string text;
    if (!calibration.faults.empty()) text = "no calibration, " + calibration.faults.front() + "; ";
    text += fmt::format("calibrated {} RMS", format_error(found, judged.units));
    if (calibration.campaign.sensor->lengths_per_target() == 1) text += " of one length";
    if (judged.interval) {
        text += fmt::format(" (95 %: {})", format_interval(*judged.interval, judged.units));
    }
    text += fmt::format(" {}", judged.where) + describe_others(calibration, judged);
    if (calibration.campaign.robot.parameter_count() == 0) {
        text += "; the robot is taken as it is";
    } else if (judged.group && judged.group->nominal) {
        text += fmt::format("; before {}", format_error(*judged.group->nominal, judged.units));
        if (judged.group->is_no_better()) text += ", which is no worse";
    } else if (&judged.units == &units) {
        text += fmt::format("; before {}{}", format_error(nominal, units),
                            judged.group ? " at the poses calibrated with" : "");
        if (!judged.group && found >= nominal) text += ", which is no worse";
    }
    if (!calibration.limit) return text;
    text += fmt::format("; limit {}: ", format_error(*calibration.limit, false));
    const auto verdict = judged.group ? judge_limit(*judged.group, *calibration.limit)
                                      : std::optional<LimitVerdict>();
    if (!verdict) return text + "not judged";
    return text + std::string(detail::name_of(detail::limit_verdicts, *verdict));
}

std::string describe_sureness(const Calibration& calibration, const Judged& judged) {
    if (!judged.interval) return "not known: no poses were judged that it was not made with";
    const Index count = judged.group ? std::ssize(judged.group->configurations)
                                     : calibration.measured.configurations;
    return fmt::format("the interval follows from how much {} differ",
                       detail::these(count, "pose"));
}

/// The error expected beside the one found: at the poses judged, or, where parameters take up
/// little of what is measured, at those held out (else a pose held out is known worse than one that
/// was used).
std::string compare_expected(const Calibration& calibration, const Judged& judged) {
    const AmountUnits& units = judged.units;
    const auto sentence = [&](double expected, double found, const char* verdict) {
        return fmt::format("{} expected {}, {} found: {}", format_error(expected, units),
                           judged.where, format_error(found, units), verdict);
    };
    if (judged.group) {
        const JudgedGroup& group = *judged.group;
        if (!group.expected || group.verdict == ChanceVerdict::NotJudged) return "";
        return sentence(group.expected->total(), group.found.rms(),
                        group.verdict == ChanceVerdict::Within  ? "within chance"
                        : group.verdict == ChanceVerdict::Below ? "less than chance would have it"
                                                                : "beyond chance");
    }
    constexpr double most_taken_up = 0.1;
    const Sensor& sensor = *calibration.campaign.sensor;
    const auto numbers =
        static_cast<double>(calibration.measured.configurations * sensor.row_count());
    const double taken_up = numbers - static_cast<double>(calibration.estimate.degrees_of_freedom);
    // However many corners a view shows, it tells six numbers of the robot.
    const auto telling = static_cast<double>(calibration.measured.configurations * 6);
    const double least = sensor.has_pixels() ? std::min(numbers, telling) : numbers;
    if (!calibration.held_out_interval || taken_up > most_taken_up * least) return "";
    const double expected = calibration.expected.total();
    const double found = calibration.held_out->means.rms();
    const auto& [lower, upper, freedom] = *calibration.held_out_interval;
    const double factor = std::sqrt(upper / lower);
    return sentence(expected, found,
                    expected > found * factor   ? "less, sizes or model error are stated too large"
                    : expected * factor < found ? "more: outliers, or errors the model leaves out"
                                                : "within chance");
}

/// The largest part of what is expected over the workspace, or else at the poses measured.
std::string describe_limit(const Calibration& calibration, const AmountUnits& units) {
    const auto& workspace = calibration.expected_workspace;
    const ExpectedError& error = workspace ? *workspace : calibration.expected;
    std::string text = detail::describe_largest(
        {{error.model, "what the robot's model cannot express"},
         {error.parameters, "parameters that the poses leave uncertain"},
         {error.noise, "the instrument's noise and the joints' repeatability"}},
        error.total(), units);
    if (text.empty()) return text;
    text += workspace ? " expected over the workspace" : " expected at poses like these";
    if (!calibration.cures.found.empty()) {
        const Cure& best = *std::ranges::min_element(calibration.cures.found, {}, &Cure::after);
        text += "; " + detail::describe(best, calibration.campaign);
    }
    const std::size_t outliers = calibration.estimate.outliers.size();
    const bool drifts = calibration.order_trend && calibration.order_trend->is_plain();
    if (drifts || outliers > 0) {
        text += fmt::format("; {}{}{} may be in it", drifts ? "the drift below" : "",
                            drifts && outliers > 0 ? " and " : "",
                            outliers > 0 ? count_of(static_cast<Index>(outliers), "outlier") : "");
    }
    return text;
}

std::string describe_influence(const Calibration& calibration, const AmountUnits& units) {
    if (!calibration.influence) return "not known: nothing was held out";
    const auto& [id, fit, held_out, is_alone] = *calibration.influence;
    constexpr double little = 1.3;
    return fmt::format("{}{}: predicted by the {} it is missed by {}, with it by {}",
                       held_out < little * fit ? "none stands out; most does " : "",
                       detail::quote(id), is_alone ? "others" : "other groups",
                       format_error(held_out, units), format_error(fit, units));
}

/// "; by the temperature (2.4 C): z changes by 0.012 mm per C (sigma 0.003 mm), p = 0.001".
std::string describe_conditions(const Calibration& calibration) {
    std::string text;
    for (const ConditionTrend& condition : calibration.condition_trends) {
        const OrderSlope& worst = condition.trend.worst();
        const AmountUnits& units = calibration.campaign.sensor->units(worst.is_angle);
        text += fmt::format("; by the {} ({} {}): {} changes by {} per {} (sigma {}), p = {}",
                            condition.name, format_short(condition.range, 3), condition.unit,
                            worst.axis, format_error(worst.change / condition.range, units),
                            condition.unit, format_error(worst.error / condition.range, units),
                            format_short(worst.probability, 2));
    }
    return text;
}

std::string describe_order(const Calibration& calibration) {
    if (!calibration.order_trend) return "not known: too few configurations";
    const OrderTrend& trend = *calibration.order_trend;
    const OrderSlope& worst = trend.worst();
    const AmountUnits& units = calibration.campaign.sensor->units(worst.is_angle);
    const std::string size =
        fmt::format("{} changes by {} from first to last (sigma {}), p = {}", worst.axis,
                    format_error(worst.change, units), format_error(worst.error, units),
                    format_short(worst.probability, 2));
    const std::string unsure =
        trend.is_beside_joints ? ""
                               : "; the order of the poses themselves could look like this, too";
    if (trend.is_plain()) {
        return fmt::format(
            "yes, residuals follow the order of the measurements: {}{}; the first "
            "tenth is off the rest by {}",
            size, unsure, format_error(worst.early, units));
    }
    if (trend.is_possible()) return "perhaps: " + size + unsure;
    double detectable = 0;
    for (const OrderSlope& slope : trend.slopes) {
        if (slope.is_angle == worst.is_angle) detectable = std::max(detectable, slope.detectable);
    }
    if (!calibration.doubts.look.changes.empty()) {
        return "not judged: something moved, see warnings";
    }
    const Metrics& fit = calibration.estimate.fit;
    const double left = worst.is_angle ? fit.orientation_rms : fit.rms();
    return fmt::format("{}, {}; a drift of {} from first to last would have been seen",
                       detectable > left ? "none so large that it could be seen" : "none seen",
                       size, format_error(detectable, units));
}

/// More configurations lower the parameters' variance alone, as 1 / n.
std::string describe_more(const Calibration& calibration, const AmountUnits& units) {
    constexpr double wanted = 0.8;
    const ExpectedError& error =
        calibration.expected_workspace ? *calibration.expected_workspace : calibration.expected;
    const double parameters = error.parameters * error.parameters;
    const double rest = error.total() * error.total() - parameters;
    const double open = wanted * wanted * (parameters + rest) - rest;
    const auto now = static_cast<double>(calibration.measured.configurations);
    const double more = std::ceil(now * parameters / open - now);
    constexpr double most = 1e6;
    if (!(open > 0) || more > most) {
        return fmt::format(
            "no number does: {} of the {} expected would be left if all parameters were known; a "
            "better model or instrument helps",
            format_error(std::sqrt(rest), units), format_error(error.total(), units));
    }
    return fmt::format("about {} more, if they tell as much as those measured",
                       count_of(static_cast<Index>(more), "configuration"));
}

/// "the residuals in mm are 3 times what sigma and model error say".
std::string judge_residuals(const Calibration& calibration, const ResidualDoubt& doubt) {
    const bool has_kinds = !calibration.estimate.variance_by_kind.empty();
    const std::string text =
        fmt::format("the residuals{} are {} times what sigma and model error say",
                    !has_kinds       ? ""
                    : doubt.is_angle ? " in mrad"
                                     : " in mm",
                    format_short(doubt.ratio, 2));
    const bool is_earlier = !calibration.held.empty();
    if (is_earlier) {
        return text + (doubt.ratio < 1 ? ", less than the earlier estimate left over"
                                       : ": the robot may not be as the earlier estimate has it");
    }
    if (doubt.ratio > 1) return text;
    if (detail::is_model_error_found(calibration)) {
        return text + ": what is expected is rather too large";
    }
    if (doubt.fitting == 0) return text;
    return text + fmt::format(", as a model error of {} would leave",
                              format_error(doubt.fitting,
                                           calibration.campaign.sensor->units(doubt.is_angle)));
}

std::string judge_residuals(const Calibration& calibration) {
    std::string text;
    for (const ResidualDoubt& doubt : calibration.doubts.residuals) {
        text += (text.empty() ? "" : "; ") + judge_residuals(calibration, doubt);
    }
    return text;
}

std::string list_short(const Vector3d& values) {
    return fmt::format("{} {} {}", format_short(values[0], 2), format_short(values[1], 2),
                       format_short(values[2], 2));
}

std::string list_mm(const Vector3d& position) {
    return fmt::format("{:.3f} {:.3f} {:.3f}", mm_per_m * position[0], mm_per_m * position[1],
                       mm_per_m * position[2]);
}

/// Where camera or board is, which hand-eye is done for. Empty where errors of the robot are found,
/// too.
std::string describe_place(const Calibration& calibration) {
    const Campaign& campaign = calibration.campaign;
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    const bool is_found = camera != nullptr && !camera->setup().known_place;
    if (!is_found || campaign.robot.parameter_count() > 0 || !calibration.faults.empty()) return "";
    const VectorXd& unknowns = calibration.estimate.parameters.sensor;
    const VectorXd sigmas = standard_deviations(calibration.estimate)
                                .tail(unknowns.size())
                                .segment<6>(camera->first_of_place());
    std::string text = fmt::format(
        "the {} is at {} mm in the flange frame, give or take {} mm along and {} mrad about its "
        "axes (1 sigma)",
        camera->setup().on_flange(), list_mm(camera->place(unknowns).translation()),
        list_short(mm_per_m * sigmas.head<3>()), list_short(mrad_per_rad * sigmas.tail<3>()));
    if (camera->setup().is_on_flange) return text;
    const Isometry3d base_from_camera = calibration.estimate.parameters.world_from_base.inverse();
    return text + fmt::format("; the camera is at {} mm in the base frame",
                              list_mm(base_from_camera.translation()));
}

std::string describe_missing_errors(const Calibration& calibration) {
    if (!calibration.doubts.missing_errors) return "";
    return fmt::format(
        "about {:.0f} % of the squares left over follow the joints' positions: joints bend or have "
        "periodic errors that this model leaves out",
        100 * *calibration.doubts.missing_errors);
}

std::string judge_compliances(const Calibration& calibration) {
    std::string names;
    for (const Index joint : calibration.doubts.negative_compliances) {
        names += (names.empty() ? "" : ", ") + calibration.campaign.robot.joint(joint).name;
    }
    if (names.empty()) return "";
    return names +
           ": negative, but a joint gives way with its load; is tau the torque of the load (a "
           "motor's has the other sign), are weights, places and direction of gravity right?";
}

}  // namespace

std::vector<Answer> answer(const Calibration& calibration) {
    if (!calibration.is_identified()) return {};
    const AmountUnits& units = calibration.campaign.sensor->main_units();
    const Judged judged = judge(calibration);
    std::vector<Answer> answers{{"accuracy", "How accurate", sum_up(calibration, judged, units)},
                                {"sureness", "How sure", describe_sureness(calibration, judged)}};
    const auto add = [&](const char* key, const char* question, const std::string& text) {
        if (!text.empty()) answers.push_back({key, question, text});
    };
    add("expected", "As expected", compare_expected(calibration, judged));
    add("limit", "What limits it", describe_limit(calibration, units));
    add("influence", "Which pose matters most", describe_influence(calibration, units));
    add("drift", "Drift", describe_order(calibration) + describe_conditions(calibration));
    add("more", "More poses for 20 % less", describe_more(calibration, units));
    add("place", "Where it is", describe_place(calibration));
    add("image", "Where in the image",
        detail::describe_images("corners of the board cover ", calibration.images));
    add("residuals", "Residuals", judge_residuals(calibration));
    add("missing_errors", "Errors left out", describe_missing_errors(calibration));
    add("negative_compliances", "Compliances", judge_compliances(calibration));
    return answers;
}

}  // namespace posewise
