#include "plan_space.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>

#include "../core/parallel.hpp"
#include "../core/progress_counter.hpp"
#include "../selection/bound.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "searched_bound.hpp"

namespace posewise::detail {
namespace {

constexpr Index test_pose_limit = 500;

/// What the starts share.
struct Problem {
    const DesignSpace& space;
    const RowMatrixXd& pool;
    const Blocks& blocks;
    const PlanOptions& options;
    Objective objective;
};

/// Parameters that count.
Index interesting_count(const Problem& problem) {
    return problem.space.parameter_count - static_cast<Index>(problem.options.nuisance.size());
}

/// The first poses of a pool spread over it as all of them do, being of a low-discrepancy sequence.
Blocks default_test_poses(const Blocks& blocks) {
    std::vector<Index> poses(static_cast<std::size_t>(std::min(blocks.count(), test_pose_limit)));
    std::iota(poses.begin(), poses.end(), Index{0});
    return take(blocks, poses);
}

/// Selection of K from the pool, as far as its time goes.
SelectOptions select_options(const DesignSpace& space, const RowMatrixXd& pool,
                             const PlanOptions& options) {
    SelectOptions select;
    select.criterion = options.criterion;
    select.pose_count = options.pose_count;
    select.test_poses = options.test_poses;
    select.nuisance = options.nuisance;
    select.held = options.held.information;
    select.held_pose_count = options.held_pose_count;
    select.column_names = space.parameter_names;
    select.seed = options.seed;
    select.stop.interrupted = options.stop.interrupted;
    // Refinement mends what a short selection leaves; exchange by the worst of many test poses is
    // slow.
    const bool is_slow = options.criterion == Criterion::G;
    select.starts = is_slow ? 1 : 4;
    select.kicks = is_slow ? 0 : 4;
    select.proof = 0.01;
    select.gap = 1e-3;
    if (space.least_joint_distance > 0) {
        // Selection measures by Euclid: at distance d sqrt(n) one joint differs by d at least.
        select.positions = pool;
        select.least_distance =
            space.least_joint_distance * std::sqrt(static_cast<double>(pool.cols()));
        const RowMatrixXd& held = options.held.configurations;
        for (Index i = 0; i < pool.rows() && held.rows() > 0; ++i) {
            const double nearest =
                (held.rowwise() - pool.row(i)).cwiseAbs().rowwise().maxCoeff().minCoeff();
            if (nearest < space.least_joint_distance) select.excluded.push_back(i);
        }
    }
    return select;
}

/// A smooth criterion that is quick to select by and leads near the optimum of one with kinks.
Criterion smooth_relative(Criterion criterion) {
    if (is_smooth(criterion)) return criterion;
    return needs_test_poses(criterion) ? Criterion::V : Criterion::A;
}

/// A choice from a random part of the pool, so that starts differ.
RowMatrixXd choose_from_part(const Problem& problem, Index start) {
    const PlanOptions& options = problem.options;
    RandomStream random(options.seed, static_cast<std::uint64_t>(start));
    const Index size = std::min(problem.pool.rows(), 20 * options.pose_count);
    const std::vector<Index> part = random.subset(problem.pool.rows(), size);
    const RowMatrixXd candidates = problem.pool(part, Eigen::all);
    SelectOptions select = select_options(problem.space, candidates, options);
    select.criterion = smooth_relative(options.criterion);
    select.starts = 1;
    select.kicks = 0;
    return candidates(determined(select_poses(take(problem.blocks, part), select)).poses,
                      Eigen::all);
}

/// The choice from the whole pool, which becomes `pool_choice`, and the refinements of all starts,
/// of which it is the first; those whose choice identifies too little are left empty. That choice
/// is made beside the other starts, since by G it takes as long as many of them.
std::vector<Refinement> refine_starts(const Problem& problem, const SelectOptions& select,
                                      Choice& pool_choice) {
    std::atomic<double> pool_bound = std::numeric_limits<double>::infinity();  // until it is made
    const PlanOptions& options = problem.options;
    std::vector<Refinement> results(static_cast<std::size_t>(options.starts));
    std::exception_ptr first_error;
    ProgressCounter counter(options.progress, options.starts);
    RefineOptions refine;
    refine.kink_rounds = 0;  // the best start alone is made sharper and finished
    refine.tolerance = 1e-6;
    refine.sharpness = {4, 16, 64};
    refine.stop = options.stop;
    for_each_index(options.starts, [&](Index start) {
        if (start > 0 && options.stop.is_set()) return;
        if (start == 0) {
            pool_choice = determined(select_poses(problem.blocks, select));
            pool_bound = pool_choice.bound;
        }
        Refinement& result = results[static_cast<std::size_t>(start)];
        try {
            const RowMatrixXd chosen =
                start == 0 ? RowMatrixXd(problem.pool(pool_choice.poses, Eigen::all))
                           : choose_from_part(problem, start);
            result = refine_poses(problem.space, problem.objective, options.held, chosen, refine);
        } catch (const InputError&) {
            if (start == 0) first_error = std::current_exception();  // others may do better
        }
        counter.count([&](Progress& progress) {
            progress.value = std::max(progress.value, result.value);
            progress.bound = pool_bound;
            progress.efficiency = efficiency(options.criterion, progress.value, progress.bound,
                                             interesting_count(problem));
        });
    });
    const bool is_any_usable = std::any_of(results.begin(), results.end(), [](const auto& result) {
        return std::isfinite(result.value);
    });
    if (!is_any_usable && first_error) std::rethrow_exception(first_error);
    return results;
}

/// Of a start: whether it was stopped on its way, or before it.
bool is_cut_short(Ending ending, const StopSignal& stop) {
    return ending == Ending::Interrupted || ending == Ending::TimeLimit ||
           (ending == Ending::NotRun && stop.is_set());
}

/// The best refinement's plan and information.
void report(const Problem& problem, Refinement best, PlannedPoses& planned) {
    const DesignSpace& space = problem.space;
    planned.value = best.value;
    planned.configurations = std::move(best.configurations);
    planned.information = problem.options.held.information;
    if (planned.information.size() == 0) {
        planned.information.setZero(space.parameter_count, space.parameter_count);
    }
    for (Index i = 0; i < planned.configurations.rows(); ++i) {
        planned.information += space.information(planned.configurations.row(i).transpose());
    }
}

}  // namespace

PlannedPoses plan_poses(const DesignSpace& space, const RowMatrixXd& pool, const Blocks& blocks,
                        const PlanOptions& asked_for) {
    if (pool.rows() != blocks.count()) {
        throw InputError("the pool has " + std::to_string(pool.rows()) + " poses, its blocks " +
                         std::to_string(blocks.count()));
    }
    PlanOptions options = asked_for;
    Blocks test_poses;
    if (needs_test_poses(options.criterion) && options.test_poses == nullptr) {
        test_poses = default_test_poses(blocks);
        options.test_poses = &test_poses;
    }
    if (options.starts < 1) {
        throw InputError("starts is " + std::to_string(options.starts) + ", must be at least 1");
    }
    SelectOptions select = select_options(space, pool, options);
    const Problem problem{space, pool, blocks, options, make_objective(blocks, select)};
    select.stop = options.stop.with_half_the_time();
    PlannedPoses planned;
    planned.criterion = options.criterion;
    planned.seed = options.seed;
    const auto results = refine_starts(problem, select, planned.pool_choice);
    Refinement best =
        *std::max_element(results.begin(), results.end(),
                          [](const auto& a, const auto& b) { return a.value < b.value; });
    for (const Refinement& result : results) {
        planned.endings.push_back(result.ending);
        if (is_cut_short(result.ending, problem.options.stop)) continue;
        ++planned.starts;
        const double behind = best.value - result.value;
        if (behind <= 1e-6 * std::abs(best.value)) ++planned.starts_at_best;
    }
    RefineOptions finish;
    finish.stop = problem.options.stop;
    finish.sharpness = {256};
    best = refine_poses(space, problem.objective, options.held, best.configurations, finish);
    report(problem, std::move(best), planned);
    check_all_is_seen(space, planned.information);

    // The relaxed optimum over the pool, with the smoothing it was found by, bounds best.
    const Certificate& certificate = planned.pool_choice.certificate;
    Objective relaxed = problem.objective;
    relaxed.sharpness = certificate.sharpness;
    planned.searched_bound =
        search_bound(space, relaxed, options.held, options.pose_count,
                     certificate.M.size() > 0 ? certificate.M : planned.information, pool,
                     options.bound_iterations, problem.options.stop);
    planned.efficiency = efficiency(options.criterion, planned.value, planned.searched_bound,
                                    interesting_count(problem));
    planned.is_interrupted = problem.options.stop.is_set();
    return planned;
}

}  // namespace posewise::detail
