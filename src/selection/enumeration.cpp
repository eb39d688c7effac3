#include "enumeration.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "../core/parallel.hpp"
#include "../core/sensitivities.hpp"
#include "../criteria/information_function.hpp"
#include "choice_filter.hpp"
#include "limits.hpp"

namespace posewise::detail {
namespace {

/// Choices times parameters cubed. The filter takes half a second to a second of a CPU for 1e10.
constexpr double short_work = 1e10;
constexpr double full_work = 1.5e11;
constexpr double most_numbers = 3e7;  // of all candidates' information matrices
constexpr std::size_t least_branches = 64;

/// Candidates in the order in which choices take them, the most sensitive first; one that may be
/// repeated is there so often. By the supporting hyperplane of the relaxation's certificate, a
/// choice's information is at most `held` + the sum of its prices.
struct Tree {
    std::vector<Index> candidates;
    std::vector<double> price_before;  // sums over the candidates before each
    double held = 0;
    Index pose_count = 0;

    Index size() const { return static_cast<Index>(candidates.size()); }
    Index candidate(Index k) const { return candidates[static_cast<std::size_t>(k)]; }
    /// The sum over the next `count` from k on, the best there are.
    double price(Index k, Index count = 1) const {
        const auto at = static_cast<std::size_t>(k);
        return price_before[at + static_cast<std::size_t>(count)] - price_before[at];
    }
    /// Whether k only repeats a choice that took its equal before it.
    bool is_repetition(Index from, Index k) const {
        return k > from && candidate(k) == candidate(k - 1);
    }
};

/// Part of a choice: positions of the tree, ascending.
struct Branch {
    std::vector<Index> positions;
    double price = 0;
    Index from() const { return positions.empty() ? 0 : positions.back() + 1; }
};

/// Calls visit(k) for each position that may come next to reach `needed`, while that returns true.
template <typename Visit>
bool for_each_next(const Tree& tree, Index from, Index missing, double price, double needed,
                   const Visit& visit) {
    for (Index k = from; k + missing <= tree.size(); ++k) {
        if (price + tree.price(k, missing) < needed) break;
        if (!tree.is_repetition(from, k) && !visit(k)) return false;
    }
    return true;
}

/// What the information function must reach for a choice to be as good as `value`.
double needed_information(const SearchProblem& problem, double value) {
    if (!has_information_function(problem.objective.criterion)) {
        return -std::numeric_limits<double>::infinity();
    }
    return (1 - 1e-9) *
           information_of_value(problem.objective, value, problem.candidates.parameter_count());
}

Tree make_tree(const SearchProblem& problem, const Relaxation& relaxation) {
    Tree tree;
    tree.pose_count = problem.options.pose_count;
    const Index N = problem.candidates.count();
    VectorXd prices = VectorXd::Zero(N);
    if (has_information_function(problem.objective.criterion)) {
        Objective objective = problem.objective;
        objective.sharpness = relaxation.certificate.sharpness;
        const MatrixXd Z = supporting_matrix(objective, relaxation.certificate.M);
        prices = sensitivities(problem.candidates, Z);
        tree.held = Z.cwiseProduct(problem.held).sum();
    }
    std::vector<Index> order(static_cast<std::size_t>(N));
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) {
        return prices[a] != prices[b] ? prices[a] > prices[b] : a < b;
    });
    const std::vector<Index> capacity = capacities(N, problem.options);
    tree.price_before.push_back(0);
    for (const Index i : order) {
        const Index copies = std::min(capacity[static_cast<std::size_t>(i)], tree.pose_count);
        for (Index copy = 0; copy < copies; ++copy) {
            tree.candidates.push_back(i);
            tree.price_before.push_back(tree.price_before.back() + prices[i]);
        }
    }
    return tree;
}

