#include "pricing.hpp"

#include <algorithm>
#include <cmath>

#include "bound.hpp"
#include "core/decompositions.hpp"
#include "criteria/information_function.hpp"
#include "criteria/spectral.hpp"

namespace posewise::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double least_rounding = 1e-9;  // of values that are compared
constexpr double most_rounding = 0.1;    // beyond it nothing is proven

/// Sums of two kinds of prices over a choice: it has at most `least` as its least eigenvalue, and
/// at least `largest` as its largest.
struct Extremes {
    double least = 0;
    double largest = 0;
};

/// Bounds of both extreme eigenvalues: lambda_min <= trace(Z M*) and lambda_max >= trace(Y M*) for
/// any Z, Y >= 0 of trace 1; here those of the softened extreme eigenvalues of M.
class ExtremePrices {
  public:
    ExtremePrices(const MatrixXd& M, double p, const OpenChoices& open) : open_(open) {
        const auto eigen = eigen_decomposition(M);
        const VectorXd& lambda = eigen.eigenvalues();
        const auto weighted = [&](const Eigen::ArrayXd& weights) -> MatrixXd {
            return eigen.eigenvectors() * (weights / weights.sum()).matrix().asDiagonal() *
                   eigen.eigenvectors().transpose();
        };
        const Index last = lambda.size() - 1;
        Eigen::ArrayXd weak = VectorXd::Unit(lambda.size(), 0);
        Eigen::ArrayXd strong = VectorXd::Unit(lambda.size(), last);
        if (std::isfinite(p)) {
            weak = powers(lambda[0] / lambda.array(), p + 1);
            strong = powers(lambda.array() / lambda[last], p - 1);
        }
        const MatrixXd Z = weighted(weak);
        const MatrixXd Y = weighted(strong);
        least = open.sensitivities(Z);
        largest = open.sensitivities(Y);
        held = {Z.cwiseProduct(open.held).sum(), Y.cwiseProduct(open.held).sum()};
    }

    /// The choice that is farthest out along least - slope largest.
    Extremes farthest(double slope) const { return sums(least - slope * largest); }
    Extremes with_least_largest() const { return sums(-largest); }
    Extremes with_largest_largest() const { return sums(largest); }

    VectorXd least;
    VectorXd largest;
    Extremes held;

  private:
    Extremes sums(const VectorXd& values) const {
        const auto taken = open_.most_valuable(values);
        return {held.least + sum_of(least, taken), held.largest + sum_of(largest, taken)};
    }

    const OpenChoices& open_;
};

/// The largest least / largest over all choices, exactly [Dinkelbach 1967].
double largest_ratio(const ExtremePrices& prices) {
    double ratio = 0;
    for (int iteration = 0; iteration < 100; ++iteration) {
        const Extremes sums = prices.farthest(ratio);
        if (!(sums.largest > 0)) return infinity;
        const double next = sums.least / sums.largest;
        if (next <= ratio * (1 + 1e-15)) break;
        ratio = next;
    }
    return ratio * (1 + 1e-12);
}

double squared_over(const Extremes& sums) {
    return sums.largest > 0 ? sums.least * sums.least / sums.largest : infinity;
}

/// The largest least^2 / largest over all choices. That is convex, so it is largest at a corner of
/// the hull of all choices' sums, which lines cut off: between two corners all choices are in the
/// triangle with the point where their lines meet.
class LargestSquare {
  public:
    explicit LargestSquare(const ExtremePrices& prices) : prices_(prices) {}

    double find() {
        const Extremes right = prices_.farthest(0);
        const Extremes left = prices_.with_least_largest();
        keep(right);
        keep(left);
        // Between them no line but those that bound either sum.
        cut({right, 0}, left, {right.least, left.largest}, 0);
        return bound_ * (1 + 1e-11);
    }

  private:
    struct Corner {
        Extremes at;
        double slope = 0;  // of the line through it above which there is no choice
    };

    void keep(const Extremes& sums) { bound_ = std::max(bound_, squared_over(sums)); }

