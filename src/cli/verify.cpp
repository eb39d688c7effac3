#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/pose_plan_file.hpp"
#include "posewise/selection/bound.hpp"
#include "selection_problem.hpp"
#include "verify_poses.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise verify measurements.plan.json

Computes a plan's value, bound and efficiency again, from the files the plan names and its
certificate, whatever made the plan: no search, no optimiser. Says of each whether it is as stated:
  value:      as stated, -12.345678
  bound:      stated -11.9, is -12.1
and checks the candidates (a changed file is noticed by its checksum), the poses and the limits the
plan was made under. Where a plan claims to be optimal beyond its certificate, all other choices
were ruled out or tried; that search is made again.
Of a pose plan, as plan writes it, checks every pose (joint limits, the cell's constraints, targets
seen), the value and the predicted accuracy; its bounds are not proven by what the file holds.
Exit code: 0 everything is as stated, 1 something is not.)";

struct Arguments {
    std::string plan;
    std::string campaign;
    std::string candidates;
    std::string augment;
    std::string groups;
    std::string test_poses;
};

/// To rounding, which differs between processors; D is a logarithm, so its zero means nothing.
bool agree(Criterion criterion, double a, double b) { return is_same_value(criterion, a, b, 1e-8); }

void check_candidates(const io::PlanFile& file, const SelectionProblem& problem,
                      Findings& findings) {
    const Index count = problem.blocks.count();
    if (file.candidate_count != count) {
        findings.note("candidates", false,
                      fmt::format("stated {}, are {}", file.candidate_count, count));
    } else if (file.checksum != problem.checksum) {
        findings.note("candidates", false,
                      "changed since the plan was made, by their checksum (or the checksum was)");
    } else {
        findings.note("candidates", true, fmt::format("as stated, {}", count));
    }
}

/// Candidate indices of the plan's poses, repeats listed.
std::vector<Index> find_poses(const io::PlanFile& file, const SelectionProblem& problem,
                              Findings& findings) {
    const CandidateIndex index(problem.ids);
    std::vector<Index> poses;
    for (std::size_t k = 0; k < file.poses.size(); ++k) {
        const io::PlannedPose& pose = file.poses[k];
        const Index candidate = index.find(pose.id, fmt::format("poses[{}].id:", k));
        const bool has_same_joints =
            !problem.campaign ||
            (pose.joints.size() == problem.configurations.cols() &&
             pose.joints.isApprox(problem.configurations.row(candidate).transpose(), 1e-9));
        if (!has_same_joints) {
            findings.note("poses", false, "joints of '" + pose.id + "' are not the candidate's");
        }
        const Index copies = std::min(pose.times, file.request.pose_count + 1);
        poses.insert(poses.end(), static_cast<std::size_t>(copies), candidate);
    }
    std::sort(poses.begin(), poses.end());
    return poses;
}

/// Where a choice breaks the limits it was made under; one line each.
std::vector<std::string> find_violations(const SelectionProblem& problem,
                                         const std::vector<Index>& poses) {
    const SelectOptions& options = problem.options;
    const auto id = [&](Index pose) { return problem.ids[static_cast<std::size_t>(pose)]; };
    std::vector<std::string> violations;
    std::map<Index, Index> times;
    std::map<Index, Index> group_sizes;
    for (const Index pose : poses) {
        ++times[pose];
        if (!options.groups.empty()) ++group_sizes[options.groups[static_cast<std::size_t>(pose)]];
    }
    for (const auto& [pose, count] : times) {
        if (count > options.repeat_limit) {
            violations.push_back(fmt::format("'{}' is taken {} times, at most {} are allowed",
                                             id(pose), count, options.repeat_limit));
        }
        if (std::find(options.excluded.begin(), options.excluded.end(), pose) !=
            options.excluded.end()) {
            violations.push_back(fmt::format("'{}' is excluded or measured already", id(pose)));
        }
        for (const auto& [other, unused] : times) {
            if (other >= pose || options.least_distance == 0) continue;
            const double distance =
                (options.positions.row(pose) - options.positions.row(other)).norm();
            if (distance < options.least_distance) {
                violations.push_back(fmt::format("'{}' and '{}' are {} deg apart, too near",
                                                 id(other), id(pose),
                                                 format_short(to_degrees(distance))));
            }
        }
    }
    for (const auto& [group, count] : group_sizes) {
        if (count > options.group_limit) {
            violations.push_back(fmt::format("{} are of one group, at most {} are allowed", count,
                                             options.group_limit));
        }
    }
    return violations;
}

void check_poses(const SelectionProblem& problem, const std::vector<Index>& poses,
                 Findings& findings) {
    const auto count = static_cast<Index>(poses.size());
    const auto violations = find_violations(problem, poses);
    for (const std::string& violation : violations) findings.note("poses", false, violation);
    if (count != problem.options.pose_count) {
        findings.note("poses", false,
                      fmt::format("stated {}, are {}", problem.options.pose_count, count));
    } else if (violations.empty()) {
        findings.note("poses", true, fmt::format("{}, within the limits", count));
    }
}