/// How much longer a choice takes than by D, where the filter rules out fewer of them.
double work_beside_filter(Criterion criterion) {
    if (criterion == Criterion::O5) return 30;
    return criterion == Criterion::G ? 7 : 1;
}

/// How many choices the bound leaves open, counted no further than beyond `most`. Limits of groups
/// and distances, which leave fewer, are not looked at.
class Counter {
  public:
    Counter(const Tree& tree, double needed, double most)
        : tree_(tree), needed_(needed), most_(most) {}

    double count() {
        complete(0, tree_.pose_count, tree_.held);
        return count_;
    }

  private:
    bool complete(Index from, Index missing, double price) {
        return for_each_next(tree_, from, missing, price, needed_, [&](Index k) {
            if (missing > 1) return complete(k + 1, missing - 1, price + tree_.price(k));
            return ++count_ <= most_;
        });
    }

    const Tree& tree_;
    double needed_;
    double most_;
    double count_ = 0;
};

/// Parts of choices that together begin all of them: enough for every thread, few enough to forget.
std::vector<Branch> make_branches(const Tree& tree, double needed) {
    std::vector<Branch> branches(1);
    branches.front().price = tree.held;
    for (Index missing = tree.pose_count; missing > 1 && branches.size() < least_branches;
         --missing) {
        std::vector<Branch> longer;
        for (const Branch& branch : branches) {
            for_each_next(tree, branch.from(), missing, branch.price, needed, [&](Index k) {
                Branch& next = longer.emplace_back(branch);
                next.positions.push_back(k);
                next.price += tree.price(k);
                return true;
            });
        }
        branches = std::move(longer);
    }
    return branches;
}

/// Keeps the better choice; of equals the lexicographically first.
void keep_better(const ScoredPoses& choice, ScoredPoses& best) {
    const bool is_first_of_equals =
        !is_better(best.score, choice.score) && choice.poses < best.poses;
    if (is_better(choice.score, best.score) || is_first_of_equals) best = choice;
}

/// What all branches share.
struct Setting {
    const SearchProblem& problem;
    const Tree& tree;
    const ChoiceFilter& filter;
    const MatrixXd& information;  // packed, a column for each position of the tree
    const VectorXd& held;         // packed
};

/// Visits every choice that begins with one branch.
class Enumerator {
  public:
    Enumerator(const Setting& setting, const ScoredPoses& best)
        : setting_(setting),
          occupancy_(setting.problem.candidates.count(), setting.problem.options),
          batch_(setting.filter.make_batch()),
          partial_(setting.held.size(), setting.tree.pose_count),
          best_(best) {
        partial_.col(0) = setting.held;
        find_needed();
    }

    /// The best choice, `best` included; nothing if there was no time for all.
    std::optional<ScoredPoses> run(const Branch& branch) {
        for (const Index k : branch.positions) {
            if (!occupancy_.allows(setting_.tree.candidate(k))) return best_;
            push(k);
        }
        const bool is_done = complete(branch.from(), branch.price) && try_batch();
        if (!is_done) return std::nullopt;
        return best_;
    }

  private:
    void push(Index k) {
        const auto depth = static_cast<Index>(poses_.size());
        poses_.push_back(setting_.tree.candidate(k));
        occupancy_.add(poses_.back());
        if (depth + 1 < partial_.cols()) {
            partial_.col(depth + 1) = partial_.col(depth) + setting_.information.col(k);
        }
    }
    void pop() {
        occupancy_.remove(poses_.back());
        poses_.pop_back();
    }

    bool complete(Index from, double price) {
        const Tree& tree = setting_.tree;
        const auto depth = static_cast<Index>(poses_.size());
        const Index missing = tree.pose_count - depth;
        return for_each_next(tree, from, missing, price, needed_, [&](Index k) {
            const Index candidate = tree.candidate(k);
            if (!occupancy_.allows(candidate)) return true;
            if (missing > 1) {
                push(k);
                const bool is_done = complete(k + 1, price + tree.price(k));
                pop();
                return is_done;
            }
            choices_[static_cast<std::size_t>(batch_.count)] = poses_;
            choices_[static_cast<std::size_t>(batch_.count)].push_back(candidate);
            setting_.filter.add(partial_.col(depth).data(), setting_.information.col(k).data(),
                                batch_);
            return batch_.count < lane_width || try_batch();
        });
    }

