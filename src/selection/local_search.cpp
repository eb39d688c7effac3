#include "local_search.hpp"

#include <algorithm>
#include <cmath>

#include "core/products.hpp"
#include "objective_bound.hpp"

namespace posewise::detail {
namespace {

constexpr Index quick_evaluations = 8;

/// Candidates that kicks are improved with; the others, which come less near to improving what is
/// kicked, only have a say in what the kicks lead to.
constexpr Index least_near = 200;
constexpr Index near_a_pose = 5;

Index near_size(const SearchProblem& problem) {
    return std::max(least_near, near_a_pose * problem.options.pose_count);
}

/// One choice being improved.
class LocalSearch {
  public:
    LocalSearch(const SearchProblem& problem, const Shortlist& shortlist, Index most_evaluated)
        : problem_(problem),
          shortlist_(shortlist),
          neighbourhood_(problem.objective, problem.candidates, shortlist, most_evaluated,
                         problem.options.stop),
          occupancy_(problem.candidates.count(), problem.options) {}

    const ScoredPoses& choice() const { return choice_; }

    void start_at(const ScoredPoses& choice) {
        occupy(choice);
        settle();
    }

    /// The shortlist of those candidates that come nearest to improving the choice.
    Shortlist nearest() {
        std::vector<Index> members;
        for (const Index position : neighbourhood_.nearest(choice_.poses, near_size(problem_))) {
            members.push_back(shortlist_.members[static_cast<std::size_t>(position)]);
        }
        return make_shortlist(problem_.candidates, std::move(members));
    }

    void improve() {
        const std::size_t K = choice_.poses.size();
        std::size_t unimproved = 0;
        for (std::size_t at = 0; unimproved < K && !problem_.options.stop.is_set();
             at = (at + 1) % K) {
            unimproved = exchange_at(at) ? 0 : unimproved + 1;
        }
        score();
    }

    /// Starts at a choice with one to four poses replaced by random ones of the shortlist; at the
    /// choice itself where the limits leave nothing to replace them by.
    void start_near(const ScoredPoses& choice, RandomStream& random) {
        occupy(choice);
        const auto K = static_cast<Index>(choice.poses.size());
        const std::vector<Index> kicked = random.subset(K, 1 + random.index(std::min<Index>(K, 4)));
        for (const Index at : kicked) occupancy_.remove(pose_at(at));
        std::size_t replaced = 0;
        for (; replaced < kicked.size(); ++replaced) {
            const Index drawn = draw_allowed(random);
            if (drawn < 0) break;
            pose_at(kicked[replaced]) = drawn;
            occupancy_.add(drawn);
        }
        if (replaced < kicked.size()) {
            for (std::size_t k = 0; k < replaced; ++k) occupancy_.remove(pose_at(kicked[k]));
            for (const Index at : kicked) {
                pose_at(at) = choice.poses[static_cast<std::size_t>(at)];
                occupancy_.add(pose_at(at));
            }
        }
        settle();
    }

  private:
    void occupy(const ScoredPoses& choice) {
        for (const Index pose : choice_.poses) occupancy_.remove(pose);
        choice_ = choice;
        for (const Index pose : choice_.poses) occupancy_.add(pose);
    }

    Index& pose_at(Index at) { return choice_.poses[static_cast<std::size_t>(at)]; }

    /// The first allowed candidate from a random place of the shortlist on; -1 if none is.
    Index draw_allowed(RandomStream& random) const {
        const auto size = static_cast<Index>(shortlist_.members.size());
        const Index from = random.index(size);
        for (Index k = 0; k < size; ++k) {
            const Index drawn = shortlist_.members[static_cast<std::size_t>((from + k) % size)];
            if (occupancy_.allows(drawn)) return drawn;
        }
        return -1;
    }

    void settle() {
        const MatrixXd M = problem_.regularised_information(choice_.poses);
        choice_.score = problem_.score(M);
        is_scored_ = true;
        neighbourhood_.move_to(M);
    }

    void score() {
        if (is_scored_) return;
        choice_.score = problem_.score(problem_.regularised_information(choice_.poses));
        is_scored_ = true;
    }

    bool exchange_at(std::size_t at) {
        const Index removed = choice_.poses[at];
        occupancy_.remove(removed);
        const Neighbourhood::Replacement found =
            neighbourhood_.best_replacement(removed, choice_.score.value, occupancy_);
        if (found.position >= 0 && replace(at, found)) {
            occupancy_.add(choice_.poses[at]);
            return true;
        }
        occupancy_.add(removed);
        return false;
    }

    /// Whether it is better; else nothing is changed.
    bool replace(std::size_t at, const Neighbourhood::Replacement& by) {
        if (!by.is_certain) score();
        const Index removed = choice_.poses[at];
        const Index added = shortlist_.members[static_cast<std::size_t>(by.position)];
        choice_.poses[at] = added;
        // Exchange by exchange rounding would add up, and then count as gains without an end.
        const MatrixXd M = by.is_certain ? neighbourhood_.exchanged(removed, added)
                                         : problem_.regularised_information(choice_.poses);
        if (by.is_certain) {
            is_scored_ = false;
        } else if (const SearchScore score = problem_.score(M); is_better(score, choice_.score)) {
            choice_.score = score;
        } else {
            choice_.poses[at] = removed;
            return false;
        }
        neighbourhood_.exchange(added, M);
        return true;
    }

