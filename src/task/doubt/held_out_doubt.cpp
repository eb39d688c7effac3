#include "held_out_doubt.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "nominal_residuals.hpp"

namespace posewise {
namespace {

constexpr double beyond_chance = 2.5758;  // one-sided, 0.005 of normal deviates
constexpr double shown = 1.6449;          // 0.05

/// Ranks from 1 by size; equal ones share their mean rank.
std::vector<double> ranks_by_size(const std::vector<double>& numbers) {
    std::vector<std::size_t> order(numbers.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto size = [&](std::size_t k) { return std::abs(numbers[k]); };
    std::ranges::sort(order, [&](auto a, auto b) { return size(a) < size(b); });
    std::vector<double> ranks(numbers.size());
    for (std::size_t first = 0; first < order.size();) {
        std::size_t end = first;
        while (end < order.size() && size(order[end]) == size(order[first])) ++end;
        const double mean = 0.5 * static_cast<double>(first + 1 + end);
        for (; first < end; ++first) ranks[order[first]] = mean;
    }
    return ranks;
}

}  // namespace

bool HeldOutComparison::is_worse() const { return rank_deviations > beyond_chance; }

bool HeldOutComparison::is_no_better() const {
    constexpr Index enough = 5;
    return configurations >= enough && rank_deviations > -shown;
}

namespace detail {

double rank_deviations(const VectorXd& after, const VectorXd& before, Index* count) {
    std::vector<double> differences;
    for (Index i = 0; i < after.size(); ++i) {
        if (!(after[i] > 0 && before[i] > 0)) continue;
        const double difference = std::log(after[i] / before[i]);
        if (std::isfinite(difference)) differences.push_back(difference);
    }
    if (count != nullptr) *count = std::ssize(differences);
    const std::vector<double> ranks = ranks_by_size(differences);
    double sum = 0;
    double variance = 0;
    for (std::size_t k = 0; k < ranks.size(); ++k) {
        if (differences[k] == 0) continue;
        sum += std::copysign(ranks[k], differences[k]);
        variance += ranks[k] * ranks[k];
    }
    return variance > 0 ? sum / std::sqrt(variance) : 0;
}

double rms_of(const RowMatrixXd& squares, const Seen& is_judged) {
    const auto count = static_cast<double>(std::max<Index>(1, is_judged.count()));
    return std::sqrt(is_judged.select(squares, 0).sum() / count);
}

Seen points_held_out(const Measurements& measurements, const CrossValidation& held_out) {
    Seen is_judged = times_seen(measurements).array() > 0;
    for (Index i = 0; i < is_judged.rows(); ++i) {
        // Not found, or of no length.
        is_judged.row(i) = is_judged.row(i) && held_out.squared_distances.row(i).array() != 0;
    }
    return is_judged;
}

Index comparable_folds(Index asked, Index configuration_count) {
    constexpr Index usual = 10;
    if (asked > 0) return asked;
    return configuration_count < 2 ? 0 : std::min(usual, configuration_count);
}

std::optional<HeldOutComparison> compare_with_nominal(const Campaign& campaign, const Chain& robot,
                                                      const Measurements& measurements,
                                                      Parameters registered,
                                                      const CrossValidation& calibrated,
                                                      const LevenbergMarquardtOptions& options) {
    const NominalRobot nominal =
        fit_nominal_robot(campaign, robot, measurements, std::move(registered), options);
    if (!nominal.fitted.undetermined.empty()) return std::nullopt;
    const CrossValidation held_out = cross_validate(
        nominal.campaign, measurements, nominal.fitted.parameters, calibrated.folds, options);
    const Seen is_judged = points_held_out(measurements, calibrated).array() &&
                           points_held_out(measurements, held_out).array();
    if (is_judged.count() == 0) return std::nullopt;
    const auto sums = [&](const CrossValidation& one) -> VectorXd {
        return is_judged.select(one.squared_distances, 0).rowwise().sum();
    };
    HeldOutComparison comparison{rms_of(calibrated.squared_distances, is_judged),
                                 rms_of(held_out.squared_distances, is_judged), 0, 0};
    comparison.rank_deviations =
        rank_deviations(sums(calibrated), sums(held_out), &comparison.configurations);
    return comparison;
}

}  // namespace detail
}  // namespace posewise