    /// False where there is no time.
    bool try_batch() {
        const auto count = static_cast<std::size_t>(batch_.count);
        const auto may_reach = setting_.filter.may_reach(best_.score.value, batch_);
        for (std::size_t k = 0; k < count; ++k) {
            if (!may_reach[k]) continue;
            ScoredPoses choice{choices_[k], {}};
            std::sort(choice.poses.begin(), choice.poses.end());
            choice.score =
                setting_.problem.score(setting_.problem.regularised_information(choice.poses));
            keep_better(choice, best_);
        }
        find_needed();
        return !setting_.problem.options.stop.is_set();
    }

    void find_needed() { needed_ = needed_information(setting_.problem, best_.score.value); }

    const Setting& setting_;
    Occupancy occupancy_;
    ChoiceFilter::Batch batch_;
    std::array<std::vector<Index>, lane_width> choices_;  // in the batch
    MatrixXd partial_;  // packed information of the first poses, a column for each number of them
    std::vector<Index> poses_;
    ScoredPoses best_;
    double needed_ = 0;
};

/// Packed B^T B of each position of the tree.
MatrixXd pack_informations(const SearchProblem& problem, const Tree& tree,
                           const ChoiceFilter& filter) {
    MatrixXd packed(filter.packed_size(), tree.size());
    for (Index k = 0; k < tree.size(); ++k) {
        packed.col(k) = filter.pack(information(problem.candidates, {tree.candidate(k)}));
    }
    return packed;
}

Enumerated enumerate(const SearchProblem& problem, const Tree& tree, ScoredPoses best) {
    const ChoiceFilter filter(problem.objective, problem.regularised_information(best.poses));
    const MatrixXd information = pack_informations(problem, tree, filter);
    const VectorXd held = filter.pack(problem.held);
    const Setting setting{problem, tree, filter, information, held};
    const auto branches = make_branches(tree, needed_information(problem, best.score.value));
    std::vector<std::optional<ScoredPoses>> found(branches.size());
    for_each_index(static_cast<Index>(branches.size()), [&](Index k) {
        const auto at = static_cast<std::size_t>(k);
        found[at] = Enumerator(setting, best).run(branches[at]);
    });
    Enumerated result{std::move(best), 0, true};
    for (const auto& choice : found) {
        if (choice) keep_better(*choice, result.best);
        result.is_complete = result.is_complete && choice;
    }
    return result;
}

}  // namespace

std::optional<Enumerated> enumerate_open_choices(const SearchProblem& problem,
                                                 const Relaxation& relaxation,
                                                 const ScoredPoses& best, Patience patience) {
    if (!best.score.identifies || problem.options.enumeration == 0) return std::nullopt;
    const auto L = static_cast<double>(problem.candidates.parameter_count());
    const double each = L * L * L * work_beside_filter(problem.objective.criterion);
    const double work = patience == Patience::Short ? short_work : full_work;
    const double most = std::min(static_cast<double>(problem.options.enumeration), work / each);
    const Tree tree = make_tree(problem, relaxation);
    const double needed = needed_information(problem, best.score.value);
    const double count = Counter(tree, needed, most).count();
    if (count > most || static_cast<double>(tree.size()) * L * L / 2 > most_numbers) {
        return std::nullopt;
    }
    ScoredPoses first = best;
    std::sort(first.poses.begin(), first.poses.end());
    Enumerated result = enumerate(problem, tree, std::move(first));
    result.tried = static_cast<Index>(count);
    return result;
}

}  // namespace posewise::detail
