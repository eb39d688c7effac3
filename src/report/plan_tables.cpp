#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "sentences.hpp"
#include "table.hpp"
#include "target_report.hpp"

namespace posewise {
namespace {

using detail::Table;

/// How many starts agree; those that a stop cut short tell nothing.
std::string describe_starts(const Plan& plan, const char* where) {
    if (plan.request.starts == 0) return "none ended before the stop";
    return fmt::format("{} of {} ended {}{}", plan.starts_at_best, plan.request.starts, where,
                       plan.starts_at_best > 0 ? "" : " (found after them)");
}

/// Says, where little is proven about a plan, what tells more.
std::string describe_bound(const Plan& plan) {
    return detail::describe_looseness(plan.efficiency, plan.starts_at_best, plan.request.starts);
}

/// What the bound says, in words, where the numbers alone may mislead.
std::string describe_proof(const Plan& plan) {
    if (plan.ending == Ending::Optimal && plan.tried > 0) {
        return fmt::format(
            "proof:      optimal: bounds rule out all other choices but {}, which were tried\n",
            plan.tried);
    }
    if (plan.ending == Ending::Optimal) {
        return "proof:      optimal: every other choice is ruled out by the bound or was tried\n";
    }
    std::string text;
    if (plan.tried > 0) {
        text = fmt::format("proof:      not finished: {} of those that bounds left open tried\n",
                           detail::count_of(plan.tried, "choice"));
    }
    const std::string looseness = describe_bound(plan);
    return looseness.empty() ? text : text + "note:       " + looseness + '\n';
}

/// Further lines begin below the text of the first.
std::string indent_lines(const std::string& text) {
    std::string indented;
    for (const char c : text) {
        indented += c;
        if (c == '\n') indented += std::string(13, ' ');
    }
    return indented.substr(0, indented.find_last_not_of(" \n") + 1);
}

/// A value of the plan's criterion. Of continuous plans V and G are inverse mean and worst squares
/// of position errors, of choices they are those of whitened ones, which have no unit.
std::string format_value(const Plan& plan, double value, int digits = 8) {
    const bool is_of_positions = plan.is_continuous() && needs_test_poses(plan.request.criterion);
    return detail::format_short(value, digits) + (is_of_positions ? " /m^2" : "");
}

/// The plan's value, and what it says in mm where it does.
std::string describe_value(const Plan& plan, int digits = 8) {
    const std::string value = format_value(plan, plan.value, digits);
    if (!plan.value_rms) return value;
    return fmt::format("{} (predicted {} mm RMS{} by the parameters)", value,
                       detail::format_mm(*plan.value_rms),
                       plan.request.criterion == Criterion::G ? " at the worst pose" : "");
}

std::string describe_pool(const Pool& pool) {
    std::string text = fmt::format("{} of {} are feasible", pool.configurations.rows(),
                                   detail::count_of(pool.candidate_count, "candidate"));
    const std::string rejections = describe_rejections(pool);
    if (!rejections.empty()) text += "; the others violate\n" + rejections;
    return indent_lines(text);
}

std::string describe_counts(const Planning& planning) {
    const Index new_count = planning.search.pose_count;
    const Index kept = static_cast<Index>(planning.plan.poses.size()) - new_count;
    std::string text = fmt::format("{} new", new_count);
    if (kept > 0) text += fmt::format(", {} kept", kept);
    if (planning.measured_count > 0) {
        text += fmt::format(", {} measured already", planning.measured_count);
    }
    if (planning.plan.request.has_prior) {
        text += planning.campaign.prior ? ", prior: that of an earlier estimate"
                                        : ", prior: the scale as standard deviation";
    }
    return text;
}

std::string describe_searched_bound(const Plan& plan) {
    if (!std::isfinite(plan.searched_bound)) {
        return plan.is_stopped_early()
                   ? "not searched, stopped before"
                   : "not searched: there is none for this criterion, or where poses must touch";
    }
    return fmt::format("{}, efficiency {}: by a search, not a proof",
                       format_value(plan, plan.searched_bound),
                       detail::format_fixed(plan.searched_efficiency, 4));
}

std::string describe_order(const Tour& tour, double random_order) {
    const std::string time = detail::format_fixed(tour.time, 1);
    const std::string nearest = detail::format_fixed(tour.nearest_neighbour_time, 1);
    std::string text =
        random_order > 0
            ? fmt::format(
                  "{} s, at random; the shortest found: {} s; to the nearest pose each: "
                  "{} s",
                  time, detail::format_fixed(tour.shortest_time, 1), nearest)
            : fmt::format(
                  "{} s, {} % shorter than as planned ({} s); to the nearest pose each: {} s", time,
                  detail::format_fixed(100 * (1 - tour.time / tour.planning_order_time), 0),
                  detail::format_fixed(tour.planning_order_time, 1), nearest);
    if (tour.blocked_count > 0) {
        text += fmt::format("\n{} {} blocked: find a way by hand",
                            detail::count_of(tour.blocked_count, "move"),
                            tour.blocked_count == 1 ? "is" : "are");
    }
    return indent_lines(text);
}

/// What the interval is due to: model error and sizes, as surely as they are known.
std::string describe_unknowns(const Plan& plan, const char* line_end) {
    const KnownWithin& known = plan.predicted->known_within;
    if (detail::is_told_by_estimate(plan, known)) {
        return fmt::format("surely as{}the estimate tells that", line_end);
    }
    return fmt::format("that differs{}from robot to robot, within a factor of {} (1 sigma)",
                       line_end, detail::format_short(known.model_error, 3));
}

/// What robots are found to be off by after calibration: not by their parameters alone.
std::string describe_total(const Planning& planning) {
    const PredictedTotal total = predict_total(*planning.plan.predicted);
    return fmt::format(
        "             {} mm with a model error of {} mm a coordinate; {} to {} mm (90 %), as "
        "{}\n",
        detail::format_mm(total.rms),
        detail::format_short(mm_per_m * planning.campaign.model_error),
        detail::format_mm(total.lower), detail::format_mm(total.upper),
        describe_unknowns(planning.plan, "\n             "));
}

std::string describe_made_up(const Campaign& campaign) {
    const std::string targets =
        campaign.has_nominal_targets
            ? ""
            : campaign.sensor->words().key + " made up (state it: the poses depend on it a little)";
    if (campaign.has_nominal_base) return targets;
    return "base not stated, nothing depends on it" + (targets.empty() ? "" : "; " + targets);
}

/// "q1_rad" taken apart; a number without unit has none at its end.
struct Column {
    std::string name;
    const AmountUnits* units = &plain_units;

