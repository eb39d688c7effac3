#include "robust.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../core/statistics.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {

Loss complete_loss(const Loss& loss, const Campaign& campaign) {
    if (!std::isfinite(loss.width) || loss.width < 0) {
        throw InputError(
            fmt::format("width of the loss is {:g}, must be finite and not negative", loss.width));
    }
    Loss complete = loss;
    if (loss.width == 0 && loss.kind != LossKind::Squares) {
        complete.width = default_width(loss.kind, campaign.sensor->rows_per_target());
    }
    return complete;
}

double robust_deviation(const IdentificationProblem& problem, const Parameters& parameters) {
    constexpr double least = 1e-6;
    const Index equations = problem.equation_count();
    const Index freedom = equations - problem.scale.size();
    if (freedom <= 0) return 1;
    const double middle = quantile(residual_lengths(problem, parameters), 0.5, QuantileRule::Upper);
    const double median = middle / median_length(problem.campaign.sensor->rows_per_target());
    const double share = static_cast<double>(equations) / static_cast<double>(freedom);
    return std::max(median * std::sqrt(share), least);
}

double robust_covariance_factor(const IdentificationProblem& problem, const Estimate& estimate) {
    if (estimate.degrees_of_freedom <= 0) return 1;
    const VectorXd lengths = residual_lengths(problem, estimate.parameters);
    const auto p = static_cast<double>(problem.campaign.sensor->rows_per_target());
    double weights = 0;
    double rates = 0;
    double squares = 0;
    for (const double length : lengths) {
        const double u = length / problem.deviation;
        const double weight = problem.loss.weight(u);
        weights += weight;
        rates += (problem.loss.influence_rate(u) + (p - 1) * weight) / p;
        squares += weight * weight * length * length;
    }
    const auto count = static_cast<double>(lengths.size());
    return squares / static_cast<double>(estimate.degrees_of_freedom) * (weights / count) /
           ((rates / count) * (rates / count));
}

std::vector<Outlier> find_outliers(const IdentificationProblem& problem,
                                   const Parameters& parameters) {
    const Measurements& means = problem.means;
    const VectorXd lengths = residual_lengths(problem, parameters);
    const RowMatrixXd distances = residuals(problem.campaign, parameters, means);
    const double farthest = outlier_length(problem.campaign.sensor->rows_per_target());
    std::vector<Outlier> outliers;
    Index row = 0;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        for (Index j = 0; j < means.is_seen.cols(); ++j) {
            if (!means.is_seen(i, j)) continue;
            const double u = lengths[row] / problem.deviation;
            if (u > farthest) {
                outliers.push_back({i, means.ids[static_cast<std::size_t>(i)], j,
                                    distances.row(row).norm(), u, problem.loss.weight(u)});
            }
            ++row;
        }
    }
    return outliers;
}

}  // namespace posewise::detail
