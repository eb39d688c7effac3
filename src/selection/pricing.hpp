#pragma once

#include <functional>

#include "criteria/objective.hpp"
#include "limits.hpp"

namespace posewise::detail {

/// Choices that are still open: some candidates, of which more are to be taken, beside `held`.
struct OpenChoices {
    const MatrixXd& held;
    /// trace(B_i Z B_i^T) of each candidate.
    std::function<VectorXd(const MatrixXd& Z)> sensitivities;
    /// What the choice with the largest sum of values takes; of a choice beyond all limits, too,
    /// the sum is an upper bound.
    std::function<std::vector<Taken>(const VectorXd& values)> most_valuable;
};

/// What a matrix M, by its supporting hyperplane, proves of all choices that are open.
struct Pricing {
    double bound = std::numeric_limits<double>::infinity();  ///< no choice has a larger value
    /// Of the candidates: only a choice with held + sum of prices >= needed may be as good as the
    /// value that was asked for.
    VectorXd prices;
    double held = 0;
    double needed = -std::numeric_limits<double>::infinity();
    double rounding = 0;  ///< relative, that bound and needed allow for
};

/// With phi the information function of the criterion and Z = supporting_matrix(M),
///     phi(M*) <= trace(Z M*) = trace(Z H) + sum of trace(B_i Z B_i^T).
/// For D this is Kiefer's log det M + L log(S / L), for A T^2 / S. O2 and O4 are bounded by the
/// largest a / b and a / sqrt(b) over all (a, b) = (trace(Z M*), trace(Y M*)) with Z and Y those of
/// M's (softened) extreme eigenvalues. Bound and needed allow for bound_rounding(); the bound is
/// infinite, and there are no prices, if M is not positive definite beyond that.
Pricing price(const Objective& objective, const MatrixXd& M, const OpenChoices& open, double value);

/// What the information function must reach for a choice to be as good as `value`, less its
/// relative rounding.
double needed_information(const Objective& objective, double value, Index parameter_count,
                          double rounding);

double sum_of(const VectorXd& values, const std::vector<Taken>& taken);

}  // namespace posewise::detail
