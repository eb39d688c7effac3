#include "relaxation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/sensitivities.hpp"
#include "criteria/information_function.hpp"
#include "limits.hpp"
#include "objective_bound.hpp"
#include "projected_gradient.hpp"

namespace posewise::detail {
namespace {

constexpr Index first_set_size = 1000;
constexpr Index iteration_limit = 500;        // of each ascent
constexpr Index rough_iteration_limit = 150;  // where the objective is sharpened step by step
constexpr Index round_limit = 40;
constexpr double first_sharpness = 8;
constexpr double last_sharpness = 512;

/// The `count` allowed candidates of largest value outside the set (all with more than `least`).
std::vector<Index> best_outside(const VectorXd& values, const std::vector<char>& is_inside,
                                double least, Index count) {
    std::vector<Index> found;
    for (Index i = 0; i < values.size(); ++i) {
        if (is_inside[static_cast<std::size_t>(i)] == 0 && values[i] > least) found.push_back(i);
    }
    const auto kept = std::min(count, static_cast<Index>(found.size()));
    std::partial_sort(found.begin(), found.begin() + kept, found.end(), [&](Index a, Index b) {
        return values[a] != values[b] ? values[a] > values[b] : a < b;
    });
    found.resize(static_cast<std::size_t>(kept));
    return found;
}

/// Working set, weights and the best certificate so far of one relaxation.
class Relaxer {
  public:
    Relaxer(const Objective& objective, const Blocks& candidates, const SelectOptions& options,
            const VectorXd& start)
        : candidates_(candidates),
          options_(options),
          objective_(objective),
          held_(held_information(candidates, options)),
          open_(all_open(candidates, options, held_)),
          set_(candidates),
          is_inside_(static_cast<std::size_t>(candidates.count()), 0) {
        if (!is_smooth(options.criterion)) objective_.sharpness = first_sharpness;
        const std::vector<Index> capacity = capacities(candidates.count(), options);
        for (Index i = 0; i < candidates.count(); ++i) {
            if (capacity[static_cast<std::size_t>(i)] == 0)
                is_inside_[static_cast<std::size_t>(i)] = 1;
        }
        if (start.size() > 0) start_from(start);
        if (set_.size() == 0) start_set();
    }

    Relaxation run() {
        for (Index round = 0; round < round_limit; ++round) {
            const double finest = std::isinf(objective_.sharpness)
                                      ? 0.5 * options_.gap
                                      : std::max(0.5 * options_.gap, 0.02 / objective_.sharpness);
            // What is far off is solved roughly.
            const double tolerance = std::clamp(0.05 * open_gap_, finest, std::max(finest, 0.05));
            const WeightSearch search =
                ascend({objective_, set_, held_, upper_, static_cast<double>(options_.pose_count)},
                       weights_, tolerance,
                       is_smooth(options_.criterion) ? iteration_limit : rough_iteration_limit,
                       options_.stop);
            weights_ = search.weights;
            result_.iterations += search.iterations;
            const Pricing pricing = price(objective_, search.M, open_, 1);
            const VectorXd sensitivity = sensitivity_of(search.M, pricing);
            keep_if_better(search.M, pricing.bound, sensitivity);
            open_gap_ = gap(search.M);
            const bool is_rough = tolerance > finest;
            if (options_.stop.is_set() || (open_gap_ <= options_.gap && !is_rough)) break;
            if (grow(sensitivity, search.threshold)) continue;
            if (is_rough) {
                open_gap_ = 0;  // there is nothing left but to solve it better
            } else if (!sharpen()) {
                break;
            }
        }
        return std::move(result_);
    }

  private:
    void join(const std::vector<Index>& candidates) {
        for (const Index i : candidates) is_inside_[static_cast<std::size_t>(i)] = 1;
        set_.add(candidates);
        weights_.conservativeResize(set_.size());
        weights_.tail(static_cast<Index>(candidates.size())).setZero();
        upper_ = VectorXd::Constant(set_.size(), static_cast<double>(options_.repeat_limit));
    }

    void start_from(const VectorXd& start) {
        std::vector<Index> members;
        for (Index i = 0; i < start.size(); ++i) {
            if (start[i] > 0 && is_inside_[static_cast<std::size_t>(i)] == 0) members.push_back(i);
        }
        join(members);
        weights_ = start(members);
    }

