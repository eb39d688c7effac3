#include "plan_report.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <numeric>
#include <set>

#include "common.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/units.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::cli {
namespace {

constexpr Index pool_part = 1500;  // searched for other numbers of poses

/// Further lines begin below the text of the first.
std::string indent_lines(const std::string& text) {
    std::string indented;
    for (const char c : text) {
        indented += c;
        if (c == '\n') indented += std::string(13, ' ');
    }
    return indented.substr(0, indented.find_last_not_of(" \n") + 1);
}

/// A criterion's value; V and G are inverse mean and worst squares of position errors.
std::string format_value(Criterion criterion, double value) {
    const bool has_unit = needs_test_poses(criterion);
    return format_short(value, 8) + (has_unit ? " /m^2" : "");
}

std::string describe_pool(const Pool& pool) {
    std::string text = fmt::format("{} of {} candidates are feasible", pool.configurations.rows(),
                                   pool.candidate_count);
    const std::string rejections = describe_rejections(pool);
    if (!rejections.empty()) text += "; the others violate\n" + rejections;
    return indent_lines(text);
}

std::string describe_counts(const PlanningProblem& problem) {
    std::string text = fmt::format("{} new", problem.options.pose_count);
    if (!problem.kept.empty()) text += fmt::format(", {} kept", problem.kept.size());
    if (problem.measured_count > 0) {
        text += fmt::format(", {} measured already", problem.measured_count);
    }
    if (problem.request.has_prior) text += ", prior: the scale as standard deviation";
    return text;
}

std::string describe_searched_bound(const io::PosePlanFile& file) {
    if (!std::isfinite(file.searched_bound)) {
        return file.is_interrupted ? "not searched, stopped before"
                                   : "not searched, there is no such bound for this criterion";
    }
    return fmt::format("{}, efficiency {}: by a search, not a proof",
                       format_value(file.request.criterion, file.searched_bound),
                       format_fixed(file.searched_efficiency, 4));
}

std::string describe_order(const Tour& tour) {
    std::string text = fmt::format(
        "{} s, {} % shorter than as planned ({} s); to the nearest pose each: {} s",
        format_fixed(tour.time, 1),
        format_fixed(100 * (1 - tour.time / tour.planning_order_time), 0),
        format_fixed(tour.planning_order_time, 1), format_fixed(tour.nearest_neighbour_time, 1));
    if (tour.blocked_count > 0) {
        text += fmt::format("\n{} moves are blocked: find a way by hand", tour.blocked_count);
    }
    return indent_lines(text);
}

std::string format_joint(const Campaign& campaign, Index joint, double value) {
    return format_fixed(units_of(campaign.robot.joint(joint).motion).to_reading(value), 2);
}

std::string describe_way(const Campaign& campaign, const io::ContinuousPose& pose) {
    if (pose.is_blocked) return "BLOCKED";
    if (!pose.via) return "straight";
    std::string text = "via";
    for (Index j = 0; j < pose.via->size(); ++j) {
        text += ' ' + format_joint(campaign, j, (*pose.via)[j]);
    }
    return text;
}

Table pose_table(const Campaign& campaign, const std::vector<io::ContinuousPose>& poses) {
    Table table{{"pose"}, {}};
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        const Joint& joint = campaign.robot.joint(j);
        table.header.push_back(fmt::format("{}/{}", joint.name, units_of(joint.motion).reading));
    }
    table.header.insert(table.header.end(), {"targets seen", "way there"});
    for (const io::ContinuousPose& pose : poses) {
        std::vector<std::string> row{pose.id};
        for (Index j = 0; j < pose.joints.size(); ++j) {
            row.push_back(format_joint(campaign, j, pose.joints[j]));
        }
        const Index targets = campaign.sensor->target_count();
        row.insert(row.end(), {target_numbers(seen_targets(pose.visible, targets)),
                               describe_way(campaign, pose)});
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// A part of the pool, ready for quick selections.
struct PoolPart {
    Blocks blocks;
    SelectOptions options;
    MatrixXd held;
};

PoolPart take_part(const PlanningProblem& problem) {
    PoolPart part;
    const Index count = std::min(problem.pool.configurations.rows(), pool_part);
    part.blocks = make_blocks(
        problem.campaign, problem.campaign.nominal, problem.pool.configurations.topRows(count),
        times_seen(problem.pool.is_seen.topRows(count), problem.request.repeats));
    SelectOptions& options = part.options;
    options.criterion = problem.options.criterion;
    if (options.criterion == Criterion::G) options.criterion = Criterion::V;  // much quicker
    if (options.criterion == Criterion::V) options.test_poses = &problem.prediction;
    options.nuisance = problem.options.nuisance;
    options.held = problem.options.held.information;
    options.held_pose_count = problem.options.held_pose_count;
    options.starts = 1;
    options.kicks = 0;
    options.enumeration = 0;
    options.gap = 1e-2;
    options.seed = problem.request.seed;
    part.held = options.held;
    const Index L = part.blocks.parameter_count();
    if (part.held.size() == 0) part.held.setZero(L, L);
    return part;
}

std::vector<std::string> accuracy_row(const PlanningProblem& problem, PoolPart& part, Index count) {
    std::vector<std::string> row{std::to_string(count), "chosen from the pool"};
    part.options.pose_count = count;
    try {
        const Choice plan = select_poses(part.blocks, part.options);
        const PredictedAccuracy accuracy =
            predict_accuracy(problem.prediction, part.held + information(part.blocks, plan.poses));
        row.insert(row.end(), {format_mm(accuracy.rms), format_mm(accuracy.percentile95)});
    } catch (const InputError&) {
        row.insert(row.end(), {"-", "-"});  // too few to identify, or more than the pool has
    }
    return row;
}

}  // namespace

VectorXd standard_deviations(const Campaign& campaign, const MatrixXd& M) {
    const MatrixXd covariance = M.llt().solve(MatrixXd::Identity(M.rows(), M.cols()));
    return covariance.diagonal().cwiseSqrt().cwiseProduct(parameter_scale(campaign));
}

void print_pose_plan(const PlanningProblem& problem, const io::PosePlanFile& file,
                     const Tour& tour) {
    print(fmt::format("pool:        {}\nposes:       {}\ncriterion:   {}\nvalue:       {}\n",
                      describe_pool(problem.pool), describe_counts(problem),
                      criterion_name(file.request.criterion),
                      format_value(file.request.criterion, file.value)));
    print(fmt::format(
        "predicted:   position error {} mm RMS, 95 % are below {} mm, over {} workspace poses\n",
        format_mm(file.predicted_rms), format_mm(file.predicted_p95), problem.workspace_count));
    print(
        fmt::format("pool bound:  {}, proven: no choice from the pool has a larger value\n"
                    "best choice: {} from the pool, efficiency {} proven\n",
                    format_value(file.request.criterion, file.pool_bound),
                    format_value(file.request.criterion, file.pool_value),
                    format_fixed(file.pool_efficiency, 4)));
    const std::string looseness =
        describe_looseness(file.pool_efficiency, file.starts_at_best, file.request.starts);
    if (!looseness.empty()) print("note:        " + looseness + '\n');
    print(fmt::format("searched:    {}\nstarts:      {} of {} ended at the best\norder:       {}\n",
                      describe_searched_bound(file), file.starts_at_best, file.request.starts,
                      describe_order(tour)));
    print_section("Poses, in the order to visit them", pose_table(problem.campaign, file.poses));
}

void print_other_counts(const PlanningProblem& problem, const PredictedAccuracy& planned) {
    PoolPart part = take_part(problem);
    const Index count = problem.options.pose_count;
    Table table{{"new poses", "how", "RMS/mm", "95 %/mm"}, {}};
    for (const Index k : std::set<Index>{std::max<Index>(1, count / 2), count, 2 * count}) {
        table.rows.push_back(accuracy_row(problem, part, k));
        if (k != count) continue;
        table.rows.push_back({std::to_string(k), "planned", format_mm(planned.rms),
                              format_mm(planned.percentile95)});
    }
    print_section("Predicted position error by number of poses", table);
}

void print_deviations(const Campaign& campaign, const VectorXd& standard_deviations) {
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    Table table{{"parameter", "std dev", ""}, {}};
    for (std::size_t k = 0; k < names.size(); ++k) {
        table.rows.push_back(
            {names[k], format_fixed(mm_per_m * standard_deviations[static_cast<Index>(k)], 4),
             std::string(units_of(is_angle[k]).error)});
    }
    print_section("Expected standard deviation of each parameter", table);
}

}  // namespace posewise::cli
