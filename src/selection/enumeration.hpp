#pragma once

#include "choice_filter.hpp"
#include "local_search.hpp"
#include "pricing.hpp"

namespace posewise::detail {

/// Choices that a pricing leaves open: candidates in the order in which choices take them, the
/// dearest first; one that may be taken several times is there so often.
class PricedChoices {
  public:
    /// `candidates` with their prices in `pricing`, how often each may be taken, and how many of
    /// them are `missing`.
    PricedChoices(const std::vector<Index>& candidates, const std::vector<Index>& capacity,
                  const Pricing& pricing, Index missing);

    Index size() const { return static_cast<Index>(candidates_.size()); }
    Index missing() const { return missing_; }
    Index candidate(Index k) const { return candidates_[static_cast<std::size_t>(k)]; }
    double price(Index k) const { return price(k, 1); }
    /// The sum over the next `count` from k on, the dearest there are.
    double price(Index k, Index count) const {
        const auto at = static_cast<std::size_t>(k);
        return price_before_[at + static_cast<std::size_t>(count)] - price_before_[at];
    }
    /// What prices must sum to.
    double needed() const { return needed_; }

    /// How many choices are open, counted no further than beyond `most`; limits of groups and
    /// distances, which leave fewer, are not looked at.
    double count(double most) const;

    /// Calls visit(k) for each position that may come next of `missing` ones, where the prices of
    /// those before it sum to `price`, while that returns true.
    template <typename Visit>
    bool for_each_next(Index from, Index missing, double price, const Visit& visit) const {
        for (Index k = from; k + missing <= size(); ++k) {
            if (price + this->price(k, missing) < needed_) break;
            const bool is_repetition = k > from && candidate(k) == candidate(k - 1);
            if (!is_repetition && !visit(k)) return false;
        }
        return true;
    }

  private:
    bool count(Index from, Index missing, double price, double most, double& counted) const;

    std::vector<Index> candidates_;
    std::vector<double> price_before_;  // sums over the candidates before each
    double needed_;
    Index missing_;
};

/// Keeps the better choice; of equals the lexicographically first.
void keep_better(const ScoredPoses& choice, ScoredPoses& best);

/// What every enumeration of one problem shares.
struct EnumerationSetting {
    const SearchProblem& problem;
    const ChoiceFilter& filter;
    const MatrixXd& information;       // packed B_i^T B_i, a column each
    const std::vector<Index>& column;  // of each candidate
    const VectorXd& held;              // packed
};

/// Tries choices, eight at a time. Of choices that are equally good the lexicographically first is
/// kept.
class Enumerator {
  public:
    Enumerator(const EnumerationSetting& setting, ScoredPoses best);

    /// Tries all open choices that begin with some poses taken; false if there was no time.
    bool run(const std::vector<Index>& taken, const PricedChoices& choices);
    /// Tries one.
    void try_choice(std::vector<Index> poses);

    const ScoredPoses& best() const { return best_; }
    Index tried() const { return tried_; }
    Index scored() const { return scored_; }  ///< of them those that the filter left

  private:
    void push(Index candidate);
    void pop();
    bool complete(const PricedChoices& choices, Index from, Index missing, double price);
    bool try_batch();
    auto packed(Index candidate) const {
        return setting_.information.col(setting_.column[static_cast<std::size_t>(candidate)]);
    }

    const EnumerationSetting& setting_;
    Occupancy occupancy_;
    ChoiceFilter::Batch batch_;
    std::array<std::vector<Index>, lane_width> choices_;  // in the batch
    MatrixXd partial_;  // packed information of the first poses, a column for each number of them
    std::vector<Index> poses_;
    ScoredPoses best_;
    Index tried_ = 0;
    Index scored_ = 0;
};

}  // namespace posewise::detail
