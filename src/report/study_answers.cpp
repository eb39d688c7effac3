#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "sentences.hpp"

namespace posewise {
namespace {

using detail::count_of;
using detail::format_error;

constexpr Index few_splits = 5;  // tell no range

/// Medians of the poses that the first criterion chose, and what 5 and 95 % of the splits or robots
/// are below, by count, with their rows.
struct Curve {
    std::vector<ErrorAtCount> points;
    std::vector<const StudyRow*> rows;
};

Curve curve_of(const Study& study) {
    Curve curve;
    if (study.criteria.empty()) return curve;
    for (const StudyRow& row : study.rows) {
        const StudyCases cases = planned_cases(row, 0, study.criteria.size());
        const auto median = held_out_quantile(cases, 0.5);
        if (!median) continue;
        const bool has_ends = split_count(row, study.criteria.size()) >= few_splits;
        curve.points.push_back({row.pose_count, *median,
                                has_ends ? held_out_quantile(cases, 0.05).value_or(0) : 0,
                                has_ends ? held_out_quantile(cases, 0.95).value_or(0) : 0});
        curve.rows.push_back(&row);
    }
    return curve;
}

/// The least number of poses within 10 % of the smallest error.
std::size_t enough(const std::vector<ErrorAtCount>& points,
                   double ErrorAtCount::*error = &ErrorAtCount::error) {
    constexpr double alike = 1.1;
    const double best = std::ranges::min(points, {}, error).*error;
    return static_cast<std::size_t>(
        std::ranges::find_if(points, [&](const auto& one) { return one.*error <= alike * best; }) -
        points.begin());
}

/// How that number differs between splits or robots.
std::string describe_ends(const std::vector<ErrorAtCount>& points) {
    if (!std::ranges::all_of(points, &ErrorAtCount::has_ends)) return "";
    const Index low = points[enough(points, &ErrorAtCount::lower)].pose_count;
    const Index high = points[enough(points, &ErrorAtCount::upper)].pose_count;
    return detail::describe_ends({std::nullopt, std::min(low, high), std::max(low, high)}, "");
}

std::string sum_up(const Study& study, const Curve& curve) {
    const std::size_t k = enough(curve.points);
    const auto random = held_out_quantile(curve.rows[k]->random, 0.5);
    const auto expected = median_expected(planned_cases(*curve.rows[k], 0, study.criteria.size()));
    std::string text = fmt::format(
        "{} chosen by {} leave {} RMS {}", count_of(curve.points[k].pose_count, "pose"),
        criterion_name(study.criteria.front()), format_error(curve.points[k].error, *study.units),
        study.is_simulated ? "over the workspace" : "at poses held out");
    if (expected) text += fmt::format(", {} expected", format_error(*expected, *study.units));
    if (random) text += fmt::format(", random ones {}", format_error(*random, *study.units));
    return text +
           (k + 1 == curve.points.size() ? "; more were not tried"
                                         : "; the fewest within 10 % of the best") +
           describe_ends(curve.points);
}

std::string describe_sureness(const Study& study, const Curve& curve) {
    const std::string few_judged = detail::describe_least_judged(study);
    const std::string warning = few_judged.empty() ? "" : "; " + few_judged;
    const StudyRow& row = *curve.rows[enough(curve.points)];
    if (study.splits == 0) {
        constexpr Index few = 10;
        const Index left = static_cast<Index>(study.ids.size()) - row.pose_count;
        return std::string("every subset was judged on the poses it leaves") +
               (left < few ? fmt::format(", here {}", left) : "") + warning;
    }
    const std::string splits =
        count_of(split_count(row, study.criteria.size()), study.is_simulated ? "robot" : "split");
    std::string text = "medians over " + splits;
    if (const auto advantage = planned_advantage(study, row, 0)) {
        text += fmt::format("; planned against random {:.2f}, with 95 % {:.2f} to {:.2f}",
                            advantage->ratio, advantage->lower, advantage->upper);
        if (advantage->left_out > 0) {
            text +=
                fmt::format(", without {} whose random subsets do not identify the model",
                            count_of(advantage->left_out, study.is_simulated ? "robot" : "split"));
        }
    }
    return text + warning;
}

std::string describe_limit(const Curve& curve) {
    if (curve.points.size() == 1) return "";
    const std::size_t k = enough(curve.points);
    const ErrorAtCount& at = curve.points[k];
    if (k + 1 < curve.points.size()) {
        return fmt::format(
            "noise and what the model cannot express; from {} on not the number of poses",
            count_of(at.pose_count, "pose"));
    }
    const ErrorAtCount& before = curve.points[k - 1];
    return fmt::format("the error still falls, by {:.0f} % from {} to {}, the most tried",
                       100 * (1 - at.error / before.error), before.pose_count,
                       count_of(at.pose_count, "pose"));
}

/// "from 8: 5 more, from 12: 9 more; from 20 no number up to 50 does".
std::string describe_more(const std::vector<ErrorAtCount>& points) {
    std::vector<std::string> steps;
    Index without = 0;  // the first number that none leaves 20 % less than, if not 0
    for (const ErrorAtCount& one : points) {
        const auto found = more_poses(points, one.pose_count);
        if (!found || found->most == one.pose_count) continue;
        if (found->more.expected) {
            steps.push_back(fmt::format(
                "from {}: {} more{}", one.pose_count, *found->more.expected,
                detail::describe_ends(found->more,
                                      fmt::format("more than {}", found->most - one.pose_count))));
            without = 0;
        } else if (without == 0) {
            without = one.pose_count;
        }
    }
    const std::string rest = without > 0 ? fmt::format("from {} no number up to {} does", without,
                                                       points.back().pose_count)
                                         : "";
    return fmt::format("{}{}{}", fmt::join(steps, ", "), steps.empty() || rest.empty() ? "" : "; ",
                       rest);
}

}  // namespace

std::vector<Answer> answer(const std::vector<Study>& studies) {
    std::vector<Answer> answers;
    for (const Study& study : studies) {
        const Curve curve = curve_of(study);
        if (curve.points.empty()) continue;
        const std::string of = study.model.empty() ? "" : study.model + ": ";
        const auto add = [&](const char* key, const char* question, const std::string& text) {
            if (!text.empty()) answers.push_back({key, question, of + text});
        };
        add("accuracy", "How many poses", sum_up(study, curve));
        add("sureness", "How sure", describe_sureness(study, curve));
        add("limit", "What limits it", describe_limit(curve));
        add("more", "More poses for 20 % less", describe_more(curve.points));
    }
    return answers;
}

}  // namespace posewise
