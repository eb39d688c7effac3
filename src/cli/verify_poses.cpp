#include "verify_poses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common.hpp"
#include "findings.hpp"
#include "planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/text.hpp"
#include "posewise/core/units.hpp"
#include "posewise/selection/bound.hpp"

namespace posewise::cli {
namespace {

/// Information of many poses is summed in another order than when it was planned.
constexpr double rounding = 1e-6;

PlanningArguments arguments_of(io::PosePlanRequest request, const std::string& campaign,
                               const std::string& augment) {
    PlanningArguments arguments;
    arguments.criterion = criterion_name(request.criterion);
    arguments.prior = request.has_prior;
    arguments.seed = request.seed;
    if (!campaign.empty()) request.campaign = campaign;
    if (!augment.empty()) request.augment = augment;
    arguments.request = std::move(request);
    return arguments;
}

/// What is wrong with a pose; empty if nothing is.
std::string find_fault(const PlanningProblem& problem, const io::ContinuousPose& pose) {
    const std::string violation = describe_violation(problem.constraints, pose.joints);
    if (!violation.empty()) return violation;
    if (pose.visible.empty()) return "shows no target";
    const std::vector<Index> visible = visible_targets(problem, pose.joints);
    for (const Index target : pose.visible) {
        if (std::find(visible.begin(), visible.end(), target) != visible.end()) continue;
        return fmt::format("does not show target {}", target + 1);
    }
    return "";
}

void check_poses(const PlanningProblem& problem, const std::vector<io::ContinuousPose>& poses,
                 Findings& findings) {
    const double least = problem.constraints.cell().least_joint_distance;
    bool is_right = true;
    const auto blame = [&](const io::ContinuousPose& pose, const std::string& fault) {
        findings.note("poses", false, quote(pose.id) + ' ' + fault);
        is_right = false;
    };
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const std::string fault = find_fault(problem, poses[i]);
        if (!fault.empty()) blame(poses[i], fault);
        for (std::size_t k = 0; k < i; ++k) {
            const double distance = joint_distance(poses[i].joints, poses[k].joints);
            if (distance >= least - rounding) continue;
            blame(poses[i], fmt::format("is nearer to {} than least_joint_distance allows, {} deg",
                                        quote(poses[k].id), format_short(to_degrees(distance))));
        }
    }
    if (is_right) findings.note("poses", true, fmt::format("{}, all feasible", poses.size()));
}

void check_numbers(const PlanningProblem& problem, const io::PosePlanFile& file,
                   Findings& findings) {
    const Blocks blocks = blocks_of(problem, file.poses);
    SelectOptions options;
    options.criterion = file.request.criterion;
    options.pose_count = blocks.count();
    const bool has_tests = needs_test_poses(options.criterion);
    if (has_tests) options.test_poses = &problem.prediction;
    options.nuisance = problem.options.nuisance;
    options.held = problem.options.held.information;
    options.held_pose_count = problem.options.held_pose_count;
    std::vector<Index> all(file.poses.size());
    std::iota(all.begin(), all.end(), Index{0});
    const double value = choice_value(blocks, options, all);
    findings.compare("value", file.value, value,
                     is_same_value(options.criterion, file.value, value, rounding));
    const MatrixXd held = options.held.size() > 0
                              ? options.held
                              : MatrixXd::Zero(blocks.parameter_count(), blocks.parameter_count());
    const PredictedAccuracy accuracy =
        predict_accuracy(problem.prediction, held + information(blocks));
    for (const auto& [name, stated, actual] :
         {std::tuple{"RMS/mm", file.predicted_rms, accuracy.rms},
          std::tuple{"95 %/mm", file.predicted_p95, accuracy.percentile95}}) {
        findings.compare(name, mm_per_m * stated, mm_per_m * actual,
                         is_same_value(Criterion::A, stated, actual, rounding));
    }
}

}  // namespace

void verify_pose_plan(const std::string& path, const std::string& campaign,
                      const std::string& augment) {
    const PlanningProblem problem =
        state_planning_problem(arguments_of(io::read_pose_plan_request(path), campaign, augment));
    const io::PosePlanFile file = io::read_pose_plan(path, problem.campaign);
    print(fmt::format("{}: {} poses by {}\n", path, file.poses.size(),
                      criterion_name(file.request.criterion)));
    Findings findings;
    check_poses(problem, file.poses, findings);
    check_numbers(problem, file, findings);
    check_assumptions(path, problem.campaign, findings);
    findings.note("bounds", true, "not checked, the file does not hold what proves them");
    findings.conclude(path);
}

}  // namespace posewise::cli
