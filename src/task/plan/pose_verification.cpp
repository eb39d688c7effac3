#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/format.hpp"
#include "core/text.hpp"
#include "planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "selection/bound.hpp"
#include "task/calibration/findings.hpp"
#include "verification_poses.hpp"

namespace posewise {
namespace {

using detail::Findings;
using detail::PlanningProblem;

/// Information of many poses is summed in another order than when it was planned.
constexpr double rounding = 1e-6;

/// Where the least clearance that a pose states is another.
std::string find_fault_of_clearance(const Constraints& constraints, const PlannedPose& pose) {
    if (!pose.clearance) return "";
    const auto describe = [](const Clearance& clearance) {
        return fmt::format("{} mm, {} to {}", detail::format_mm(clearance.distance), clearance.body,
                           clearance.other);
    };
    const Clearance& stated = *pose.clearance;
    const Clearance nearest = constraints.nearest(pose.configuration);
    if (std::abs(nearest.distance - stated.distance) <= rounding && nearest.body == stated.body &&
        nearest.other == stated.other) {
        return "";
    }
    return fmt::format("states as nearest {}, is {}", describe(stated), describe(nearest));
}

/// What is wrong with a pose; empty if nothing is.
std::string find_fault(const PlanningProblem& problem, const PlannedPose& pose) {
    const std::string violation = detail::describe_violation(problem, pose);
    if (!violation.empty()) return violation;
    if (pose.via) {
        const std::string fault = describe_violation(problem.constraints, *pose.via, Stop::Via);
        if (!fault.empty()) return "has a via that " + fault;
    }
    return find_fault_of_clearance(problem.constraints, pose);
}

void check_poses(const PlanningProblem& problem, const std::vector<PlannedPose>& poses,
                 Findings& findings) {
    const double least = problem.constraints.cell().least_joint_distance;
    bool is_right = true;
    const auto blame = [&](const PlannedPose& pose, const std::string& fault) {
        findings.note("poses", false, detail::quote(pose.id) + ' ' + fault);
        is_right = false;
    };
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::string fault = find_fault(problem, poses[i]);
        if (!fault.empty()) blame(poses[i], fault);
        for (std::size_t k = 0; k < i; ++k) {
            const double distance = joint_distance(poses[i].configuration, poses[k].configuration);
            if (distance >= least - rounding) continue;
            blame(poses[i], fmt::format("is nearer to {} than least_joint_distance allows, {} deg",
                                        detail::quote(poses[k].id),
                                        detail::format_short(to_degrees(distance))));
        }
    }
    if (is_right) findings.note("poses", true, fmt::format("{}, all feasible", poses.size()));
}

/// Those that the calibration is to be judged on: feasible, and apart from all others.
void check_verification(const PlanningProblem& problem, const Plan& plan, Findings& findings) {
    if (plan.verification.empty()) return;
    const double least = detail::verification_distance(problem);
    std::vector<PlannedPose> others = plan.poses;
    bool is_right = true;
    for (const PlannedPose& pose : plan.verification) {
        std::string fault = find_fault(problem, pose);
        for (const PlannedPose& other : others) {
            const double distance = joint_distance(pose.configuration, other.configuration);
            if (!fault.empty() || distance >= least - rounding) continue;
            fault = fmt::format("is {} deg from {}, must be {} away",
                                detail::format_short(to_degrees(distance)), detail::quote(other.id),
                                detail::format_short(to_degrees(least)));
        }
        others.push_back(pose);
        if (fault.empty()) continue;
        findings.note("verification", false, detail::quote(pose.id) + ' ' + fault);
        is_right = false;
    }
    if (!is_right) return;
    findings.note("verification", true,
                  fmt::format("{}, all feasible and apart", plan.verification.size()));
}

void check_value(const Plan& plan, const PlanningProblem& problem, const Blocks& blocks,
                 Findings& findings) {
    findings.compare_value(problem.search.criterion, plan.value, detail::value_of(problem, blocks),
                           rounding);
}

/// Each parameter's, which the plan must state, and no other.
void check_deviations(const Plan& plan, const PlanningProblem& problem, const MatrixXd& M,
                      Findings& findings) {
    const auto deviations = detail::standard_deviations(problem.campaign, M);
    const auto& stated = plan.standard_deviations;
    if (stated.size() != deviations.size()) {
        findings.note(
            "deviations", false,
            fmt::format("stated of {}, the campaign has {}",
                        detail::count_of(std::ssize(stated), "parameter"), deviations.size()));
    }
    bool is_right = stated.size() == deviations.size();
    for (const NamedNumber& one : deviations) {
        const auto found = std::find_if(stated.begin(), stated.end(),
                                        [&](const auto& other) { return other.name == one.name; });
        if (found != stated.end() &&
            detail::is_same_value(Criterion::A, found->value, one.value, rounding)) {
            continue;
        }
        is_right = false;
        findings.note(
            "deviations", false,
            fmt::format("of {}: stated {}, is {}", one.name,
                        found != stated.end() ? detail::format_short(found->value) : "none",
                        detail::format_short(one.value)));
    }
    if (is_right) findings.note("deviations", true, fmt::format("as stated, {}", stated.size()));
}

void check_prediction(const Plan& plan, const PlanningProblem& problem, const Blocks& blocks,
                      Findings& findings) {
    const PredictedAccuracy stated = plan.predicted.value_or(PredictedAccuracy{});
    const MatrixXd M = held_information(problem) + information(blocks);
    const PredictedAccuracy accuracy = predict_accuracy(problem.errors.by_parameters, M);
    const auto compare = [&](const char* name, double before, double now) {
        findings.compare(name, mm_per_m * before, mm_per_m * now,
                         detail::is_same_value(Criterion::A, before, now, rounding));
    };
    compare("RMS/mm", stated.rms, accuracy.rms);
    compare("95 %/mm", stated.percentile95, accuracy.percentile95);
    check_deviations(plan, problem, M, findings);
}

/// What can be said without what proves them.
void check_bounds(const Plan& plan, const PlanningProblem& problem, Findings& findings) {
    const Criterion criterion = problem.search.criterion;
    const Index counted =
        parameter_count(problem.campaign) - static_cast<Index>(problem.search.nuisance.size());
    bool is_right = true;
    const auto check = [&](const char* name, double value, double bound, double stated) {
        const double actual = detail::efficiency(criterion, value, bound, counted);
        const bool is_above =
            value > bound && !detail::is_same_value(criterion, value, bound, rounding);
        if (is_above) findings.compare(name, bound, value, false);
        const bool agrees = std::abs(stated - actual) <= rounding;
        if (!agrees) findings.compare(std::string(name) + " efficiency", stated, actual, false);
        is_right = is_right && !is_above && agrees;
    };
    check("pool bound", plan.choice_value, plan.bound, plan.efficiency);
    check("searched bound", plan.value, plan.searched_bound, plan.searched_efficiency);
    if (!is_right) return;
    findings.note("bounds", true,
                  "agree with values and efficiencies; the file does not hold what proves them");
}

}  // namespace

