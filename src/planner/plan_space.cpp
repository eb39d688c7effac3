#include "plan_space.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>

#include "core/decompositions.hpp"
#include "core/parallel.hpp"
#include "core/progress_counter.hpp"
#include "criteria/row_value.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "searched_bound.hpp"
#include "selection/bound.hpp"
#include "selection/local_search.hpp"

namespace posewise::detail {
namespace {

constexpr Index test_pose_limit = 500;
// Where their number is not stated; along constraints refinement finds less, and kicks less still,
// and where poses hardly suffice optima differ much.
constexpr Index usual_starts = 10;
constexpr Index more_starts = 16;
constexpr Index kicks_at_once = 4;  // whatever the number of threads
constexpr Index draws_a_pose = 30;  // of the pool, the most sensitive of which replaces a pose
constexpr double same = 1e-6;       // relative to the value

/// What the starts share.
struct Search {
    const DesignSpace& space;
    const RowMatrixXd& pool;
    const Blocks& blocks;
    const PlanOptions& options;
    Objective objective;
};

/// Parameters that count.
Index interesting_count(const Search& problem) {
    return problem.space.parameter_count - static_cast<Index>(problem.options.nuisance.size());
}

/// Selection of K from the pool, as far as its time goes.
SelectOptions select_options(const DesignSpace& space, const RowMatrixXd& pool,
                             const PlanOptions& options) {
    SelectOptions select;
    select.criterion = options.criterion;
    select.pose_count = options.pose_count;
    select.test_poses = options.test_poses;
    select.nuisance = options.nuisance;
    select.held_rows = options.held.rows;
    select.held_pose_count = options.held_pose_count;
    select.column_names = space.parameter_names;
    select.seed = options.seed;
    select.stop.interrupted = options.stop.interrupted;
    // Refinement mends what a short selection leaves; exchange by the worst of many test poses is
    // slow.
    select.starts = 1;
    select.kicks = options.criterion == Criterion::G ? 0 : 4;
    // Its bound is that of the relaxation: a search of all choices gains little there.
    select.proof = space.is_pool_only ? 0.01 : 0;
    select.gap = 1e-2;
    if (space.least_joint_distance > 0) {
        // Selection measures by Euclid: at distance d sqrt(n) one of n joints that move differs by
        // d at least.
        select.positions = pool;
        const Index moving =
            (pool.colwise().maxCoeff().array() > pool.colwise().minCoeff().array()).count();
        select.least_distance =
            space.least_joint_distance * std::sqrt(static_cast<double>(std::max<Index>(1, moving)));
        const RowMatrixXd& held = options.held.configurations;
        for (Index i = 0; i < pool.rows(); ++i) {
            if (!is_apart(held, pool.row(i), space.least_joint_distance)) {
                select.excluded.push_back(i);
            }
        }
    }
    return select;
}

/// A smooth criterion that is quick to select by and leads near the optimum of one with kinks.
Criterion smooth_relative(Criterion criterion) {
    if (is_smooth(criterion)) return criterion;
    return needs_test_poses(criterion) ? Criterion::V : Criterion::A;
}

/// Of some poses drawn from the pool, that keep their distance from `others`, the one that is most
/// sensitive to Z; nothing if none does.
std::optional<Index> draw_sensitive(const Search& problem, const RowMatrixXd& others,
                                    const MatrixXd& Z, RandomStream& random) {
    const double least = problem.space.least_joint_distance;
    std::optional<Index> best;
    double largest = 0;
    for (Index draw = 0; draw < draws_a_pose; ++draw) {
        const Index drawn = random.index(problem.pool.rows());
        const auto block = problem.blocks[drawn];
        const double sensitivity = (block * Z).cwiseProduct(block).sum();
        if (best && !(sensitivity > largest)) continue;
        const auto q = problem.pool.row(drawn);
        if (!is_apart(others, q, least) ||
            !is_apart(problem.options.held.configurations, q, least)) {
            continue;
        }
        largest = sensitivity;
        best = drawn;
    }
    return best;
}

/// A choice from a random part of the pool, so that starts differ.
RowMatrixXd choose_from_part(const Search& problem, Index start) {
    const PlanOptions& options = problem.options;
    RandomStream random(options.seed, static_cast<std::uint64_t>(start));
    const Index size = std::min(problem.pool.rows(), 20 * options.pose_count);
    const std::vector<Index> part = random.subset(problem.pool.rows(), size);
    const RowMatrixXd candidates = problem.pool(part, Eigen::all);
    SelectOptions select = select_options(problem.space, candidates, options);
    select.criterion = smooth_relative(options.criterion);
    select.starts = 1;
    select.kicks = 0;
    select.proof = 0;
    select.gap = 0.05;
    select.stop = options.stop;
    return candidates(determined(select_poses(take(problem.blocks, part), select)).poses,
                      Eigen::all);
}

/// Of a start: whether it was stopped on its way, or before it.
bool is_cut_short(Ending ending, const StopSignal& stop) {
    return ending == Ending::Interrupted || ending == Ending::TimeLimit ||
           (ending == Ending::NotRun && stop.is_set());
}

Index start_limit(const Search& problem) {
    if (problem.options.starts > 0) return problem.options.starts;
    constexpr double ample = 1.5;  // numbers for each parameter
    const double rows = mean_rows(problem.blocks) * static_cast<double>(problem.options.pose_count);
    const bool hardly_suffices = problem.options.held.rows.rows() == 0 &&
                                 rows < ample * static_cast<double>(problem.space.parameter_count);
    return problem.space.margin || hardly_suffices ? more_starts : usual_starts;
}

/// The best start alone is made sharper and finished.
RefineOptions rough_refinement(const PlanOptions& options, double tolerance) {
    RefineOptions refine;
    refine.kink_rounds = 0;
    refine.tolerance = tolerance;
    refine.sharpness = {4, 16, 64};
    refine.stop = options.stop;
    return refine;
}

Refinement& best_of(std::vector<Refinement>& results) {
    return *std::max_element(results.begin(), results.end(),
                             [](const auto& a, const auto& b) { return a.value < b.value; });
}

/// How many ended at the best of them.
Index count_at_best(const std::vector<Refinement>& results, const StopSignal& stop) {
    double best = -std::numeric_limits<double>::infinity();
    for (const Refinement& result : results) best = std::max(best, result.value);
    return std::count_if(results.begin(), results.end(), [&](const Refinement& result) {
        return !is_cut_short(result.ending, stop) && std::isfinite(result.value) &&
               best - result.value <= same * std::abs(best);
    });
}

/// Information of held and planned poses.
MatrixXd plan_information(const Search& problem, const RowMatrixXd& plan) {
    const DesignSpace& space = problem.space;
    MatrixXd M = detail::information_of(problem.options.held.rows, space.parameter_count);
    for (Index i = 0; i < plan.rows(); ++i) M += space.information(plan.row(i).transpose());
    return M;
}

/// What is stated of the plan at last: its value, by its rows as verify() has it. Throws InputError
/// where they do not identify the parameters.
void conclude(const Search& problem, const RowMatrixXd& configurations, PlannedPoses& planned) {
    const RowMatrixXd rows = rows_of(problem.space, problem.options.held, configurations);
    check_all_is_seen(problem.space, rows);
    planned.configurations = configurations;
    planned.value = evaluate_rows(problem.objective, rows);
    planned.information = plan_information(problem, configurations);
    planned.is_interrupted = problem.options.stop.is_set();
}

/// The choice from the whole pool, which becomes `pool_choice`, and the refinements of all starts,
/// of which it is the first; those whose choice identifies too little are left empty. That choice
/// is made beside the other starts, since by G it takes as long as many of them.
std::vector<Refinement> refine_starts(const Search& problem, const SelectOptions& select,
                                      Choice& pool_choice) {
    std::atomic<double> pool_bound = std::numeric_limits<double>::infinity();  // until it is made
    const PlanOptions& options = problem.options;
    const Index limit = start_limit(problem);
    std::vector<Refinement> results(static_cast<std::size_t>(limit));
    std::exception_ptr first_error;
    ProgressCounter counter(options.progress, limit + 1);  // kicks are the last part
    const auto run = [&](Index start) {
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
            const Ending stopped = options.stop.ending_or(Ending::NotRun);
            // Even to begin a refinement takes seconds with thousands of poses.
            result = start == 0 && stopped != Ending::NotRun
                         ? Refinement{chosen, pool_choice.value, pool_choice.value, stopped}
                         : refine_poses(problem.space, problem.objective, options.held, chosen,
                                        rough_refinement(options, 1e-6));
        } catch (const InputError&) {
            if (start == 0) first_error = std::current_exception();  // others may do better
        }
        counter.count([&](Progress& progress) {
            progress.value = std::max(progress.value, result.value);
            progress.bound = pool_bound;
            progress.efficiency = efficiency(options.criterion, progress.value, progress.bound,
                                             interesting_count(problem));
        });
    };
    for_each_index(limit, run);
    const bool is_any_usable = std::any_of(results.begin(), results.end(), [](const auto& result) {
        return std::isfinite(result.value);
    });
    if (!is_any_usable && first_error) std::rethrow_exception(first_error);
    return results;
}

/// The best of the starts, crossed with the others: the best choice of the poses that all of them
/// ended at, refined, as long as that is better; its poses are among them then.
Refinement cross(const Search& problem, std::vector<Refinement>& results) {
    const PlanOptions& options = problem.options;
    if (options.stop.is_set()) return best_of(results);
    Support met;
    for (const Refinement& result : results) {
        if (std::isfinite(result.value)) met.add(problem.space, result.configurations);
    }
    Refinement best = best_of(results);
    while (!options.stop.is_set()) {
        SelectOptions select = select_options(problem.space, met.poses, options);
        select.criterion = smooth_relative(options.criterion);
        select.stop = options.stop;
        Refinement crossed;
        try {
            const Choice choice = determined(select_poses(met.blocks, select));
            crossed =
                refine_poses(problem.space, problem.objective, options.held,
                             met.poses(choice.poses, Eigen::all), rough_refinement(options, 1e-6));
        } catch (const InputError&) {
            // Too few of them keep their distance.
        }
        if (!(crossed.value > best.value + same * std::abs(best.value))) break;
        best = std::move(crossed);
        met.add(problem.space, best.configurations);
    }
    return best;
}

/// The plan with one to three poses redrawn: the best of some tries, once the new ones have moved
/// to where they tell most beside the others.
RowMatrixXd kick(const Search& problem, const RowMatrixXd& plan, const MatrixXd& Z,
                 RandomStream& random) {
    constexpr Index tries = 3;
    const Index most = std::min<Index>(3, plan.rows());
    RefineOptions refine = rough_refinement(problem.options, 1e-4);
    Refinement best;
    for (Index k = 0; k < tries; ++k) {
        RowMatrixXd kicked = plan;
        refine.moved = random.subset(plan.rows(), 1 + random.index(most));
        for (const Index at : refine.moved) {
            RowMatrixXd others(plan.rows() - 1, plan.cols());
            others << kicked.topRows(at), kicked.bottomRows(plan.rows() - 1 - at);
            const auto drawn = draw_sensitive(problem, others, Z, random);
            if (drawn) kicked.row(at) = problem.pool.row(*drawn);
        }
        try {
            const Refinement tried = refine_poses(problem.space, problem.objective,
                                                  problem.options.held, kicked, refine);
            if (tried.value > best.value) best = tried;
        } catch (const InputError&) {
            // It identifies too little.
        }
    }
    return best.configurations;
}

/// Kicks without gain to give up after: some for each pose, fewer where a refinement takes long, as
/// it does with many poses and parameters, with kinks of the criterion and along constraints.
Index patience(const Search& problem) {
    const auto L = static_cast<double>(problem.space.parameter_count);
    const auto K = static_cast<double>(problem.options.pose_count);
    const double each = 10 * std::max(0.5, std::min({std::sqrt(1e5 / (L * L * K)), K / 12, 2.0}));
    const bool is_quick = is_smooth(problem.options.criterion) && !problem.space.margin;
    return static_cast<Index>(each * (is_quick ? 0.3 : 0.1) *
                              static_cast<double>(start_limit(problem)));
}

/// Kicks the best plan and refines it again, some kicks at once, of which the best is kept, until
/// many in a row, the more the more starts there may be, have gained nothing.
Refinement improve_with_kicks(const Search& problem, Refinement best) {
    const PlanOptions& options = problem.options;
    RefineOptions rough = rough_refinement(options, 1e-4);
    Objective softened = problem.objective;
    if (!is_smooth(options.criterion)) softened.sharpness = 16;
    const Index most_failures = patience(problem);
    // Less may be what the same plan gains by another refinement.
    const auto least_gain = [&] {
        const double size = is_logarithm(options.criterion)
                                ? static_cast<double>(problem.space.parameter_count)
                                : std::abs(best.value);
        return rough.tolerance * size;
    };
    std::uint64_t stream = static_cast<std::uint64_t>(start_limit(problem));
    for (Index failures = kicks_at_once; failures <= most_failures && !options.stop.is_set();
         failures += kicks_at_once) {
        const MatrixXd Z = gradient(softened, plan_information(problem, best.configurations));
        std::vector<Refinement> found(kicks_at_once);
        rough.worth = best.value;
        for_each_index(kicks_at_once, [&](Index i) {
            RandomStream random(options.seed, stream + static_cast<std::uint64_t>(i));
            try {
                found[static_cast<std::size_t>(i)] =
                    refine_poses(problem.space, problem.objective, options.held,
                                 kick(problem, best.configurations, Z, random), rough);
            } catch (const InputError&) {
                // It identifies too little.
            }
        });
        stream += static_cast<std::uint64_t>(kicks_at_once);
        Refinement& better = best_of(found);
        if (better.value <= best.value) continue;
        if (better.value > best.value + least_gain()) failures = 0;
        best.value = better.value;
        best.configurations = std::move(better.configurations);
    }
    return best;
}

/// The best choice from a pool: where hardly any pose is feasible there is nothing to refine.
PlannedPoses choose_only(const Search& problem, const SelectOptions& select) {
    PlannedPoses planned;
    planned.criterion = problem.options.criterion;
    planned.seed = problem.options.seed;
    planned.pool_choice = determined(select_poses(problem.blocks, select));
    planned.starts = planned.pool_choice.starts;
    planned.starts_at_best = planned.pool_choice.starts_at_best;
    conclude(problem, problem.pool(planned.pool_choice.poses, Eigen::all), planned);
    return planned;
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
        test_poses = take_first(blocks, test_pose_limit);
        options.test_poses = &test_poses;
    }
    if (options.starts < 0) {
        throw InputError("starts is " + std::to_string(options.starts) + ", must not be negative");
    }
    SelectOptions select = select_options(space, pool, options);
    const Search problem{space, pool, blocks, options, make_objective(blocks, select)};
    if (space.is_pool_only) {
        if (options.starts > 0) select.starts = options.starts;
        select.stop = options.stop;
        select.progress = options.progress;
        return choose_only(problem, select);
    }
    select.stop = options.stop.with_half_the_time();
    PlannedPoses planned;
    planned.criterion = options.criterion;
    planned.seed = options.seed;
    auto results = refine_starts(problem, select, planned.pool_choice);
    for (const Refinement& result : results) {
        planned.endings.push_back(result.ending);
        if (!is_cut_short(result.ending, options.stop)) ++planned.starts;
    }
    planned.starts_at_best = count_at_best(results, options.stop);
    Refinement best = improve_with_kicks(problem, cross(problem, results));
    if (options.progress) {
        const Index parts = start_limit(problem) + 1;
        const double bound = planned.pool_choice.bound;
        options.progress(
            {parts, parts, best.value, bound,
             efficiency(options.criterion, best.value, bound, interesting_count(problem))});
    }
    RefineOptions finish;
    finish.stop = problem.options.stop;
    finish.sharpness = {256};
    if (!options.stop.is_set()) {
        best = refine_poses(space, problem.objective, options.held, best.configurations, finish);
    }
    conclude(problem, best.configurations, planned);
    add_searched_bound(space, pool, blocks, options, planned);
    return planned;
}

void add_searched_bound(const DesignSpace& space, const RowMatrixXd& pool, const Blocks& blocks,
                        const PlanOptions& options, PlannedPoses& planned) {
    if (space.is_pool_only || options.bound_iterations == 0) return;
    const SelectOptions select = select_options(space, pool, options);
    const Objective objective = make_objective(blocks, select);
    planned.searched_bound =
        std::max(planned.value, search_bound(space, objective, select, planned, pool, blocks,
                                             options.bound_iterations, options.stop));
    planned.efficiency =
        efficiency(options.criterion, planned.value, planned.searched_bound,
                   space.parameter_count - static_cast<Index>(options.nuisance.size()));
    planned.is_interrupted = planned.is_interrupted || options.stop.is_set();
}

}  // namespace posewise::detail
