#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/format.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/task/planning.hpp"
#include "selection/bound.hpp"
#include "selection/branch_and_bound.hpp"
#include "task/calibration/findings.hpp"
#include "task/choice/choice_problem.hpp"

namespace posewise {
namespace {

using detail::ChoiceProblem;
using detail::Findings;

constexpr double processor_rounding = 1e-8;  // relative, which differs between processors

bool agree(Criterion criterion, double a, double b, double tolerance = processor_rounding) {
    return detail::is_same_value(criterion, a, b, tolerance);
}

void check_candidates(const Plan& plan, const ChoiceProblem& problem, Findings& findings) {
    const Index count = problem.blocks.count();
    if (plan.candidate_count != count) {
        findings.note("candidates", false,
                      fmt::format("stated {}, are {}", plan.candidate_count, count));
    } else if (plan.checksum != problem.checksum) {
        findings.note("candidates", false,
                      "changed since the plan was made, by their checksum (or the checksum was)");
    } else {
        findings.note("candidates", true, fmt::format("as stated, {}", count));
    }
}

/// Whether the targets that a plan states for a pose, if any, are those its candidate shows.
bool has_same_targets(const ChoiceProblem& problem, const PlannedPose& pose, Index candidate) {
    std::vector<Index> shown;
    for (Index target = 0; target < problem.share.cols(); ++target) {
        if (problem.share(candidate, target) > 0) shown.push_back(target);
    }
    return pose.targets.empty() || pose.targets == shown;
}

/// Candidate indices of the plan's poses, repeats listed (no more than show that there are too
/// many).
std::vector<Index> find_poses(const Plan& plan, const ChoiceProblem& problem, Findings& findings) {
    const detail::CandidateIndex index(problem.ids, detail::ids_of(plan.poses));
    std::vector<Index> poses;
    for (std::size_t k = 0; k < plan.poses.size(); ++k) {
        const PlannedPose& pose = plan.poses[k];
        const Index candidate = index.find(pose.id, fmt::format("poses[{}].id:", k));
        const bool has_same_joints =
            problem.kind == CandidateKind::Blocks ||
            (pose.configuration.size() == problem.configurations.cols() &&
             pose.configuration.isApprox(problem.configurations.row(candidate).transpose(), 1e-9));
        if (!has_same_joints) {
            findings.note("poses", false, "joints of '" + pose.id + "' are not the candidate's");
        }
        if (!has_same_targets(problem, pose, candidate)) {
            findings.note("poses", false, "targets of '" + pose.id + "' are not the candidate's");
        }
        const Index room = plan.request.pose_count + 1 - static_cast<Index>(poses.size());
        const Index copies = std::min(pose.times, std::max<Index>(room, 1));
        poses.insert(poses.end(), static_cast<std::size_t>(copies), candidate);
    }
    std::sort(poses.begin(), poses.end());
    return poses;
}

std::string id_of(const ChoiceProblem& problem, Index pose) {
    return problem.ids[static_cast<std::size_t>(pose)];
}

/// How often each candidate is taken.
std::map<Index, Index> count_each(const std::vector<Index>& poses) {
    std::map<Index, Index> times;
    for (const Index pose : poses) ++times[pose];
    return times;
}

/// Where one candidate breaks limits by itself.
void find_faults(const ChoiceProblem& problem, Index pose, Index times,
                 std::vector<std::string>& violations) {
    const SelectOptions& options = problem.options;
    if (times > options.repeat_limit) {
        violations.push_back(fmt::format("'{}' is taken {} times, at most {} are allowed",
                                         id_of(problem, pose), times, options.repeat_limit));
    }
    const auto& excluded = options.excluded;
    if (std::find(excluded.begin(), excluded.end(), pose) != excluded.end()) {
        violations.push_back(
            fmt::format("'{}' is excluded or measured already", id_of(problem, pose)));
    }
}

/// Whether two candidates are too near to each other.
void check_distance(const ChoiceProblem& problem, Index a, Index b,
                    std::vector<std::string>& violations) {
    const SelectOptions& options = problem.options;
    const double distance = (options.positions.row(b) - options.positions.row(a)).norm();
    if (distance >= options.least_distance) return;
    violations.push_back(fmt::format("'{}' and '{}' are {} deg apart, too near", id_of(problem, a),
                                     id_of(problem, b),
                                     detail::format_short(to_degrees(distance))));
}

/// Where a choice breaks the limits it was made under; one line each.
std::vector<std::string> find_violations(const ChoiceProblem& problem,
                                         const std::vector<Index>& poses) {
    const SelectOptions& options = problem.options;
    std::vector<std::string> violations;
    const std::map<Index, Index> times = count_each(poses);
    for (const auto& [pose, count] : times) {
        find_faults(problem, pose, count, violations);
        for (const auto& [other, unused] : times) {
            if (other >= pose || options.least_distance == 0) continue;
            check_distance(problem, other, pose, violations);
        }
    }
    if (options.groups.empty()) return violations;
    std::map<Index, Index> group_sizes;
    for (const Index pose : poses) ++group_sizes[options.groups[static_cast<std::size_t>(pose)]];
    for (const auto& [group, count] : group_sizes) {
        if (count <= options.group_limit) continue;
        violations.push_back(
            fmt::format("{} are of one group, at most {} are allowed", count, options.group_limit));
    }
    return violations;
}

void check_poses(const ChoiceProblem& problem, const std::vector<Index>& poses,
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

/// Branch and bound again, from the plan's own choice and certificate, until it proves as much as
/// the plan states or takes far longer than the plan's did.
double prove_again(const Plan& plan, const ChoiceProblem& problem, const std::vector<Index>& poses,
                   Findings& findings) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const bool is_optimal = plan.ending == Ending::Optimal;
    const detail::Proof proof =
        detail::prove_choice(problem.blocks, problem.options, poses, plan.certificate,
                             is_optimal ? -infinity : plan.bound);
    if (!agree(plan.request.criterion, std::max(proof.bound, plan.bound), plan.bound)) {
        return proof.bound;
    }
    findings.note("proof", true,
                  is_optimal ? "repeated; all other choices are ruled out or tried"
                             : "repeated; no choice is above the bound");
    // Which choices are tried depends on rounding, which differs between processors.
    const auto tried = static_cast<double>(proof.tried);
    const auto stated = static_cast<double>(plan.tried);
    if (proof.is_complete) {
        findings.compare("tried", stated, tried, std::abs(stated - tried) <= 0.1 * tried);
    }
    return plan.bound;
}

bool has_certificate(const Plan& plan, const ChoiceProblem& problem) {
    return plan.certificate.M.rows() == problem.blocks.parameter_count() &&
           plan.certificate.sharpness > 0;
}

/// The bound that the certificate proves.
double prove_bound(const Plan& plan, const ChoiceProblem& problem, Findings& findings) {
    if (has_certificate(plan, problem)) {
        return detail::upper_bound(problem.blocks, problem.options, plan.certificate);
    }
    const Index L = problem.blocks.parameter_count();
    const Index size = plan.certificate.M.rows();
    findings.note("certificate", size == 0,
                  size == 0 ? "none, so nothing is proven"
                            : fmt::format("is {} x {}, must be {} x {}", size, size, L, L));
    return std::numeric_limits<double>::infinity();
}

void check_numbers(const Plan& plan, const ChoiceProblem& problem, const std::vector<Index>& poses,
                   Findings& findings) {
    const Criterion criterion = problem.options.criterion;
    const double value = detail::choice_value(problem.blocks, problem.options, poses);
    findings.compare_value(criterion, plan.value, value, processor_rounding);

    double bound = std::max(value, prove_bound(plan, problem, findings));
    const double of_bound = std::clamp(0.1 * detail::bound_rounding(criterion, plan.certificate.M),
                                       processor_rounding, 1e-4);
    const bool claims_more = plan.bound < bound && !agree(criterion, plan.bound, bound, of_bound);
    if (claims_more && has_certificate(plan, problem) && agree(criterion, plan.value, value)) {
        bound = std::max(value, prove_again(plan, problem, poses, findings));
    }
    const bool holds = agree(criterion, plan.bound, bound, of_bound);
    findings.compare("bound", plan.bound, bound, holds);
    if (plan.ending == Ending::Optimal && !agree(criterion, plan.value, plan.bound)) {
        findings.note("proof", false, "stated to be optimal, the bound is above the value");
    }
    const auto nuisance = static_cast<Index>(problem.options.nuisance.size());
    const double actual = detail::efficiency(criterion, value, holds ? plan.bound : bound,
                                             problem.blocks.parameter_count() - nuisance);
    findings.compare("efficiency", plan.efficiency, actual,
                     std::abs(plan.efficiency - actual) <= of_bound);
}

/// `campaign` is null for plain blocks. Throws InputError if it is stopped.
Verification check(const Plan& plan, ChoiceProblem problem, const StopSignal& stop,
                   const Campaign* campaign) {
    problem.options.stop = stop;
    Verification verification = detail::collect(problem.blocks.count(), [&](Findings& findings) {
        const std::string mismatch = campaign ? describe_mismatch(plan, *campaign) : "";
        if (!mismatch.empty()) throw InputError(mismatch);
        check_candidates(plan, problem, findings);
        const std::vector<Index> poses = find_poses(plan, problem, findings);
        check_poses(problem, poses, findings);
        if (campaign != nullptr && !findings.has_same_parameters(plan, *campaign)) return;
        check_numbers(plan, problem, poses, findings);
        if (campaign != nullptr) findings.compare_assumptions(plan, *campaign);
    });
    stop.check("verifying");
    return verification;
}

}  // namespace

Verification verify(const Plan& plan, const Campaign& campaign, const Candidates& candidates,
                    const ChoiceOptions& options) {
    return check(plan, detail::state_choice(campaign, candidates, options), options.stop,
                 &campaign);
}

Verification verify(const Plan& plan, const Blocks& candidates, const ChoiceOptions& options) {
    return check(plan, detail::state_choice(candidates, options), options.stop, nullptr);
}

}  // namespace posewise