double detail::value_of(const PlanningProblem& problem, const Blocks& blocks) {
    SelectOptions options;
    options.criterion = problem.search.criterion;
    options.pose_count = blocks.count();
    if (needs_test_poses(options.criterion)) options.test_poses = &problem.errors.by_parameters;
    options.nuisance = problem.search.nuisance;
    options.held_rows = problem.search.held.rows;
    options.held_pose_count = problem.search.held_pose_count;
    std::vector<Index> all(static_cast<std::size_t>(blocks.count()));
    std::iota(all.begin(), all.end(), Index{0});
    return choice_value(blocks, options, all);
}

Verification verify(const Plan& plan, const Campaign& campaign, const PlanningOptions& options) {
    PlanningProblem problem = detail::state_planning(campaign, options);
    detail::draw_workspace(problem, options);
    const std::string mismatch = describe_mismatch(plan, campaign);
    if (!mismatch.empty()) throw InputError(mismatch);
    return detail::collect(static_cast<Index>(plan.poses.size()), [&](Findings& findings) {
        check_poses(problem, plan.poses, findings);
        check_verification(problem, plan, findings);
        if (!findings.has_same_parameters(plan, problem.campaign)) return;
        const Blocks blocks = detail::blocks_of(problem, plan.poses);
        check_value(plan, problem, blocks, findings);
        check_prediction(plan, problem, blocks, findings);
        findings.compare_assumptions(plan, problem.campaign);
        check_bounds(plan, problem, findings);
    });
}

}  // namespace posewise
