#include "part.hpp"

#include <algorithm>
#include <numeric>

#include "criteria/information_function.hpp"

namespace posewise::detail {
namespace {

void keep_open(const std::vector<Index>& kept, Part& part) {
    VectorXd weights = part.weights(kept);
    VectorXd prices = part.pricing.prices(kept);
    std::vector<Index> open;
    for (const Index k : kept) open.push_back(part.open[static_cast<std::size_t>(k)]);
    part.open = std::move(open);
    part.weights = std::move(weights);
    part.pricing.prices = std::move(prices);
}

/// Places in the list of open ones where `is_kept(place)`.
template <typename IsKept>
std::vector<Index> places_where(const Part& part, const IsKept& is_kept) {
    std::vector<Index> kept;
    for (Index k = 0; k < std::ssize(part.open); ++k) {
        if (is_kept(k)) kept.push_back(k);
    }
    return kept;
}

void close_forbidden(const PartSetting& setting, Part& part) {
    Occupancy occupancy(setting.problem.candidates.count(), setting.problem.options);
    for (const Index place : part.taken) occupancy.add(setting.candidate(place));
    const auto kept = places_where(part, [&](Index k) {
        return occupancy.allows(setting.candidate(part.open[static_cast<std::size_t>(k)]));
    });
    if (kept.size() < part.open.size()) keep_open(kept, part);
}

/// Takes the candidates without which the dearest choice is too cheap; else closes those with
/// which it is. Whether it took any.
bool apply_prices(const PartSetting& setting, const std::vector<Taken>& dearest, Part& part) {
    const VectorXd& prices = part.pricing.prices;
    const std::vector<Index> capacity = part.capacity(setting);
    const double spare = spare_price(part.pricing, dearest);
    const auto and_next = most_valuable(prices, capacity, part.missing(setting) + 1);
    const double next = sum_of(prices, and_next) - sum_of(prices, dearest);
    std::vector<char> is_demanded(part.open.size(), 0);
    double demanded = 0;
    for (const auto& [k, count] : dearest) {
        if (capacity[static_cast<std::size_t>(k)] != 1 || !(prices[k] - next > spare)) continue;
        is_demanded[static_cast<std::size_t>(k)] = 1;
        part.taken.push_back(part.open[static_cast<std::size_t>(k)]);
        demanded += prices[k];
    }
    const double least = prices[dearest.back().candidate] - spare;
    const auto kept = places_where(part, [&](Index k) {
        return is_demanded[static_cast<std::size_t>(k)] == 0 && prices[k] >= least;
    });
    if (kept.size() < part.open.size()) keep_open(kept, part);
    part.pricing.held += demanded;
    return demanded != 0;
}

}  // namespace

std::vector<Index> PartSetting::candidates(const std::vector<Index>& places) const {
    std::vector<Index> result;
    for (const Index place : places) result.push_back(candidate(place));
    return result;
}

Index Part::missing(const PartSetting& setting) const {
    return setting.problem.options.pose_count - static_cast<Index>(taken.size());
}

std::vector<Index> Part::capacity(const PartSetting& setting) const {
    std::vector<Index> result;
    for (const Index place : open) {
        result.push_back(setting.problem.options.repeat_limit -
                         std::count(taken.begin(), taken.end(), place));
    }
    return result;
}

PricedChoices Part::choices(const PartSetting& setting) const {
    return {setting.candidates(open), capacity(setting), pricing, missing(setting)};
}

std::vector<Taken> most_valuable(const VectorXd& values, const std::vector<Index>& capacity,
                                 Index missing) {
    std::vector<Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) {
        return values[a] != values[b] ? values[a] > values[b] : a < b;
    });
    std::vector<Taken> taken;
    for (const Index k : order) {
        if (missing == 0) break;
        const Index count = std::min(missing, capacity[static_cast<std::size_t>(k)]);
        taken.push_back({k, count});
        missing -= count;
    }
    return taken;
}

double spare_price(const Pricing& pricing, const std::vector<Taken>& dearest) {
    return pricing.held + sum_of(pricing.prices, dearest) - pricing.needed;
}

Left reduce(const PartSetting& setting, double value, Part& part) {
    if (has_information_function(setting.objective.criterion)) {
        part.pricing.needed =
            needed_information(setting.objective, value,
                               setting.problem.candidates.parameter_count(), part.pricing.rounding);
    }
    bool has_taken = true;
    while (has_taken) {
        close_forbidden(setting, part);
        const Index missing = part.missing(setting);
        if (missing == 0) return Left::One;
        const std::vector<Index> capacity = part.capacity(setting);
        if (std::accumulate(capacity.begin(), capacity.end(), Index{0}) < missing) {
            return Left::None;
        }
        const auto dearest = most_valuable(part.pricing.prices, capacity, missing);
        if (!(spare_price(part.pricing, dearest) >= 0)) return Left::None;
        has_taken = apply_prices(setting, dearest, part);
    }
    return Left::Many;
}

std::array<Part, 2> split(const PartSetting& setting, const Part& part) {
    Index chosen = 0;
    part.weights.maxCoeff(&chosen);
    const auto others = places_where(part, [&](Index k) { return k != chosen; });
    std::array<Part, 2> halves{part, part};
    halves[0].taken.push_back(part.open[static_cast<std::size_t>(chosen)]);
    halves[0].pricing.held += part.pricing.prices[chosen];
    if (part.capacity(setting)[static_cast<std::size_t>(chosen)] > 1) {
        halves[0].weights[chosen] = std::max(0.0, part.weights[chosen] - 1);
    } else {
        keep_open(others, halves[0]);
    }
    keep_open(others, halves[1]);
    return halves;
}

}  // namespace posewise::detail
