#include "enumeration.hpp"

#include <algorithm>
#include <numeric>

namespace posewise::detail {
void keep_better(const ScoredPoses& choice, ScoredPoses& best) {
    const bool is_first_of_equals =
        !is_better(best.score, choice.score) && choice.poses < best.poses;
    if (is_better(choice.score, best.score) || is_first_of_equals) best = choice;
}

PricedChoices::PricedChoices(const std::vector<Index>& candidates,
                             const std::vector<Index>& capacity, const Pricing& pricing,
                             Index missing)
    : needed_(pricing.needed - pricing.held), missing_(missing) {
    std::vector<std::size_t> order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto price_of = [&](std::size_t k) { return pricing.prices[static_cast<Index>(k)]; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return price_of(a) != price_of(b) ? price_of(a) > price_of(b)
                                          : candidates[a] < candidates[b];
    });
    price_before_.push_back(0);
    for (const std::size_t k : order) {
        for (Index copy = 0; copy < std::min(capacity[k], missing); ++copy) {
            candidates_.push_back(candidates[k]);
            price_before_.push_back(price_before_.back() + price_of(k));
        }
    }
}

double PricedChoices::count(double most) const {
    double counted = 0;
    count(0, missing_, 0, most, counted);
    return counted;
}

bool PricedChoices::count(Index from, Index missing, double price, double most,
                          double& counted) const {
    return for_each_next(from, missing, price, [&](Index k) {
        if (missing > 1) return count(k + 1, missing - 1, price + this->price(k), most, counted);
        return ++counted <= most;
    });
}

Enumerator::Enumerator(const EnumerationSetting& setting, ScoredPoses best)
    : setting_(setting),
      occupancy_(setting.problem.candidates.count(), setting.problem.options),
      batch_(setting.filter.make_batch()),
      partial_(setting.held.size(), setting.problem.options.pose_count),
      best_(std::move(best)) {
    partial_.col(0) = setting.held;
}

bool Enumerator::run(const std::vector<Index>& taken, const PricedChoices& choices) {
    for (const Index candidate : taken) push(candidate);
    const bool is_done = complete(choices, 0, choices.missing(), 0) && try_batch();
    while (!poses_.empty()) pop();
    batch_.count = 0;
    return is_done;
}

void Enumerator::try_choice(std::vector<Index> poses) {
    keep_better(judge(setting_.problem, {std::move(poses), {}}), best_);
    ++scored_;
}

void Enumerator::push(Index candidate) {
    const auto depth = static_cast<Index>(poses_.size());
    poses_.push_back(candidate);
    occupancy_.add(candidate);
    if (depth + 1 < partial_.cols()) {
        partial_.col(depth + 1) = partial_.col(depth) + packed(candidate);
    }
}

void Enumerator::pop() {
    occupancy_.remove(poses_.back());
    poses_.pop_back();
}

bool Enumerator::complete(const PricedChoices& choices, Index from, Index missing, double price) {
    const auto depth = static_cast<Index>(poses_.size());
    return choices.for_each_next(from, missing, price, [&](Index k) {
        const Index candidate = choices.candidate(k);
        if (!occupancy_.allows(candidate)) return true;
        if (missing > 1) {
            push(candidate);
            const bool is_done = complete(choices, k + 1, missing - 1, price + choices.price(k));
            pop();
            return is_done;
        }
        choices_[static_cast<std::size_t>(batch_.count)] = poses_;
        choices_[static_cast<std::size_t>(batch_.count)].push_back(candidate);
        setting_.filter.add(partial_.col(depth).data(), packed(candidate).data(), batch_);
        return batch_.count < lane_width || try_batch();
    });
}

/// False where there is no time.
bool Enumerator::try_batch() {
    const Index count = batch_.count;
    tried_ += count;
    const auto may_reach = setting_.filter.may_reach(best_.score.value, batch_);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
        if (may_reach[k]) try_choice(choices_[k]);
    }
    return !setting_.problem.options.stop.is_set();
}

}  // namespace posewise::detail
