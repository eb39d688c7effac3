#include "branch_and_bound.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/elementary.hpp"
#include "core/parallel.hpp"
#include "explorer.hpp"
#include "objective_bound.hpp"

namespace posewise::detail {
namespace {

constexpr double most_numbers = 3e7;  // of all candidates' information matrices
// Of more of both no proof takes seconds only.
constexpr double likely_numbers = 2e6;
constexpr double likely_choices = 60;  // their logarithm
constexpr double most_waiting = 5e7;   // numbers of all parts that wait
constexpr std::size_t parts_at_once = 16;

bool has_less_bound(const Part& a, const Part& b) { return a.pricing.bound < b.pricing.bound; }

/// The logarithm of n choose m.
double log_choices(double n, double m) {
    return std::lgamma(n + 1) - std::lgamma(m + 1) - std::lgamma(n - m + 1);
}

/// The logarithm of how many choices a part has at most, beyond prices and limits.
double log_size(const PartSetting& setting, const Part& part) {
    const auto n = static_cast<double>(part.open.size());
    const auto m = static_cast<double>(part.missing(setting));
    const double copies = static_cast<double>(setting.problem.options.repeat_limit);
    if (m > n * copies) return -std::numeric_limits<double>::infinity();
    return log_choices(copies > 1 ? n + m - 1 : n, m);
}

/// What is left to be searched of all choices, and what was found.
class Tree {
  public:
    Tree(const PartSetting& setting, const ProofLimits& limits, Part root, Proof& proof)
        : setting_(setting), limits_(limits), proof_(proof) {
        all_ = log_size(setting, root);
        waiting_.push_back(std::move(root));
    }

    void search() {
        while (!waiting_.empty() && !is_over()) search_dearest();
        proof_.is_complete = waiting_.empty();
        proof_.bound = bound();
    }

  private:
    double bound() const {
        const double known = proof_.best.score.value;
        return waiting_.empty() ? known : std::max(known, waiting_.front().pricing.bound);
    }

    bool is_over() const {
        const SelectOptions& options = setting_.problem.options;
        const auto numbers =
            static_cast<double>(waiting_.size() * 3 * waiting_.front().open.size());
        return options.stop.is_set() || seconds_ > limits_.seconds || bound() <= limits_.bound ||
               numbers > most_waiting ||
               (limits_.is_only_if_likely && seconds_ > 0.1 * limits_.seconds &&
                part_waiting() > 0.95);
    }

    /// Of all choices.
    double part_waiting() const {
        double part = 0;
        for (const Part& one : waiting_) part += exponential(log_size(setting_, one) - all_);
        return part;
    }

    void search_dearest() {
        std::vector<Part> parts;
        while (!waiting_.empty() && parts.size() < parts_at_once) {
            std::pop_heap(waiting_.begin(), waiting_.end(), has_less_bound);
            parts.push_back(std::move(waiting_.back()));
            waiting_.pop_back();
        }
        std::vector<std::optional<Explorer>> explorers(parts.size());
        for_each_index(std::ssize(parts), [&](Index k) {
            const auto at = static_cast<std::size_t>(k);
            explorers[at].emplace(setting_, proof_.best);
            explorers[at]->explore(std::move(parts[at]));
        });
        for (auto& explorer : explorers) merge(*explorer);
        const ProgressCallback& progress = setting_.problem.options.progress;
        if (!progress) return;
        const double share = std::min(1.0, seconds_ / limits_.seconds);
        progress({waiting_.empty() ? 1000 : static_cast<Index>(999 * share), 1000,
                  proof_.best.score.value, bound()});
    }

    void merge(Explorer& explorer) {
        keep_better(explorer.best(), proof_.best);
        proof_.tried += explorer.tried();
        seconds_ += explorer.seconds();
        for (Part& part : explorer.left()) {
            waiting_.push_back(std::move(part));
            std::push_heap(waiting_.begin(), waiting_.end(), has_less_bound);
        }
    }