    const SearchProblem& problem_;
    const Shortlist& shortlist_;
    Neighbourhood neighbourhood_;
    Occupancy occupancy_;
    ScoredPoses choice_;
    bool is_scored_ = true;  // else the score is that of an earlier choice
};

/// Kicks without success to give up after.
Index patience(const SearchProblem& problem) {
    return static_cast<Index>(
        std::lround(static_cast<double>(problem.options.kicks) * problem.ruggedness));
}

/// The first better choice that kicks of the best lead to; the best itself where too many in a row
/// bring nothing.
ScoredPoses kick(const SearchProblem& problem, const Shortlist& shortlist, const ScoredPoses& best,
                 RandomStream& random) {
    LocalSearch search(problem, shortlist, quick_evaluations);
    const Index most_failures = patience(problem);
    for (Index failures = 0; failures < most_failures && !problem.options.stop.is_set();
         ++failures) {
        search.start_near(best, random);
        search.improve();
        if (is_better(search.choice().score, best.score)) return search.choice();
    }
    return best;
}

}  // namespace

double ridge_of(const Blocks& candidates) {
    const double entries = static_cast<double>(candidates.count() * candidates.parameter_count());
    return 1e-11 * std::max(candidates.matrix.squaredNorm() / entries, 1e-300);
}

double mean_rows(const Blocks& candidates) {
    return static_cast<double>(candidates.matrix.rows()) /
           static_cast<double>(std::max<Index>(1, candidates.count()));
}

double rows_each(const SearchProblem& problem) {
    return mean_rows(problem.candidates) + static_cast<double>(problem.common_rows);
}

double ruggedness(const SearchProblem& problem, const Shortlist& shortlist) {
    const double poses = static_cast<double>(problem.options.pose_count);
    const double share = poses / static_cast<double>(shortlist.members.size());
    const MatrixXd told =
        share * symmetric_gram(take(problem.candidates, shortlist.members).matrix);
    MatrixXd M = problem.held + told;
    M.diagonal().array() += problem.ridge;
    const double parameters =
        M.ldlt().solve(told).trace() + static_cast<double>(problem.common_rows);
    const double needed = parameters / (poses * rows_each(problem));
    const double square = std::clamp(needed * needed, 0.0, 1.0);
    return 1 + 9 * square * square;
}

bool is_better(const SearchScore& a, const SearchScore& b) {
    if (a.identifies != b.identifies) return a.identifies;
    return a.value > b.value + 1e-12 * std::max(1e-6, std::abs(b.value));
}

MatrixXd SearchProblem::regularised_information(const std::vector<Index>& poses) const {
    MatrixXd M = held + symmetric_gram(take(candidates, poses).matrix);
    M.diagonal().array() += ridge;
    return M;
}

SearchScore SearchProblem::score(const MatrixXd& regularised) const {
    MatrixXd M = regularised;
    M.diagonal().array() -= ridge;
    const double value = evaluate(objective, M);
    if (std::isfinite(value)) return {true, value};
    return {false, evaluate(objective, regularised)};
}

ScoredPoses judge(const SearchProblem& problem, ScoredPoses choice) {
    std::sort(choice.poses.begin(), choice.poses.end());
    const double value =
        choice_value(problem.objective, problem.candidates, problem.options, choice.poses);
    choice.score = {std::isfinite(value), value};
    return choice;
}

std::vector<Index> take_in_order(const SearchProblem& problem, const std::vector<Index>& order) {
    const SelectOptions& options = problem.options;
    Occupancy occupancy(problem.candidates.count(), options);
    std::vector<Index> poses;
    const auto K = static_cast<std::size_t>(options.pose_count);
    for (Index round = 0; round < options.repeat_limit && poses.size() < K; ++round) {
        for (const Index i : order) {
            if (poses.size() == K) break;
            if (!occupancy.allows(i)) continue;
            poses.push_back(i);
            occupancy.add(i);
        }
    }
    return poses;
}

ScoredPoses improve(const SearchProblem& problem, const Shortlist& shortlist,
                    const ScoredPoses& choice) {
    LocalSearch search(problem, shortlist, std::numeric_limits<Index>::max());
    search.start_at(choice);
    search.improve();
    return search.choice();
}

bool has_far(const SearchProblem& problem, const Shortlist& shortlist) {
    return has_exact_gains(problem.objective) &&
           static_cast<Index>(shortlist.members.size()) > near_size(problem);
}

Shortlist nearest(const SearchProblem& problem, const Shortlist& shortlist,
                  const ScoredPoses& choice) {
    LocalSearch search(problem, shortlist, quick_evaluations);
    search.start_at(choice);
    return search.nearest();
}

ScoredPoses improve_with_kicks(const SearchProblem& problem, const Shortlist& shortlist,
                               const ScoredPoses& choice, RandomStream& random) {
    const bool is_far = has_far(problem, shortlist);
    LocalSearch search(problem, shortlist, quick_evaluations);
    search.start_at(choice);
    search.improve();
    Shortlist near;
    while (true) {
        if (is_far) near = search.nearest();
        const ScoredPoses best = search.choice();
        const ScoredPoses kicked = kick(problem, is_far ? near : shortlist, best, random);
        if (!is_better(kicked.score, best.score)) return best;
        search.start_at(kicked);
        if (is_far) search.improve();
    }
}

}  // namespace posewise::detail