    /// The arc from `right` to a corner `left` of no lesser slope, below `tip`.
    void cut(const Corner& right, const Extremes& left, const Extremes& tip, int depth) {
        constexpr int deepest = 12;
        const double width = right.at.largest - left.largest;
        const bool is_narrow = !(width > 1e-12 * right.at.largest);
        if (is_narrow || depth == deepest || squared_over(tip) <= bound_ * (1 + 1e-6)) {
            return keep(tip);
        }
        const double slope = (right.at.least - left.least) / width;
        const Extremes corner = prices_.farthest(slope);
        keep(corner);
        const double height = corner.least - slope * corner.largest;
        if (height <= (left.least - slope * left.largest) + 1e-12 * right.at.least) return;
        // Where the new line meets that of `right`, and the one of `left` and `tip`.
        cut(right, corner, meet(right.at, right.slope, corner, slope), depth + 1);
        const double rise = tip.largest - left.largest;
        const Extremes met = rise > 0 ? meet(corner, slope, left, (tip.least - left.least) / rise)
                                      : Extremes{height + slope * left.largest, left.largest};
        cut({corner, slope}, left, met, depth + 1);
    }

    static Extremes meet(const Extremes& a, double slope_a, const Extremes& b, double slope_b) {
        const double difference = slope_b - slope_a;
        if (!(std::abs(difference) > 1e-300)) return b;
        const double x =
            (a.least - slope_a * a.largest - b.least + slope_b * b.largest) / difference;
        return {a.least + slope_a * (x - a.largest), x};
    }

    const ExtremePrices& prices_;
    double bound_ = 0;
};

/// O2 >= value is least - value^2 largest >= 0; in O4 the root of `largest` is not below its chord
/// over the range that is left.
void price_extremes(const Objective& objective, const ExtremePrices& prices, double value,
                    Pricing& pricing) {
    double slope = value * value;
    double offset = 0;
    if (objective.criterion == Criterion::O4) {
        const double low = prices.with_least_largest().largest;
        const double most = prices.farthest(0).least / value;
        const double high = std::max(low, std::min(prices.with_largest_largest().largest,
                                                   most * most * (1 + pricing.rounding)));
        slope = value / (std::sqrt(high) + std::sqrt(low));
        offset = value * std::sqrt(low) - slope * low;
    }
    pricing.prices = prices.least - slope * prices.largest;
    pricing.held = prices.held.least - slope * prices.held.largest;
    pricing.needed = offset - pricing.rounding * prices.farthest(0).least;
}

}  // namespace

double needed_information(const Objective& objective, double value, Index parameter_count,
                          double rounding) {
    return (1 - rounding) * information_of_value(objective, value, parameter_count);
}

double sum_of(const VectorXd& values, const std::vector<Taken>& taken) {
    double sum = 0;
    for (const auto& [candidate, count] : taken) {
        sum += static_cast<double>(count) * values[candidate];
    }
    return sum;
}

Pricing price(const Objective& objective, const MatrixXd& M, const OpenChoices& open,
              double value) {
    Pricing pricing;
    const double rounding = bound_rounding(objective.criterion, M);
    if (!(rounding < most_rounding) || !std::isfinite(evaluate(objective, M))) return pricing;
    pricing.rounding = std::max(rounding, least_rounding);
    if (!has_information_function(objective.criterion)) {
        const ExtremePrices prices(M, objective.sharpness, open);
        const double bound = objective.criterion == Criterion::O2
                                 ? std::min(1.0, std::sqrt(largest_ratio(prices)))
                                 : std::sqrt(LargestSquare(prices).find());
        pricing.bound = (1 + rounding) * bound;
        price_extremes(objective, prices, value, pricing);
        return pricing;
    }
    const MatrixXd Z = supporting_matrix(objective, M);
    pricing.prices = open.sensitivities(Z);
    pricing.held = Z.cwiseProduct(open.held).sum();
    const double phi = pricing.held + sum_of(pricing.prices, open.most_valuable(pricing.prices));
    pricing.bound = value_of_information(objective, (1 + rounding) * phi, M.rows());
    pricing.needed = needed_information(objective, value, M.rows(), pricing.rounding);
    return pricing;
}

}  // namespace posewise::detail
