#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>

#include "branch_and_bound.hpp"
#include "common_rows.hpp"
#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/parallel.hpp"
#include "core/progress_counter.hpp"
#include "core/sensitivities.hpp"
#include "core/statistics.hpp"
#include "objective_bound.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/selection/choice.hpp"
#include "recombination.hpp"
#include "relaxation.hpp"
#include "validation.hpp"

namespace posewise {
namespace {

using detail::by_decreasing;
using detail::Relaxation;
using detail::ScoredPoses;
using detail::SearchProblem;
using detail::Shortlist;

constexpr Index sweep_limit = 50;  // of the last sweeps over all candidates
constexpr Index sweep_size = 4096;
constexpr Index few_starts = 5;  // fewer, as each takes seconds, run side by side before any proof

ScoredPoses make_choice(const SearchProblem& problem, std::vector<Index> poses) {
    const detail::SearchScore score = problem.score(problem.regularised_information(poses));
    return {std::move(poses), score};
}

/// The poses that are farthest from the middle of all: one there would keep several others off.
std::vector<Index> take_outermost(const SearchProblem& problem) {
    const RowMatrixXd& positions = problem.options.positions;
    const Eigen::RowVectorXd middle = positions.colwise().mean();
    return detail::take_in_order(
        problem, by_decreasing((positions.rowwise() - middle).rowwise().squaredNorm()));
}

/// The poses of the largest relaxed weights.
ScoredPoses make_first_start(const SearchProblem& problem, const Relaxation& relaxation) {
    std::vector<Index> poses = detail::take_in_order(problem, by_decreasing(relaxation.weights));
    if (static_cast<Index>(poses.size()) < problem.options.pose_count &&
        problem.options.least_distance > 0) {
        std::vector<Index> outermost = take_outermost(problem);
        if (outermost.size() > poses.size()) poses = std::move(outermost);
    }
    if (static_cast<Index>(poses.size()) < problem.options.pose_count) {
        const bool is_one = poses.size() == 1;
        throw InputError(fmt::format(
            "pose count is {}, but only {} {} found that exclusions, groups and distances "
            "(`least_distance`, of plans the cell's least_joint_distance_deg) allow{}",
            problem.options.pose_count, poses.size(), is_one ? "pose was" : "poses were",
            is_one ? "" : " together"));
    }
    return make_choice(problem, std::move(poses));
}

/// Poses drawn by their relaxed weights; nothing if the draw ran into the limits.
std::optional<ScoredPoses> make_random_start(const SearchProblem& problem,
                                             const Relaxation& relaxation, RandomStream& random) {
    const double least = 1e-3 * static_cast<double>(problem.options.pose_count) /
                         static_cast<double>(problem.candidates.count());
    // Keys log(u) / w order a draw without replacement [Efraimidis, Spirakis 2006].
    VectorXd keys = relaxation.weights;
    for (double& key : keys) key = detail::logarithm(1 - random.uniform()) / std::max(key, least);
    std::vector<Index> poses = detail::take_in_order(problem, by_decreasing(keys));
    if (static_cast<Index>(poses.size()) < problem.options.pose_count) return std::nullopt;
    return make_choice(problem, std::move(poses));
}

/// A choice that does not identify the parameters, exchanged by their determinant until it does:
/// among such choices most criteria are flat, so their own exchange would not find the way out.
ScoredPoses make_identifying(const SearchProblem& problem, const Shortlist& shortlist,
                             const ScoredPoses& choice, RandomStream& random) {
    if (choice.score.identifies || problem.objective.criterion == Criterion::D) return choice;
    const detail::Objective determinant;
    SearchProblem by_determinant{problem.candidates, problem.options, determinant,
                                 problem.held,       problem.ridge,   problem.common_rows,
                                 problem.ruggedness};
    const ScoredPoses changed = improve_with_kicks(
        by_determinant, detail::make_shortlist(problem.candidates, shortlist.members),
        make_choice(by_determinant, choice.poses), random);
    return make_choice(problem, changed.poses);
}

Index shortlist_size(const Blocks& candidates, const SelectOptions& options) {
    if (options.shortlist > 0) return options.shortlist;
    const Index numbers_each =
        std::max<Index>(1, candidates.matrix.size() / std::max<Index>(1, candidates.count()));
    return std::clamp<Index>(250'000 / numbers_each, 800, 5000);
}

Index start_count(const Shortlist& shortlist, const SearchProblem& problem) {
    const SelectOptions& options = problem.options;
    if (options.starts > 0) return options.starts;
    // A start of 20 out of 800 blocks of 9 rows and 86 parameters takes 2 s of a CPU.
    const double rows = detail::rows_each(problem);
    const double work = rows * rows * static_cast<double>(problem.candidates.parameter_count()) *
                        static_cast<double>(options.pose_count) *
                        static_cast<double>(shortlist.members.size()) * problem.ruggedness;
    const bool is_quick = detail::has_exact_gains(problem.objective);
    return static_cast<Index>(
        std::clamp(8e8 / work, is_quick ? 6.0 : 4.0, is_quick ? 100.0 : 20.0));
}

/// The most sensitive candidates at the relaxed optimum that are not excluded.
Shortlist shortlist_by_sensitivity(const SearchProblem& problem, const Relaxation& relaxation) {
    const std::vector<Index> capacity =
        detail::capacities(problem.candidates.count(), problem.options);
    const Index size = shortlist_size(problem.candidates, problem.options);
    std::vector<Index> members;
    for (const Index i : by_decreasing(relaxation.sensitivity)) {
        if (static_cast<Index>(members.size()) == size) break;
        if (capacity[static_cast<std::size_t>(i)] > 0) members.push_back(i);
    }
    return detail::make_shortlist(problem.candidates, std::move(members));
}

/// Whether two values of the criterion are the same but for rounding.
bool agree(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(1e-6, std::abs(a)); }

/// How many choices have the value of the best of them.
Index count_at_best(std::span<const ScoredPoses> choices, double best) {
    return std::count_if(choices.begin(), choices.end(), [best](const ScoredPoses& choice) {
        return choice.score.identifies && agree(best, choice.score.value);
    });
}

/// Starts that ended at the best, to end the search after. Fewer may by chance agree on a plan that
/// is not the best.
constexpr Index enough = 10;

/// What the starts ended at, in their order whichever ended first. Where they may agree, those
/// after the first ones of which enough ended at the best of them are not needed.
class Ends {
  public:
    Ends(Index starts, bool may_agree)
        : ends_(static_cast<std::size_t>(starts)), may_agree_(may_agree), needed_(starts) {}

    bool is_needed(Index start) const { return start < needed_; }

    void keep(Index start, ScoredPoses choice, bool is_cut_short) {
        const std::lock_guard lock(mutex_);
        if (is_cut_short) {
            cut_short_.push_back(std::move(choice));
            return;
        }
        ends_[static_cast<std::size_t>(start)] = std::move(choice);
        while (is_needed(counted()) && ends_[first_.size()]) {
            first_.push_back(*ends_[first_.size()]);
            const auto& [identifies, value] = first_.back().score;
            if (identifies) best_ = std::max(best_, value);
            if (may_agree_ && count_at_best(first_, best_) >= enough) needed_ = counted();
        }
    }

    /// Of all that are needed and had the time to end.
    std::vector<ScoredPoses> choices() const {
        std::vector<ScoredPoses> choices = first_;
        for (Index start = counted(); is_needed(start); ++start) {
            const auto& end = ends_[static_cast<std::size_t>(start)];
            if (end) choices.push_back(*end);
        }
        return choices;
    }

    /// What those without the time had come to.
    const std::vector<ScoredPoses>& cut_short() const { return cut_short_; }

  private:
    Index counted() const { return static_cast<Index>(first_.size()); }

    std::vector<std::optional<ScoredPoses>> ends_;
    std::vector<ScoredPoses> cut_short_;
    std::vector<ScoredPoses> first_;                          // without a gap
    double best_ = -std::numeric_limits<double>::infinity();  // of them
    bool may_agree_;
    std::atomic<Index> needed_;
    std::mutex mutex_;
};

struct Outcome {
    ScoredPoses best;
    std::vector<ScoredPoses> starts;  // what each start ended at, but for those cut short
    Index tried = 0;                  // choices, all that the bound left open
    bool is_optimal = false;
    double bound = std::numeric_limits<double>::infinity();
};

/// Exchanges with every candidate that could improve the choice, shortlisted or not, until none
/// does.
ScoredPoses sweep_all(const SearchProblem& problem, ScoredPoses choice) {
    for (Index sweep = 0; sweep < sweep_limit && !problem.options.stop.is_set(); ++sweep) {
        const VectorXd d = detail::sensitivities(
            problem.candidates,
            gradient(problem.objective, problem.regularised_information(choice.poses)));
        double least = std::numeric_limits<double>::infinity();
        for (const Index pose : choice.poses) least = std::min(least, d[pose]);
        const std::vector<Index> capacity =
            detail::capacities(problem.candidates.count(), problem.options);
        std::vector<Index> members;
        for (const Index i : by_decreasing(d)) {
            if (d[i] <= least || static_cast<Index>(members.size()) == sweep_size) break;
            if (capacity[static_cast<std::size_t>(i)] > 0) members.push_back(i);
        }
        if (members.empty()) break;
        const Shortlist shortlist = detail::make_shortlist(problem.candidates, std::move(members));
        const ScoredPoses improved = improve(problem, shortlist, choice);
        if (!is_better(improved.score, choice.score)) break;
        choice = improved;
    }
    return choice;
}

/// What a start ends at, judged by its rows.
ScoredPoses search_from(const SearchProblem& problem, const Shortlist& shortlist,
                        const ScoredPoses& start, RandomStream& random) {
    const ScoredPoses improved = improve_with_kicks(
        problem, shortlist, make_identifying(problem, shortlist, start, random), random);
    return judge(problem, sweep_all(problem, improved));
}

/// What the start of the relaxation ends at.
ScoredPoses search_from_first(const SearchProblem& problem, const Relaxation& relaxation,
                              const Shortlist& shortlist) {
    RandomStream random(problem.options.seed, 0);
    return search_from(problem, shortlist, make_first_start(problem, relaxation), random);
}

/// Searches from the start of the relaxation, unless what it ends at is known, and random ones.
void run_starts(const SearchProblem& problem, const Relaxation& relaxation,
                const Shortlist& shortlist, Index starts, const std::optional<ScoredPoses>& first,
                Outcome& outcome) {
    const SelectOptions& options = problem.options;
    detail::ProgressCounter counter(options.progress, {.total = starts, .bound = relaxation.bound});
    Ends ends(starts, options.starts == 0);
    detail::for_each_index(starts, [&](Index start) {
        if (!ends.is_needed(start) || (start > 0 && options.stop.is_set())) return;
        ScoredPoses choice;
        if (start > 0) {
            RandomStream random(options.seed, static_cast<std::uint64_t>(start));
            auto drawn = make_random_start(problem, relaxation, random);
            if (!drawn) drawn = first ? *first : make_first_start(problem, relaxation);
            choice = search_from(problem, shortlist, *drawn, random);
        } else {
            choice = first ? *first : search_from_first(problem, relaxation, shortlist);
        }
        counter.count([&](Progress& progress) {
            if (choice.score.identifies) {
                progress.value = std::max(progress.value, choice.score.value);
            }
        });
        ends.keep(start, std::move(choice), options.stop.is_set());
    });
    outcome.starts = ends.choices();
    for (const auto& found : {outcome.starts, ends.cut_short()}) {
        for (const ScoredPoses& choice : found) {
            const bool is_first = outcome.best.poses.empty();
            if (is_first || is_better(choice.score, outcome.best.score)) outcome.best = choice;
        }
    }
}

/// Whether the best is proven to be optimal; once more from what that found, so that whoever has
/// the plan can repeat it.
bool prove(const SearchProblem& problem, const Relaxation& relaxation,
           const detail::ProofLimits& limits, Outcome& outcome) {
    while (true) {
        detail::Proof proof = detail::prove(problem, relaxation.certificate, outcome.best, limits);
        const bool is_improved = is_better(proof.best.score, outcome.best.score);
        outcome.best = std::move(proof.best);
        outcome.bound = std::min(outcome.bound, proof.bound);
        outcome.tried = proof.tried;
        outcome.is_optimal = proof.is_complete;
        if (!is_improved || !proof.is_complete) return proof.is_complete;
    }
}

/// What the start of the relaxation ends at may leave few enough other choices to rule them out;
/// else all starts, and a proof of what they find.
Outcome search(SearchProblem problem, const Relaxation& relaxation) {
    const Shortlist shortlist = shortlist_by_sensitivity(problem, relaxation);
    problem.ruggedness = detail::ruggedness(problem, shortlist);
    const Index starts = start_count(shortlist, problem);
    const std::optional<double> asked = problem.options.proof;
    const double usual = std::min(asked.value_or(detail::usual_proof), detail::usual_proof);
    Outcome outcome;
    std::optional<ScoredPoses> first;
    if (problem.options.starts > 0 || starts >= few_starts) {
        first = search_from_first(problem, relaxation, shortlist);
        outcome.best = *first;
        if (prove(problem, relaxation, {.seconds = usual, .is_only_if_likely = true}, outcome)) {
            outcome.starts = {outcome.best};
            return outcome;
        }
    }
    const detail::SearchScore tried = outcome.best.score;
    run_starts(problem, relaxation, shortlist, starts, first, outcome);
    if (count_at_best(outcome.starts, outcome.best.score.value) < enough) {
        const ScoredPoses crossed =
            judge(problem, sweep_all(problem, detail::recombine(problem, shortlist, outcome.best,
                                                                outcome.starts)));
        if (is_better(crossed.score, outcome.best.score)) outcome.best = crossed;
    }
    if (!problem.options.stop.is_set() && (asked || is_better(outcome.best.score, tried))) {
        prove(problem, relaxation, {.seconds = asked.value_or(usual), .is_only_if_likely = !asked},
              outcome);
    }
    return outcome;
}

Choice unidentified(const std::string& reason) {
    Choice nothing;
    nothing.ending = Ending::NotIdentifiable;
    nothing.undetermined = reason;
    return nothing;
}

}  // namespace

Choice determined(Choice choice) {
    if (choice.ending == Ending::NotIdentifiable) throw InputError(choice.undetermined);
    return choice;
}

Choice select_poses(const Blocks& candidates, const SelectOptions& options) {
    detail::validate(candidates, options);
    const std::string reason = detail::describe_unidentified(candidates, options);
    if (!reason.empty()) return unidentified(reason);
    const detail::Objective objective = detail::make_objective(candidates, options);
    // Lower blocks are searched where part of all blocks is the same.
    const detail::CommonRows common = detail::split_common_rows(candidates);
    const bool is_split = common.rows.rows() > 0;
    const Blocks& searched = is_split ? common.others : candidates;
    SelectOptions with_common = options;
    if (is_split) {
        const double count = static_cast<double>(options.pose_count);
        with_common.held_rows = detail::stack(options.held_rows, std::sqrt(count) * common.rows);
    }
    const SearchProblem problem{searched,
                                with_common,
                                objective,
                                detail::held_information(searched, with_common),
                                detail::ridge_of(candidates),
                                common.rows.rows()};
    const Relaxation relaxation = relax(objective, searched, with_common);
    const Outcome outcome = search(problem, relaxation);
    const ScoredPoses& best = outcome.best;
    if (!best.score.identifies) {
        return unidentified(
            fmt::format("pose count is {}: no choice was found that identifies all {} parameters; "
                        "ask for more {}{}",
                        options.pose_count, candidates.parameter_count(),
                        options.stop.is_set() ? "time, poses" : "poses",
                        options.held_rows.rows() == 0 ? " or state a prior" : ""));
    }
    Choice plan;
    plan.starts = static_cast<Index>(outcome.starts.size());
    plan.starts_at_best = count_at_best(outcome.starts, best.score.value);
    plan.tried = outcome.tried;
    plan.ending = outcome.is_optimal ? Ending::Optimal : options.stop.ending_or(Ending::Converged);
    plan.poses = best.poses;
    std::sort(plan.poses.begin(), plan.poses.end());
    plan.criterion = options.criterion;
    plan.value = detail::choice_value(objective, candidates, options, plan.poses);
    plan.bound = outcome.is_optimal
                     ? plan.value
                     : std::max(std::min(relaxation.bound, outcome.bound), plan.value);
    plan.efficiency = detail::efficiency(
        plan.criterion, plan.value, plan.bound,
        candidates.parameter_count() - static_cast<Index>(options.nuisance.size()));
    plan.certificate = relaxation.certificate;
    plan.seed = options.seed;
    return plan;
}

}  // namespace posewise