    const PartSetting& setting_;
    const ProofLimits& limits_;
    Proof& proof_;
    std::vector<Part> waiting_;  // a heap, the largest bound in front
    double all_ = 0;
    double seconds_ = 0;
};

/// All choices there are.
Part make_root(const std::vector<Index>& members, const SelectOptions& options,
               const Pricing& pricing) {
    Part root;
    const auto count = std::ssize(members);
    for (Index place = 0; place < count; ++place) root.open.push_back(place);
    root.weights = VectorXd::Constant(
        count, static_cast<double>(options.pose_count) / static_cast<double>(count));
    root.pricing = pricing;
    root.pricing.prices = pricing.prices(members);
    return root;
}

/// The candidates that may be in a choice as good as what is known.
std::vector<Index> find_open(const SearchProblem& problem, const OpenChoices& all,
                             const Pricing& pricing) {
    const auto dearest = all.most_valuable(pricing.prices);
    double least = std::numeric_limits<double>::infinity();
    for (const auto& taken : dearest) least = std::min(least, pricing.prices[taken.candidate]);
    if (!problem.options.groups.empty()) least = -std::numeric_limits<double>::infinity();
    const std::vector<Index> capacity = capacities(problem.candidates.count(), problem.options);
    std::vector<Index> open;
    for (Index i = 0; i < pricing.prices.size(); ++i) {
        if (capacity[static_cast<std::size_t>(i)] > 0 &&
            pricing.prices[i] >= least - spare_price(pricing, dearest)) {
            open.push_back(i);
        }
    }
    return open;
}

}  // namespace

Proof prove(const SearchProblem& problem, const Certificate& certificate, const ScoredPoses& best,
            const ProofLimits& limits) {
    Objective objective = problem.objective;
    objective.sharpness = certificate.sharpness;
    const OpenChoices all = all_open(problem.candidates, problem.options, problem.held);
    const Pricing pricing = price(objective, certificate.M, all, best.score.value);
    Proof proof{best, pricing.bound};
    std::sort(proof.best.poses.begin(), proof.best.poses.end());
    if (!best.score.identifies || pricing.prices.size() == 0 || !(limits.seconds > 0)) return proof;
    const std::vector<Index> open = find_open(problem, all, pricing);
    const ChoiceFilter filter(problem.objective, problem.regularised_information(best.poses));
    const auto numbers = static_cast<double>(std::ssize(open) * filter.packed_size());
    const double choices = log_choices(static_cast<double>(std::ssize(open)),
                                       static_cast<double>(problem.options.pose_count));
    if (numbers > most_numbers) return proof;
    if (limits.is_only_if_likely && numbers > likely_numbers && choices > likely_choices)
        return proof;
    WorkingSet set(problem.candidates);
    set.add(open);
    MatrixXd packed(filter.packed_size(), set.size());
    std::vector<Index> column(static_cast<std::size_t>(problem.candidates.count()), -1);
    for (Index k = 0; k < set.size(); ++k) {
        const Index candidate = open[static_cast<std::size_t>(k)];
        column[static_cast<std::size_t>(candidate)] = k;
        packed.col(k) = filter.pack(information(problem.candidates, {candidate}));
    }
    const VectorXd held = filter.pack(problem.held);
    const EnumerationSetting enumeration{problem, filter, packed, column, held};
    const PartSetting setting{problem, objective, set, enumeration};
    Tree(setting, limits, make_root(open, problem.options, pricing), proof).search();
    return proof;
}

Proof prove_choice(const Blocks& candidates, const SelectOptions& options,
                   const std::vector<Index>& poses, const Certificate& certificate, double bound) {
    const Objective objective = make_objective(candidates, options);
    const MatrixXd held = held_information(candidates, options);
    const SearchProblem problem{candidates, options, objective, held, ridge_of(candidates)};
    return prove(problem, certificate, judge(problem, {poses, {}}),
                 {.seconds = 10 * options.proof.value_or(usual_proof), .bound = bound});
}

}  // namespace posewise::detail
