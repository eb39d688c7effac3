#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {
namespace {

/// Which samples stay.
class Exclusion {
  public:
    explicit Exclusion(const Measurements& measurements)
        : measurements_(measurements),
          stays_(static_cast<std::size_t>(measurements.first_sample.back()), true) {
        for (Index i = 0; i < measurements.configuration_count(); ++i) {
            configuration_of_id_.emplace(measurements.ids[static_cast<std::size_t>(i)], i);
        }
    }

    void leave_out(const std::string& name) {
        if (const auto i = find(name)) {
            return drop(name, first_sample(*i), measurements_.sample_count(*i));
        }
        if (const auto range = find_range(name)) {
            for (Index i = range->first; i <= range->second; ++i) {
                drop(name, first_sample(i), measurements_.sample_count(i));
            }
            return;
        }
        if (const auto range = find_range(name, true)) {
            throw InputError(fmt::format(
                "excluded configurations {}: {} stands after {} in the measurements' order; state "
                "them the other way round, or by commas",
                detail::quote(name),
                detail::quote(measurements_.ids[static_cast<std::size_t>(range->first)]),
                detail::quote(measurements_.ids[static_cast<std::size_t>(range->second)])));
        }
        const std::size_t colon = name.rfind(':');
        const auto i = colon == std::string::npos ? std::nullopt : find(name.substr(0, colon));
        if (!i) {
            throw InputError(fmt::format(
                "excluded configuration {} is not among the measured ones; must be an id, one and "
                "the number of a sample like {}:2, or the first and last of several like {}-{}",
                detail::quote(name), measurements_.ids.front(), measurements_.ids.front(),
                measurements_.ids.back()));
        }
        for (Index k = first_sample(*i); k < first_sample(*i + 1); ++k) {
            if (measurements_.sample_name(*i, k) == name) return drop(name, k, 1);
        }
        throw InputError(fmt::format(
            "excluded sample {} is not among the measured ones; configuration {} has {}, {} to {}",
            detail::quote(name), detail::quote(name.substr(0, colon)),
            detail::count_of(measurements_.sample_count(*i), "sample"),
            measurements_.sample_name(*i, first_sample(*i)),
            measurements_.sample_name(*i, first_sample(*i + 1) - 1)));
    }

    Measurements rest() const {
        std::vector<Index> samples;
        std::vector<Index> configurations;
        Measurements rest;
        rest.notation = measurements_.notation;
        for (Index i = 0; i < measurements_.configuration_count(); ++i) {
            const auto before = samples.size();
            for (Index k = first_sample(i); k < first_sample(i + 1); ++k) {
                if (stays_[static_cast<std::size_t>(k)]) samples.push_back(k);
            }
            if (samples.size() == before) continue;
            configurations.push_back(i);
            rest.ids.push_back(measurements_.ids[static_cast<std::size_t>(i)]);
            rest.first_sample.push_back(static_cast<Index>(samples.size()));
        }
        if (samples.empty()) throw InputError("nothing is left, all samples are excluded");
        rest.configurations = measurements_.configurations(configurations, Eigen::all);
        rest.observations = measurements_.observations(samples, Eigen::all);
        rest.is_seen = measurements_.is_seen(samples, Eigen::all);
        if (measurements_.roll_pitch_yaw.rows() > 0) {
            rest.roll_pitch_yaw = measurements_.roll_pitch_yaw(samples, Eigen::all);
        }
        if (measurements_.sample_names.empty()) return rest;
        for (const Index k : samples) {
            rest.sample_names.push_back(measurements_.sample_names[static_cast<std::size_t>(k)]);
        }
        return rest;
    }

  private:
    std::optional<Index> find(const std::string& id) const {
        const auto found = configuration_of_id_.find(id);
        if (found == configuration_of_id_.end()) return std::nullopt;
        return found->second;
    }

    /// "7-12": both ids, the first no later than the last, or, `is_backward`, later.
    std::optional<std::pair<Index, Index>> find_range(const std::string& name,
                                                      bool is_backward = false) const {
        for (std::size_t dash = name.find('-'); dash != std::string::npos;
             dash = name.find('-', dash + 1)) {
            const auto first = find(name.substr(0, dash));
            const auto last = find(name.substr(dash + 1));
            if (first && last && (*first <= *last) != is_backward) return {{*first, *last}};
        }
        return std::nullopt;
    }

    Index first_sample(Index configuration) const {
        return measurements_.first_sample[static_cast<std::size_t>(configuration)];
    }

    void drop(const std::string& name, Index first, Index count) {
        const auto begin = stays_.begin() + first;
        if (std::find(begin, begin + count, false) != begin + count) {
            throw InputError(detail::quote(name) + " is excluded twice; keep one");
        }
        std::fill(begin, begin + count, false);
    }

    const Measurements& measurements_;
    std::unordered_map<std::string, Index> configuration_of_id_;
    std::vector<bool> stays_;  ///< of each sample
};

}  // namespace

Measurements leave_out(const Measurements& measurements, const std::vector<std::string>& excluded) {
    if (excluded.empty()) return measurements;
    Exclusion exclusion(measurements);
    for (const std::string& name : excluded) exclusion.leave_out(name);
    return exclusion.rest();
}

}  // namespace posewise
