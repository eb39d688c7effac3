#include "target_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "sentences.hpp"
#include "table.hpp"

namespace posewise {
namespace {

using detail::count_of;
using detail::format_mm;
using detail::format_short;
using detail::is_told_by_estimate;
using detail::name_of;
using detail::Table;

constexpr double seconds_per_minute = 60;

std::string minutes(double seconds) {
    return detail::format_fixed(seconds / seconds_per_minute, 1);
}

std::string percent(double part) { return format_short(100 * part) + " %"; }

/// "0.2 mm RMS with 95 %".
std::string describe_limit(const TargetOptions& target) {
    std::string text = fmt::format("{} mm {} with {}", format_short(mm_per_m * *target.limit),
                                   name_of(target.quantity), percent(target.assurance));
    if (target.robust_to > 0) {
        text += fmt::format(", the worst {} missing", count_of(target.robust_to, "pose"));
    }
    return text;
}

/// The plan of one pose less, or without a limit one more, that does not do.
const CountPrediction* next_count(const TargetPlanning& found) {
    const Index count = found.planning->search.pose_count + (found.target.limit ? -1 : 1);
    for (const CountPrediction& one : found.curve) {
        if (one.is_planned && one.pose_count == count) return &one;
    }
    return nullptr;
}

Table curve_table(const TargetPlanning& found) {
    Table table{{"new poses", "how", "expected/mm", "5..95 %/mm",
                 fmt::format("{} below/mm", percent(found.target.assurance)), "minutes"},
                {}};
    for (const CountPrediction& one : found.curve) {
        table.rows.push_back(
            {std::to_string(one.pose_count), one.is_planned ? "planned" : "chosen from the pool"});
        if (one.error) {
            table.rows.back().insert(table.rows.back().end(), {format_mm(one.error->expected),
                                                               format_mm(one.error->lower) + ".." +
                                                                   format_mm(one.error->upper),
                                                               format_mm(one.error->assured)});
        } else {
            table.rows.back().insert(table.rows.back().end(), {"-", "-", "-"});
        }
        table.rows.back().push_back(one.duration > 0 ? minutes(one.duration) : "-");
    }
    return table;
}

/// "9 poses with 5 % probability, more than 60 with 95 %".
std::string describe_counts(const CountRange& counts, double floor, double limit) {
    std::string text = counts.lower ? count_of(*counts.lower, "new pose")
                                    : fmt::format("more than {}", counts.most);
    text += " with 5 % probability, ";
    if (floor > limit) {
        text += fmt::format("no number with 95 % (floor {} mm)", format_mm(floor));
    } else if (counts.upper) {
        text += fmt::format("{} with 95 %", *counts.upper);
    } else {
        text += fmt::format("more than {} with 95 %", counts.most);
    }
    return text;
}

/// "Enough are 14 new poses with 5 % probability, no number with 95 % (floor 0.9 mm); ": where the
/// limit may be kept all the same. Empty: hardly.
std::string describe_luck(const TargetPlanning& found) {
    if (!found.counts || !found.counts->lower) return "";
    return "enough are " + describe_counts(*found.counts, found.floor.upper, *found.target.limit) +
           "; ";
}

/// What would lower the floor.
std::string describe_remedy(const TargetPlanning& found) {
    const bool is_model = found.left_over >= found.repeatability;
    std::string text =
        is_model ? fmt::format(
                       "the largest part is the model error, {} mm expected, of which the "
                       "floor is the {} end; ",
                       format_mm(found.left_over), percent(found.target.assurance))
                 : fmt::format(
                       "the largest part is {} mm by the repeatability of the joints, "
                       "which no calibration mends; ",
                       format_mm(found.repeatability));
    if (!is_model) return text + "half the floor needs a robot that returns twice as well";
    text += "half the floor needs half of it (model_error_mm, what the model leaves of the robot)";
    if (!found.has_error_terms) {
        text += ": more of the robot's errors in the model (errors: full) may leave so little";
    }
    if (found.floor_of_known_model_error < found.floor.assured) {
        text += fmt::format(
            "; once that is known the floor is {} mm: plan --poses 12, measure them, calibrate "
            "--out "
            "estimate.json, and ask again with --from estimate.json --augment of what was measured",
            format_mm(found.floor_of_known_model_error));
    }
    return text;
}

std::string describe_best(const TargetPlanning& found, double longest) {
    const CountPrediction* best = nullptr;
    for (const CountPrediction& one : found.curve) {
        if (one.error && one.duration <= longest) best = &one;
    }
    if (best == nullptr) return "none are expected to do";
    return fmt::format("{} reach {} mm", count_of(best->pose_count, "new pose"),
                       format_mm(best->error->assured));
}

/// The fewest poses that keep the limit; nullptr: none that were looked at.
const CountPrediction* first_within(const TargetPlanning& found) {
    for (const CountPrediction& one : found.curve) {
        if (one.error && one.error->assured <= *found.target.limit) return &one;
    }
    return nullptr;
}

/// What narrows a number that may be off by more than a factor of 2.
std::string describe_narrowing(const TargetPlanning& found) {
    const Planning& planning = *found.planning;
    const CountRange& counts = *found.counts;
    const bool is_narrow = counts.lower && counts.upper && *counts.upper <= 2 * *counts.lower;
    if (is_narrow || is_told_by_estimate(planning.plan, planning.campaign.known_within)) return "";
    return fmt::format(
        "; plan --poses {}, measure them, calibrate --out estimate.json and ask again with --from "
        "estimate.json --augment of what was measured: that knows the robot",
        std::min<Index>(12, planning.search.pose_count));
}

}  // namespace

namespace detail {

const char* name_of(ErrorQuantity quantity) {
    if (quantity == ErrorQuantity::Rms) return "RMS";
    return quantity == ErrorQuantity::Max ? "maximum" : "95 % of positions";
}

std::string condition_of_limit(const TargetPlanning& found) {
    const bool matters = found.planning && found.planning->left_out;
    return matters ? ", if the robot has no errors but those that are fitted" : "";
}

std::string describe_by_hand(const Plan& plan, const Cell& cell) {
    std::string text;
    if (plan.is_target_changed_at_poses) text = "the reflector moved to each target at each pose";
    if (plan.target_runs > 1) {
        text = fmt::format("{} runs, the reflector moved between them", plan.target_runs);
    }
    if (cell.stations == 1) return text;
    return fmt::format("{}{}all at each of {} stations", text, text.empty() ? "" : ", ",
                       cell.stations);
}

std::string describe_duration(const Planning& planning) {
    const Cell& cell = planning.campaign.cell;
    const std::string by_hand = describe_by_hand(planning.plan, cell);
    if (cell.dwell == 0 && cell.settle == 0 && by_hand.empty()) return "";
    const std::string settle =
        cell.settle > 0 ? format_short(cell.settle) + " s at each pose and " : "";
    return fmt::format("time:        {} min with {}{} s for each sample{}{}\n",
                       minutes(planning.plan.duration), settle, format_short(cell.dwell),
                       by_hand.empty() ? "" : ", ", by_hand);
}

std::string describe_drop_outs(const Planning& planning) {
    std::string without;
    std::string left;
    for (const DropOut& one : planning.drop_outs) {
        const std::string& id = planning.plan.poses[static_cast<std::size_t>(one.pose)].id;
        without += (without.empty() ? "" : ", ") + escape_controls(id);
        if (std::isinf(one.rms)) {
            return fmt::format("missing:     without {} not all parameters are identified\n",
                               without);
        }
        left += (left.empty() ? "" : ", ") + format_mm(one.rms);
    }
    if (left.empty()) return "";
    return fmt::format(
        "missing:     without {} the RMS by the parameters is {} instead of {} mm{}\n", without,
        left, format_mm(planning.plan.predicted->rms),
        planning.drop_outs.size() > 1 ? ", each with those before it" : "");
}

}  // namespace detail

std::string format_budget(const Planning& planning) {
    const ErrorBudget& budget = planning.budget;
    Table table{{"part", "RMS/mm", "of the square"}, {}};
    const auto add = [&](const std::string& name, double rms) {
        const double square = budget.total > 0 ? rms * rms / (budget.total * budget.total) : 0;
        table.rows.push_back({name, format_mm(rms), detail::format_fixed(100 * square, 1) + " %"});
    };
    add("parameters, by noise of measuring", budget.noise);
    add("parameters, by the model error", budget.model);
    add("parameters, left of their prior", budget.prior);
    add("left over: the model error itself", budget.left_over);
    add("repeatability of one visit", budget.repeatability);
    add("all", budget.total);
    return detail::format_section("What the position error is expected to consist of", table);
}

std::string format(const TargetPlanning& found) {
    std::string text;
    const Planning& planning = *found.planning;
    const CountPrediction* const next = next_count(found);
    const std::string count = count_of(planning.search.pose_count, "new pose");
    if (found.target.limit) {
        text += fmt::format("target:      {}: {}, {} mm", describe_limit(found.target), count,
                            format_mm(found.error->assured));
        if (next != nullptr) {
            text += fmt::format(" ({}: {} mm)", next->pose_count,
                                next->error ? format_mm(next->error->assured) : "-");
        }
        text += fmt::format("; floor {} mm{}\n", format_mm(found.floor.assured),
                            found.is_settled ? "" : "; stopped early: fewer may do");
        if (found.counts) {
            text +=
                fmt::format("enough:      {}{}\n",
                            describe_counts(*found.counts, found.floor.upper, *found.target.limit),
                            describe_narrowing(found));
        }
    }
    if (found.target.duration) {
        text += fmt::format("time:        {} of {} min for {}", minutes(planning.plan.duration),
                            format_short(*found.target.duration / seconds_per_minute), count);
        if (!found.target.limit && next != nullptr) {
            text += fmt::format(" ({}: {})", next->pose_count, minutes(next->duration));
        }
        if (found.target.limit) text += ": both are kept" + detail::condition_of_limit(found);
        if (!found.target.limit && !found.is_settled) text += "; stopped early: more may fit";
        text += '\n';
    }
    return text;
}

std::string format_curve(const TargetPlanning& found) {
    return detail::format_section(
        fmt::format("Position error ({}) by number of poses, model error and "
                    "repeatability included",
                    name_of(found.target.quantity)),
        curve_table(found));
}

std::string describe_shortfall(const TargetPlanning& found) {
    const TargetOptions& target = found.target;
    const std::string floor =
        fmt::format("floor {} mm ({})", format_mm(found.floor.assured), percent(target.assurance));
    switch (found.ending) {
        case TargetEnding::BelowFloor:
            return fmt::format("{}: unattainable: {}; {}{}", describe_limit(target), floor,
                               describe_luck(found), describe_remedy(found));
        case TargetEnding::TooManyPoses:
            if (const CountPrediction* const enough = first_within(found)) {
                return fmt::format(
                    "{}: about {} would do, as chosen from the pool; plan them with --poses {}; "
                    "{}; {}a larger limit takes fewer",
                    describe_limit(target), count_of(enough->pose_count, "new pose"),
                    enough->pose_count, floor, describe_luck(found));
            }
            return fmt::format(
                "{}: not reached: {}; {}; {}more may be stated (--poses-at-most, --pool)",
                describe_limit(target),
                describe_best(found, std::numeric_limits<double>::infinity()), floor,
                describe_luck(found));
        case TargetEnding::TooLong:
            return fmt::format("{}: not reached in {} min, in which {}; {}", describe_limit(target),
                               format_short(*target.duration / seconds_per_minute),
                               describe_best(found, *target.duration), floor);
        default:
            return "";
    }
}

}  // namespace posewise