    explicit Column(const std::string& text) : name(text) {
        for (const AmountUnits* const one : {&length_units, &angle_units, &pixel_units}) {
            const std::string end = fmt::format("_{}", one->si);
            if (!text.ends_with(end)) continue;
            name.resize(text.size() - end.size());
            units = one;
        }
    }
};

std::string format_joint(const std::string& column, double value) {
    return detail::format_fixed(Column(column).units->to_reading(value), 2);
}

std::string describe_way(const Plan& plan, const PlannedPose& pose) {
    if (pose.is_blocked) return "BLOCKED";
    if (!pose.via) return "straight";
    std::string text = "via";
    for (Index j = 0; j < pose.via->size(); ++j) {
        text += ' ' + format_joint(plan.columns[static_cast<std::size_t>(j)], (*pose.via)[j]);
    }
    return text;
}

/// By how much the RMS grows without the pose.
std::string format_pose_value(const Planning& planning, std::size_t pose) {
    const double rms = planning.without_each[pose].rms;
    return std::isfinite(rms) ? detail::format_mm(rms - planning.plan.predicted->rms) : "needed";
}

/// "31.20 target 1 to fence left": the least clearance; empty if none is stated.
std::string describe_nearest(const PlannedPose& pose) {
    if (!pose.clearance) return "";
    const auto& [distance, body, other] = *pose.clearance;
    return detail::escape_controls(detail::format_mm(distance, 2) + ' ' + body + " to " + other);
}

/// What is not kept off obstacles, a line each.
std::string describe_cell_doubts(const Plan& plan) {
    std::string text;
    for (const std::string& doubt : plan.cell_doubts) {
        text += fmt::format("{:<13}{}\n", "cell:", detail::escape_controls(doubt));
    }
    return text;
}

/// What each pose shows is a number of a target, or the name of what it touches.
/// Those to verify have no value.
/// Which targets, by number or name; of a board's many corners how many.
std::string describe_seen(const Planning& planning, const PlannedPose& pose) {
    constexpr Index many = 12;
    const Sensor& sensor = *planning.campaign.sensor;
    if (sensor.target_count() > many) {
        return fmt::format("{} of {}", pose.targets.size(), sensor.target_count());
    }
    const std::vector<std::string> contacts = sensor.contact_names();
    std::string seen;
    for (const Index target : pose.targets) {
        seen += (seen.empty() ? "" : " ") + (contacts.empty()
                                                 ? std::to_string(target + 1)
                                                 : contacts[static_cast<std::size_t>(target)]);
    }
    return seen;
}

Table pose_table(const Planning& planning, const std::vector<PlannedPose>& poses) {
    const Plan& plan = planning.plan;
    const bool has_values = &poses == &plan.poses;
    const std::vector<std::string> contacts = planning.campaign.sensor->contact_names();
    Table table{{"pose"}, {}};
    for (const std::string& text : plan.columns) {
        const Column column(text);
        table.header.push_back(fmt::format("{}/{}", column.name, column.units->reading));
    }
    if (has_values) table.header.emplace_back("value/mm");
    table.header.insert(table.header.end(),
                        {contacts.empty() ? "targets seen" : "socket", "way there"});
    const bool has_clearance = std::ranges::any_of(
        poses, [](const PlannedPose& pose) { return pose.clearance.has_value(); });
    if (has_clearance) table.header.emplace_back("nearest/mm");
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const PlannedPose& pose = poses[i];
        std::vector<std::string> row{pose.id};
        for (Index j = 0; j < pose.configuration.size(); ++j) {
            row.push_back(
                format_joint(plan.columns[static_cast<std::size_t>(j)], pose.configuration[j]));
        }
        if (has_values) row.push_back(format_pose_value(planning, i));
        row.insert(row.end(), {describe_seen(planning, pose), describe_way(plan, pose)});
        if (has_clearance) row.push_back(describe_nearest(pose));
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// How many poses were drawn to judge the calibration on, and how long they take.
std::string describe_verification(const Plan& plan) {
    const Index asked_for = plan.request.verification_count;
    if (asked_for == 0) return "";
    const Index count = std::ssize(plan.verification);
    return fmt::format("verify:      {}{} drawn to judge the calibration on, {} s of moves more\n",
                       count < asked_for ? fmt::format("only {} of ", count) : "",
                       detail::count_of(asked_for, "pose"),
                       detail::format_fixed(plan.verification_time, 1));
}

std::string describe_ids(const Plan& plan) {
    std::string ids;
    for (const PlannedPose& pose : plan.poses) {
        ids += (ids.empty() ? "" : " ") + detail::escape_controls(pose.id);
        if (pose.times > 1) ids += fmt::format(" (x{})", pose.times);
    }
    return ids;
}

std::string describe(const Finding& finding) {
    if (!finding.text.empty()) return finding.text;
    if (finding.is_right) return "as stated, " + detail::format_short(finding.stated, 8);
    return fmt::format("stated {}, is {}", detail::format_short(finding.stated, 12),
                       detail::format_short(finding.actual, 12));
}

/// Nothing of plain blocks.
std::string describe_prediction(const Plan& plan) {
    const std::optional<double> model_error = assumed_model_error(plan);
    if (!plan.predicted || !model_error) return "";
    const PredictedTotal total = predict_total(*plan.predicted);
    return fmt::format(
        "predicted:  {} mm RMS over the candidates by the parameters, {} with a model error of {} "
        "mm;\n            {} to {} (90 %), as {}\n",
        detail::format_mm(plan.predicted->rms), detail::format_mm(total.rms),
        detail::format_short(mm_per_m * *model_error, 4), detail::format_mm(total.lower),
        detail::format_mm(total.upper), describe_unknowns(plan, " "));
}

/// A search that converged from few starts has not said much.
std::string describe_ending(const Plan& plan) {
    constexpr Index telling = 5;  // that starts end alike
    if (plan.ending != Ending::Converged || plan.request.starts >= telling) {
        return std::string(ending_name(plan.ending));
    }
    return "too few to say that none is better (more: --starts)";
}

}  // namespace

std::string format_choice(const Plan& plan, int digits) {
    const bool has_bound = std::isfinite(plan.bound);
    return fmt::format(
        "chosen:     {}\ncriterion:  {}\nvalue:      {}\nbound:      {}\n"
        "efficiency: {}\nstarts:     {}, {}\n{}{}{}",
        describe_ids(plan), criterion_name(plan.request.criterion), describe_value(plan, digits),
        has_bound ? format_value(plan, plan.bound, digits)
                  : "none: rounding leaves nothing to prove",
        has_bound ? detail::format_fixed(plan.efficiency, 4) + " proven" : "unknown",
        describe_starts(plan, "here"), describe_ending(plan), describe_proof(plan),
        describe_prediction(plan), describe_cell_doubts(plan));
}

std::string format(const ApproximateDesign& design, int digits) {
    const PlanRequest& request = design.request;
    Table table{{"candidate", "weight"}, {}};
    for (const auto& [id, weight] : design.weights) {
        table.rows.push_back({id, detail::format_short(weight, digits)});
    }
    const bool has_bound = std::isfinite(design.bound);
    return fmt::format(
               "weights:    of {} of {}, for {}\ncriterion:  {}\nvalue:      {}\n"
               "bound:      {}\nefficiency: {}, {}\n",
               design.weights.size(), detail::count_of(design.candidate_count, "candidate"),
               detail::count_of(request.pose_count, "pose"), criterion_name(request.criterion),
               detail::format_short(design.value, digits),
               has_bound ? fmt::format("{}: no choice of {} has a larger value",
                                       detail::format_short(design.bound, digits),
                                       detail::count_of(request.pose_count, "pose"))
                         : "none: nothing is proven",
               has_bound ? detail::format_fixed(design.efficiency, 6) + " proven" : "unknown",
               ending_name(design.ending)) +
           format_section("Weights, heaviest first", table);
}

std::string format_planning(const Planning& planning) {
    const Plan& plan = planning.plan;
    std::string text =
        fmt::format("pool:        {}\nposes:       {}\ncriterion:   {}\nvalue:       {}\n",
                    describe_pool(planning.pool), describe_counts(planning),
                    criterion_name(plan.request.criterion), describe_value(plan));
    text += fmt::format("predicted:   position error {} mm RMS, 95 % are below {} mm, over {}\n",
                        detail::format_mm(plan.predicted->rms),
                        detail::format_mm(plan.predicted->percentile95),
                        detail::count_of(planning.workspace_count, "workspace pose"));
    text += describe_total(planning);
    if (!planning.campaign.has_nominal_base || !planning.campaign.has_nominal_targets) {
        text += "places:      " + describe_made_up(planning.campaign) + '\n';
    }
    text += fmt::format(
        "pool bound:  {}, proven: no choice from the pool has a larger value\n"
        "best choice: {} from the pool, efficiency {} proven\n",
        format_value(plan, plan.bound), format_value(plan, plan.choice_value),
        detail::format_fixed(plan.efficiency, 4));
    const std::string looseness = describe_bound(plan);
    if (!looseness.empty()) text += "note:        " + looseness + '\n';
    text += fmt::format("searched:    {}\nstarts:      {}\norder:       {}\n",
                        describe_searched_bound(plan), describe_starts(plan, "at the best"),
                        describe_order(planning.tour, planning.plan.request.random_order));
    text += describe_cell_doubts(plan);
    text += detail::describe_duration(planning) + detail::describe_drop_outs(planning);
    text += describe_verification(plan);
    text += format_section("Poses, in the order to visit them", pose_table(planning, plan.poses));
    if (plan.verification.empty()) return text;
    return text + format_section("Poses to judge the calibration on, visited after these",
                                 pose_table(planning, plan.verification));
}

std::string format_other_counts(const std::vector<CountAccuracy>& counts) {
    Table table{{"new poses", "how", "RMS/mm", "95 %/mm", "with model error/mm", "90 % interval"},
                {}};
    for (const CountAccuracy& count : counts) {
        table.rows.push_back(
            {std::to_string(count.pose_count),
             count.is_planned ? "planned" : "chosen from the pool",
             count.accuracy ? detail::format_mm(count.accuracy->rms) : "-",
             count.accuracy ? detail::format_mm(count.accuracy->percentile95) : "-"});
        const auto total =
            count.accuracy ? std::optional(predict_total(*count.accuracy)) : std::nullopt;
        table.rows.back().push_back(total ? detail::format_mm(total->rms) : "-");
        table.rows.back().push_back(
            total ? detail::format_mm(total->lower) + ".." + detail::format_mm(total->upper) : "-");
    }
    return format_section("Predicted position error by number of poses", table);
}

std::string format_deviations(const Plan& plan) {
    Table table{{"parameter", "std dev", ""}, {}};
    for (const NamedNumber& one : plan.standard_deviations) {
        const Column column(one.name);
        table.rows.push_back({column.name, detail::format_fixed(mm_per_m * one.value, 4),
                              std::string(column.units->error)});
    }
    return format_section("Expected standard deviation of each parameter", table);
}

std::string format_findings(const std::vector<Finding>& findings) {
    std::string text;
    for (const Finding& finding : findings) {
        text += fmt::format("{:<11} {}\n", finding.name + ':', describe(finding));
    }
    return text;
}

}  // namespace posewise
