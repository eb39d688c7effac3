#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/calibration.hpp"
#include "sentences.hpp"
#include "target_report.hpp"

namespace posewise {
namespace {

using detail::count_of;
using detail::format_error;
using detail::format_short;

/// "24 poses and 10 measured already".
std::string describe_poses(const Planning& planning) {
    Index count = 0;
    for (const PlannedPose& pose : planning.plan.poses) count += pose.times;
    std::string text = count_of(count, "pose");
    if (planning.measured_count > 0) {
        text += fmt::format(" and {} measured already", planning.measured_count);
    }
    return text;
}

std::string sum_up(const Planning& planning, const char* quantity, double expected, double lower,
                   double upper) {
    return fmt::format(
        "{} {} expected over the workspace (90 %: {} to {}) once calibrated with {}, model error "
        "included",
        format_error(expected, false), quantity, format_short(mm_per_m * lower, 4),
        format_error(upper, false), describe_poses(planning));
}

/// "Limit 0.2 mm with 95 %: kept", by the closed form or, if there are some, by simulated robots.
std::string judge(const TargetPlanning& found, const std::optional<SimulatedPlan>& simulated) {
    const TargetOptions& target = found.target;
    if (!target.limit) return "";
    const bool is_simulated = simulated && simulated->robot_count > 0;
    LimitVerdict verdict =
        found.error->assured <= *target.limit ? LimitVerdict::Kept : LimitVerdict::NotKept;
    if (is_simulated) verdict = judge_limit(*simulated, *target.limit);
    return fmt::format("; limit {} with {} %{}: {}{}", format_error(*target.limit, false),
                       format_short(100 * target.assurance),
                       is_simulated ? ", checked by simulation" : "",
                       verdict == LimitVerdict::Kept      ? "kept"
                       : verdict == LimitVerdict::NotKept ? "not kept"
                                                          : "too close to say",
                       verdict == LimitVerdict::Kept ? detail::condition_of_limit(found) : "");
}

std::string explain_proof(const Plan& plan) {
    std::string criterion(criterion_name(plan.request.criterion));
    for (char& letter : criterion) {
        letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    }
    return fmt::format("{} reaches {} % of the largest possible {}, or more",
                       plan.is_continuous() ? "the best choice from the pool, which the plan beats,"
                                            : "this choice",
                       detail::format_fixed(100 * plan.efficiency, 1), criterion);
}

std::string describe_sureness(const Planning& planning,
                              const std::optional<SimulatedPlan>& simulated) {
    std::string text = "the interval is as wide as the earlier estimate leaves it";
    const KnownWithin& known = planning.campaign.known_within;
    if (!detail::is_told_by_estimate(planning.plan, known)) {
        const bool has_class = known.model_error < model_error_factor;
        text = has_class ? "the interval is how much robots of that class differ; plan --from a "
                           "first calibration narrows it"
                         : "the interval is how much robots differ; robot.class in the campaign "
                           "narrows it, plan --from a first calibration still more";
    }
    if (!simulated || simulated->robot_count == 0) return text;
    const SimulatedNumber& number = simulated->expected;
    return text + fmt::format("; {} give {} where {} is predicted",
                              count_of(simulated->robot_count, "simulated robot"),
                              format_error(number.found, false),
                              format_error(number.predicted, false));
}

/// Where a poorer model promises more than it keeps.
std::string describe_left_out(const Planning& planning) {
    if (!planning.left_out) return "";
    const ErrorsLeftOut& errors = *planning.left_out;
    return fmt::format(
        "{} is left, not {}, if {} of \"{}\" that are not fitted are as large as usual (90 %: {} "
        "to "
        "{}); fitted as well, the same poses are expected to leave {}",
        format_error(errors.expected, false), format_error(errors.promised, false),
        count_of(errors.error_count, "error"), errors.key, format_short(mm_per_m * errors.lower, 4),
        format_error(errors.upper, false), format_error(errors.with_them, false));
}

std::string describe_limit(const ErrorBudget& budget) {
    return detail::describe_largest(
        {{budget.left_over, "what the robot's model cannot express"},
         {budget.noise, "parameters that the noise of measuring leaves uncertain"},
         {budget.model, "parameters that the model error at the poses leaves uncertain"},
         {budget.prior, "parameters that the poses hardly tell, as uncertain as before"},
         {budget.repeatability, "the joints' repeatability"}},
        budget.total, length_units);
}

std::string describe_influence(const Planning& planning) {
    const std::vector<DropOut>& without = planning.without_each;
    if (without.empty() || !planning.plan.predicted) return "";
    const auto most = std::ranges::max_element(without, {}, &DropOut::rms);
    const std::string id =
        detail::quote(planning.plan.poses[static_cast<std::size_t>(most->pose)].id);
    if (std::isinf(most->rms)) return id + ": without it not all parameters are identified";
    return fmt::format("{}: without it the error by the parameters is {} instead of {}", id,
                       format_error(most->rms, false),
                       format_error(planning.plan.predicted->rms, false));
}

/// What is expected by number of poses: as planned where that is known, else as chosen from the
/// pool, of which planning leaves somewhat less.
std::vector<ErrorAtCount> best_known(const std::vector<ErrorAtCount>& chosen,
                                     const std::vector<ErrorAtCount>& planned) {
    std::map<Index, ErrorAtCount> by_count;
    for (const ErrorAtCount& one : chosen) by_count[one.pose_count] = one;
    for (const ErrorAtCount& one : planned) by_count[one.pose_count] = one;
    std::vector<ErrorAtCount> known;
    for (const auto& [count, one] : by_count) known.push_back(one);
    return known;
}

std::string describe_more(const std::vector<ErrorAtCount>& known, Index count,
                          const ErrorBudget& budget) {
    const auto found = more_poses(known, count);
    if (!found || found->most <= count) return "";
    const std::string beyond = fmt::format("more than {}", found->most - count);
    const std::string ends = detail::describe_ends(found->more, beyond);
    if (found->more.expected) {
        return fmt::format("about {} more{}", count_of(*found->more.expected, "new pose"), ends);
    }
    return fmt::format(
        "{}{}: {} leave {:.0f} % of what {} leave; {} would be left if all parameters were known",
        beyond, ends, count_of(found->most, "new pose"), 100 * found->ratio, count,
        format_error(std::hypot(budget.left_over, budget.repeatability), false));
}

/// How points measured already and those of this plan are calibrated together.
std::string describe_together(const PlanSources& sources) {
    if (sources.measured_plan.empty()) return "";
    return fmt::format(
        "calibrate with both, each list of points with its plan: -m {} --plan {} -m POINTS --plan "
        "PLAN, where POINTS are those of this plan",
        detail::escape_controls(sources.augment), detail::escape_controls(sources.measured_plan));
}

std::vector<Answer> complete(const Planning& planning, const std::string& accuracy,
                             const std::optional<SimulatedPlan>& simulated,
                             const std::string& more) {
    std::vector<Answer> answers{{"accuracy", "How accurate", accuracy}};
    const auto add = [&](const char* key, const char* question, const std::string& text) {
        if (!text.empty()) answers.push_back({key, question, text});
    };
    add("sureness", "How sure", describe_sureness(planning, simulated));
    if (const auto& robot = planning.robot_alone) {
        add("robot_alone", "The robot alone",
            fmt::format("{}, {} nominal, where its base and the {} are refitted{}",
                        format_error(robot->calibrated, false), format_error(robot->nominal, false),
                        planning.campaign.sensor->words().place,
                        robot->calibrated < robot->nominal ? "" : ": these views gain nothing"));
    }
    add("left_out", "Errors left out", describe_left_out(planning));
    if (planning.plan.efficiency > 0) add("proof", "How good", explain_proof(planning.plan));
    add("limit", "What limits it", describe_limit(planning.budget));
    add("influence", "Which pose matters most", describe_influence(planning));
    add("more", "More poses for 20 % less", more);
    add("measured", "Measured already", describe_together(planning.plan.request.sources));
    add("image", "Where in the image",
        detail::describe_images("corners of the board are expected to cover ", planning.images));
    return answers;
}

}  // namespace

std::vector<Answer> answer(const Planning& planning, const std::vector<CountAccuracy>& counts,
                           const std::optional<SimulatedPlan>& simulated) {
    if (!planning.plan.predicted) return answer(planning.plan);
    const PredictedTotal total = predict_total(*planning.plan.predicted);
    std::vector<ErrorAtCount> chosen, planned;
    for (const CountAccuracy& one : counts) {
        if (!one.accuracy) continue;
        const auto [rms, lower, upper] = predict_total(*one.accuracy);
        (one.is_planned ? planned : chosen).push_back({one.pose_count, rms, lower, upper});
    }
    std::string more =
        describe_more(best_known(chosen, planned), planning.search.pose_count, planning.budget);
    if (!more.empty()) {
        more += fmt::format("; --target-mm plans for each number and keeps its limit with {:g} %",
                            100 * TargetOptions().assurance);
    }
    return complete(planning, sum_up(planning, "RMS", total.rms, total.lower, total.upper),
                    simulated, more);
}

std::vector<Answer> answer(const TargetPlanning& found,
                           const std::optional<SimulatedPlan>& simulated) {
    if (!found.planning || !found.error) return {};
    const Planning& planning = *found.planning;
    const ErrorRange& error = *found.error;
    std::vector<ErrorAtCount> chosen, planned;
    for (const CountPrediction& one : found.curve) {
        if (!one.error) continue;
        (one.is_planned ? planned : chosen)
            .push_back({one.pose_count, one.error->expected, one.error->lower, one.error->upper});
    }
    return complete(
        planning,
        sum_up(planning, detail::name_of(found.target.quantity), error.expected, error.lower,
               error.upper) +
            judge(found, simulated),
        simulated,
        describe_more(best_known(chosen, planned), planning.search.pose_count, planning.budget));
}

std::vector<Answer> answer(const Plan& plan) {
    Index count = 0;
    for (const PlannedPose& pose : plan.poses) count += pose.times;
    std::string text = fmt::format("{} chosen by {}", count_of(count, "pose"),
                                   criterion_name(plan.request.criterion));
    if (plan.predicted) {
        text += fmt::format(
            ": {} RMS expected over the candidates once calibrated, model error "
            "included",
            format_error(predict_total(*plan.predicted).rms, false));
    }
    std::vector<Answer> answers{{"accuracy", "How accurate", text}};
    if (plan.efficiency > 0) answers.push_back({"proof", "How good", explain_proof(plan)});
    return answers;
}

}  // namespace posewise
