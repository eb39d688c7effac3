#include "limits.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace posewise::detail {
namespace {

bool has_group_limit(const SelectOptions& options) {
    return options.group_limit > 0 && !options.groups.empty();
}

bool is_before(const VectorXd& values, Index a, Index b) {
    return values[a] != values[b] ? values[a] > values[b] : a < b;
}

}  // namespace

std::vector<Index> capacities(Index candidate_count, const SelectOptions& options) {
    std::vector<Index> result(static_cast<std::size_t>(candidate_count), options.repeat_limit);
    for (const Index i : options.excluded) result[static_cast<std::size_t>(i)] = 0;
    return result;
}

std::vector<Taken> most_valuable(const VectorXd& values, const SelectOptions& options) {
    const std::vector<Index> capacity = capacities(values.size(), options);
    std::vector<Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), Index{0});
    // Without groups nothing beyond the K largest (and the excluded among them) can be reached.
    const Index reach =
        has_group_limit(options)
            ? values.size()
            : std::min(values.size(),
                       options.pose_count + static_cast<Index>(options.excluded.size()));
    std::partial_sort(order.begin(), order.begin() + reach, order.end(),
                      [&](Index a, Index b) { return is_before(values, a, b); });
    std::map<Index, Index> group_free;
    std::vector<Taken> taken;
    Index left = options.pose_count;
    for (Index k = 0; k < reach && left > 0; ++k) {
        const Index i = order[static_cast<std::size_t>(k)];
        Index count = std::min(left, capacity[static_cast<std::size_t>(i)]);
        if (has_group_limit(options)) {
            Index& room =
                group_free
                    .try_emplace(options.groups[static_cast<std::size_t>(i)], options.group_limit)
                    .first->second;
            count = std::min(count, room);
            room -= count;
        }
        if (count > 0) taken.push_back({i, count});
        left -= count;
    }
    return taken;
}

Occupancy::Occupancy(Index candidate_count, const SelectOptions& options)
    : options_(&options), free_(capacities(candidate_count, options)) {
    if (options.least_distance > 0) neighbours_.resize(free_.size(), 0);
    if (!has_group_limit(options)) return;
    std::map<Index, Index> dense;
    for (const Index label : options.groups) {
        group_.push_back(dense.try_emplace(label, static_cast<Index>(dense.size())).first->second);
    }
    group_free_.resize(dense.size(), options.group_limit);
}

bool Occupancy::allows(Index candidate) const {
    const auto i = static_cast<std::size_t>(candidate);
    return free_[i] > 0 && (neighbours_.empty() || neighbours_[i] == 0) &&
           (group_.empty() || group_free_[static_cast<std::size_t>(group_[i])] > 0);
}

void Occupancy::count(Index candidate, Index change) {
    const auto i = static_cast<std::size_t>(candidate);
    free_[i] -= change;
    if (!group_.empty()) group_free_[static_cast<std::size_t>(group_[i])] -= change;
    if (neighbours_.empty()) return;
    const double reach = options_->least_distance * options_->least_distance;
    for (Index other = 0; other < static_cast<Index>(free_.size()); ++other) {
        const double distance =
            (options_->positions.row(other) - options_->positions.row(candidate)).squaredNorm();
        if (other != candidate && distance < reach) {
            neighbours_[static_cast<std::size_t>(other)] += change;
        }
    }
}

}  // namespace posewise::detail
