#include "posewise/selection/exchange.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>

#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/selection/bound.hpp"
#include "sensitivity.hpp"

namespace posewise {
namespace {

constexpr double minus_infinity = -std::numeric_limits<double>::infinity();
constexpr Index relaxation_iterations = 60;

/// One search: candidates, what is maximised, and information held besides the chosen poses.
struct Search {
    const Blocks& candidates;
    const Objective& objective;
    MatrixXd held;

    MatrixXd information_of(const std::vector<Index>& poses) const {
        return held + information(candidates, poses);
    }
};

struct SearchResult {
    std::vector<Index> poses;
    double value = minus_infinity;
    bool converged = false;
};

bool is_improvement(double value, double over) {
    return value > over + 1e-12 * std::max(1.0, std::abs(over));
}

/// A multiple of the identity, small beside the information of one pose, that makes log det finite.
MatrixXd regularisation(const Blocks& candidates) {
    const Index L = candidates.parameter_count();
    const double mean_entry = candidates.matrix.squaredNorm() /
                              static_cast<double>(std::max<Index>(1, candidates.count() * L));
    return 1e-8 * mean_entry * MatrixXd::Identity(L, L);
}

/// Adds poses one at a time, each with the largest gain of log det(held + M), to K poses.
void complete_greedily(const Blocks& candidates, const MatrixXd& held, Index pose_count,
                       std::vector<Index>& poses) {
    std::set<Index> chosen(poses.begin(), poses.end());
    MatrixXd M = held + information(candidates, poses);
    while (static_cast<Index>(poses.size()) < pose_count) {
        const Eigen::LLT<MatrixXd> cholesky(M);
        Index best = -1;
        double best_gain = minus_infinity;
        for (Index i = 0; i < candidates.count(); ++i) {
            if (chosen.contains(i)) continue;
            const MatrixXd whitened = cholesky.matrixL().solve(candidates[i].transpose());
            const MatrixXd growth = MatrixXd::Identity(whitened.cols(), whitened.cols()) +
                                    whitened.transpose() * whitened;
            const double gain = growth.llt().matrixLLT().diagonal().array().log().sum();
            if (best < 0 || gain > best_gain) {
                best = i;
                best_gain = gain;
            }
        }
        poses.push_back(best);
        chosen.insert(best);
        M += candidates[best].transpose() * candidates[best];
    }
}

/// Replaces the pose at `position` by the candidate that improves the value most. Quasiconcavity
/// screens (O4 does not have it): only a pose of larger sensitivity can improve the value.
bool exchange_best(const Search& search, Index position, SearchResult& result) {
    const auto at = static_cast<std::size_t>(position);
    const Index removed = result.poses[at];
    const MatrixXd M = search.information_of(result.poses);
    const VectorXd d = sensitivities(search.candidates, gradient(search.objective, M));
    const MatrixXd remaining =
        M - search.candidates[removed].transpose() * search.candidates[removed];
    const bool screens = search.objective.criterion != Criterion::O4;
    Index best = -1;
    double best_value = result.value;
    for (Index i = 0; i < search.candidates.count(); ++i) {
        if ((screens && d[i] <= d[removed]) ||
            std::find(result.poses.begin(), result.poses.end(), i) != result.poses.end()) {
            continue;
        }
        const MatrixXd exchanged =
            remaining + search.candidates[i].transpose() * search.candidates[i];
        const double value = evaluate(search.objective, exchanged);
        if (is_improvement(value, best_value)) {
            best = i;
            best_value = value;
        }
    }
    if (best < 0) return false;
    result.poses[at] = best;
    result.value = evaluate(search.objective, search.information_of(result.poses));
    return true;
}

/// Exchanges until no exchange improves, or the sweeps are used up.
SearchResult improve(const Search& search, std::vector<Index> poses, Index sweep_limit) {
    SearchResult result{std::move(poses), minus_infinity, false};
    result.value = evaluate(search.objective, search.information_of(result.poses));
    for (Index sweep = 0; sweep < sweep_limit && !result.converged; ++sweep) {
        result.converged = true;
        for (Index j = 0; j < static_cast<Index>(result.poses.size()); ++j) {
            if (exchange_best(search, j, result)) result.converged = false;
        }
    }
    std::sort(result.poses.begin(), result.poses.end());
    return result;
}

/// One start: some random poses (none for the first start), completed greedily and improved;
/// while they do not identify the parameters, by the regularised determinant first.
SearchResult run_start(const Search& search, const SelectOptions& options, Index start) {
    const MatrixXd ridge = regularisation(search.candidates);
    std::vector<Index> poses;
    if (start > 0) {
        RandomStream random(options.seed, static_cast<std::uint64_t>(start));
        poses = random.subset(search.candidates.count(), (options.pose_count + 1) / 2);
    }
    complete_greedily(search.candidates, ridge, options.pose_count, poses);
    if (!std::isfinite(evaluate(search.objective, search.information_of(poses)))) {
        const Objective determinant = make_objective(Criterion::D, options.pose_count);
        poses = improve({search.candidates, determinant, search.held + ridge}, poses,
                        options.sweep_limit)
                    .poses;
        if (!std::isfinite(evaluate(search.objective, search.information_of(poses)))) {
            return {poses, minus_infinity, true};
        }
    }
    return improve(search, std::move(poses), options.sweep_limit);
}

void check(const Blocks& candidates, const SelectOptions& options) {
    if (!candidates.matrix.allFinite()) {
        throw InputError("candidates have a value that is not a finite number");
    }
    if (options.pose_count < 1 || options.pose_count > candidates.count()) {
        throw InputError("pose count is " + std::to_string(options.pose_count) +
                         ", must be from 1 to the number of candidates, " +
                         std::to_string(candidates.count()));
    }
    if (options.starts < 1) {
        throw InputError("starts is " + std::to_string(options.starts) + ", must be at least 1");
    }
    if (options.sweep_limit < 1) {
        throw InputError("sweep limit is " + std::to_string(options.sweep_limit) +
                         ", must be at least 1");
    }
    const Index L = candidates.parameter_count();
    const VectorXd scale = candidates.matrix.colwise().norm().cwiseMax(1e-300).cwiseInverse();
    const MatrixXd M = scale.asDiagonal() * information(candidates) * scale.asDiagonal();
    const VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(M).eigenvalues();
    const Index missing =
        (eigenvalues.array() <= 1e-12 * std::max(1.0, eigenvalues[L - 1])).count();
    if (missing > 0) {
        throw InputError("all " + std::to_string(candidates.count()) +
                         " candidates together leave " + std::to_string(missing) + " of " +
                         std::to_string(L) +
                         " parameter directions unseen; drop redundant parameters or add poses");
    }
}

}  // namespace

Plan select_poses(const Blocks& candidates, const SelectOptions& options) {
    check(candidates, options);
    const Objective objective = make_objective(options.criterion, options.pose_count, &candidates);
    const Index L = candidates.parameter_count();
    const Search search{candidates, objective, MatrixXd::Zero(L, L)};

    std::vector<SearchResult> results(static_cast<std::size_t>(options.starts));
#pragma omp parallel for schedule(dynamic)
    for (Index start = 0; start < options.starts; ++start) {
        results[static_cast<std::size_t>(start)] = run_start(search, options, start);
    }

    const auto best =
        std::max_element(results.begin(), results.end(),
                         [](const auto& a, const auto& b) { return a.value < b.value; });
    if (!std::isfinite(best->value)) {
        throw InputError("pose count is " + std::to_string(options.pose_count) +
                         ": no choice was found that identifies all " + std::to_string(L) +
                         " parameters; ask for more poses");
    }
    Plan plan;
    plan.poses = best->poses;
    plan.criterion = options.criterion;
    plan.value = best->value;
    plan.bound = std::max(
        plan.value, tightened_bound(objective, candidates, options.pose_count,
                                    information(candidates, plan.poses), relaxation_iterations));
    plan.efficiency = efficiency(plan.criterion, plan.value, plan.bound, L);
    plan.seed = options.seed;
    plan.starts = options.starts;
    plan.starts_at_best =
        std::count_if(results.begin(), results.end(), [&](const SearchResult& result) {
            return plan.value - result.value <= 1e-9 * std::max(1.0, std::abs(plan.value));
        });
    const bool converged = std::all_of(results.begin(), results.end(),
                                       [](const auto& result) { return result.converged; });
    plan.stop_reason = converged ? StopReason::Converged : StopReason::SweepLimit;
    return plan;
}

}  // namespace posewise