    /// Candidates spread evenly over the list, as many as it takes to identify the parameters, all
    /// with the same weight.
    void start_set() {
        std::vector<Index> open;
        for (Index i = 0; i < candidates_.count(); ++i) {
            if (is_inside_[static_cast<std::size_t>(i)] == 0) open.push_back(i);
        }
        const auto count = static_cast<Index>(open.size());
        for (Index size = first_set_size;; size *= 4) {
            const Index stride = std::max<Index>(1, count / size);
            std::vector<Index> spread;
            for (Index k = 0; k < count; k += stride) {
                const Index i = open[static_cast<std::size_t>(k)];
                if (is_inside_[static_cast<std::size_t>(i)] == 0) spread.push_back(i);
            }
            join(spread);
            weights_.setConstant(static_cast<double>(options_.pose_count) /
                                 static_cast<double>(set_.size()));
            const MatrixXd M = held_ + set_.weighted_information(weights_);
            if (stride == 1 || std::isfinite(evaluate(objective_, M))) return;
        }
    }

    /// Of all candidates, of the logarithm at M. Their prices, too, are sensitivities, but for a
    /// factor.
    VectorXd sensitivity_of(const MatrixXd& M, const Pricing& pricing) const {
        const Criterion criterion = objective_.criterion;
        const MatrixXd slope = log_gradient(objective_, M);
        if (pricing.prices.size() == 0 || criterion == Criterion::G ||
            !has_information_function(criterion)) {
            return sensitivities(candidates_, slope);
        }
        return slope.norm() / supporting_matrix(objective_, M).norm() * pricing.prices;
    }

    void keep_if_better(const MatrixXd& M, double bound, const VectorXd& sensitivity) {
        if (result_.certificate.M.size() > 0 && !(bound < result_.bound)) return;
        result_.certificate = {M, objective_.sharpness};
        result_.bound = bound;
        result_.sensitivity = sensitivity;
        result_.weights = VectorXd::Zero(candidates_.count());
        result_.weights(set_.members()) = weights_;
    }

    /// How much the information of the bound exceeds that of M, relative to it.
    double gap(const MatrixXd& M) const {
        Objective exact = objective_;
        exact.sharpness = std::numeric_limits<double>::infinity();
        const Index L = M.rows();
        const double value = evaluate(exact, M);
        if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
        return information_of_value(exact, result_.bound, L) /
                   information_of_value(exact, value, L) -
               1;
    }

    bool grow(const VectorXd& sensitivity, double threshold) {
        const std::vector<Index> joining =
            best_outside(sensitivity, is_inside_, threshold, std::max<Index>(200, set_.size() / 4));
        if (joining.empty()) return false;
        drop_idle(sensitivity);
        join(joining);
        return true;
    }

    /// Drops members without weight; as many as have some are spared, the most sensitive ones.
    void drop_idle(const VectorXd& sensitivity) {
        std::vector<Index> kept;
        std::vector<Index> idle;
        for (Index k = 0; k < set_.size(); ++k) (weights_[k] > 0 ? kept : idle).push_back(k);
        const auto member = [&](Index k) { return set_.members()[static_cast<std::size_t>(k)]; };
        std::stable_sort(idle.begin(), idle.end(), [&](Index a, Index b) {
            return sensitivity[member(a)] > sensitivity[member(b)];
        });
        const std::size_t spared = std::min(kept.size(), idle.size());
        for (std::size_t i = 0; i < idle.size(); ++i) {
            if (i < spared) {
                kept.push_back(idle[i]);
            } else {
                is_inside_[static_cast<std::size_t>(member(idle[i]))] = 0;
            }
        }
        weights_ = VectorXd(weights_(kept));
        set_ = WorkingSet(set_, kept);
    }

    bool sharpen() {
        if (!(objective_.sharpness < last_sharpness)) return false;
        objective_.sharpness *= 4;
        return true;
    }

    const Blocks& candidates_;
    const SelectOptions& options_;
    Objective objective_;
    MatrixXd held_;
    OpenChoices open_;
    WorkingSet set_;
    std::vector<char> is_inside_;  // or excluded
    VectorXd weights_;             // of the set's members
    VectorXd upper_;
    double open_gap_ = std::numeric_limits<double>::infinity();
    Relaxation result_;
};

}  // namespace

Relaxation relax(const Objective& objective, const Blocks& candidates, const SelectOptions& options,
                 const VectorXd& start) {
    return Relaxer(objective, candidates, options, start).run();
}

}  // namespace posewise::detail