/// Whether a search like the plan's own finds again that no choice is better.
bool is_optimal_again(const Choice& stated, const SelectionProblem& problem, double value) {
    SelectOptions options = problem.options;
    options.seed = stated.seed;
    options.starts = stated.starts;
    const Choice again = select_poses(problem.blocks, options);
    return again.ending == Ending::Optimal && agree(again.criterion, again.value, value);
}

/// The bound that the certificate proves.
double prove_bound(const Choice& stated, const SelectionProblem& problem, Findings& findings) {
    const Index L = problem.blocks.parameter_count();
    const Index size = stated.certificate.M.rows();
    if (size == L && stated.certificate.sharpness > 0) {
        return upper_bound(problem.blocks, problem.options, stated.certificate);
    }
    findings.note("certificate", size == 0,
                  size == 0 ? "none, so nothing is proven"
                            : fmt::format("is {} x {}, must be {} x {}", size, size, L, L));
    return std::numeric_limits<double>::infinity();
}

void check_numbers(const Choice& stated, const SelectionProblem& problem,
                   const std::vector<Index>& poses, Findings& findings) {
    const Criterion criterion = problem.options.criterion;
    const double value = choice_value(problem.blocks, problem.options, poses);
    findings.compare("value", stated.value, value, agree(criterion, stated.value, value));

    double bound = std::max(value, prove_bound(stated, problem, findings));
    const bool claims_optimum = stated.ending == Ending::Optimal &&
                                !agree(criterion, stated.bound, bound) && stated.bound < bound;
    if (claims_optimum && agree(criterion, stated.bound, value) &&
        is_optimal_again(stated, problem, value)) {
        bound = value;
        findings.note("optimum", true, "found again; all other choices are ruled out or tried");
    }
    findings.compare("bound", stated.bound, bound, agree(criterion, stated.bound, bound));
    const auto nuisance = static_cast<Index>(problem.options.nuisance.size());
    const double actual =
        efficiency(criterion, value, bound, problem.blocks.parameter_count() - nuisance);
    findings.compare("efficiency", stated.efficiency, actual,
                     std::abs(stated.efficiency - actual) <= 1e-8);
}

io::SelectionRequest redirect(io::SelectionRequest request, const Arguments& arguments) {
    const auto redirect_one = [](std::string& path, const std::string& other) {
        if (!other.empty()) path = other;
    };
    redirect_one(request.source.campaign, arguments.campaign);
    redirect_one(request.source.path, arguments.candidates);
    redirect_one(request.augment, arguments.augment);
    redirect_one(request.groups, arguments.groups);
    redirect_one(request.test_poses, arguments.test_poses);
    return request;
}

void verify_selection(const Arguments& arguments) {
    const io::PlanFile file = io::read_plan(arguments.plan);
    const SelectionProblem problem = read_problem(redirect(file.request, arguments));
    print(fmt::format("{}: {} of {} candidates by {}\n", arguments.plan, file.request.pose_count,
                      problem.blocks.count(), criterion_name(file.request.criterion)));
    Findings findings;
    check_candidates(file, problem, findings);
    const std::vector<Index> poses = find_poses(file, problem, findings);
    check_poses(problem, poses, findings);
    check_numbers(file.plan, problem, poses, findings);
    if (problem.campaign) check_assumptions(arguments.plan, *problem.campaign, findings);
    findings.conclude(arguments.plan);
}

void verify(const Arguments& arguments) {
    if (!io::is_pose_plan(arguments.plan)) return verify_selection(arguments);
    if (!(arguments.candidates + arguments.groups + arguments.test_poses).empty()) {
        throw CLI::ValidationError("PLAN", "is a pose plan, which takes --campaign and --augment");
    }
    verify_pose_plan(arguments.plan, arguments.campaign, arguments.augment);
}

}  // namespace

void add_verify(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("verify", "Check a plan's value, bound and efficiency");
    command->add_option("PLAN", arguments->plan, "Plan file, as select or plan writes it")
        ->required()
        ->check(file_name());
    command->add_option("--campaign", arguments->campaign, "Campaign file, if it is elsewhere now");
    command->add_option("-m,--measurements,--candidates,--blocks", arguments->candidates,
                        "File of the candidates, if it is elsewhere now");
    command->add_option("--augment", arguments->augment, "As of select, if it is elsewhere now");
    command->add_option("--groups", arguments->groups, "As of select, if it is elsewhere now");
    command->add_option("--test-poses", arguments->test_poses,
                        "As of select, if it is elsewhere now");
    command->footer(footer);
    command->callback([arguments] { verify(*arguments); });
}

}  // namespace posewise::cli
