#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// Which number is the p-quantile of n sorted ones where p falls between two of them.
enum class QuantileRule {
    Lower,   ///< number ceil(p n): the least that p of them do not exceed
    Upper,   ///< number floor(p n) + 1: differs from Lower only where p n is whole
    Linear,  ///< between numbers floor(p (n - 1)) + 1 and the next [Hyndman & Fan 1996, rule 7]
};

/// The p-quantile (p from 0 to 1) of at least one number, in any order; infinite ones are allowed.
double quantile(VectorXd values, double p, QuantileRule rule);

/// Calls the visitor with each of some numbers; the same ones, in any order, each time.
using VisitNumbers = std::function<void(const std::function<void(double)>& visitor)>;

/// quantile() by QuantileRule::Linear of so many numbers that they should not all be in memory but
/// at most `in_memory` of them at a time; no number must be a NaN. Nothing if there are none.
std::optional<double> quantile_of_many(const VisitNumbers& visit, double p,
                                       std::size_t in_memory = std::size_t{1} << 16);

/// The places of the values, that of the largest first; of equal ones in their order.
std::vector<Index> by_decreasing(const VectorXd& values);

/// RMS distance of points (n x 3) from their mean.
double rms_spread(const RowMatrixXd& points);

/// The p-quantile (0 < p < 1) of the standard normal distribution.
double normal_quantile(double p);

/// The p-quantile (0 < p < 1) of Student's t of so many degrees of freedom (above 0).
double student_quantile(double p, double degrees_of_freedom);

/// Probability that chance alone makes |t| larger.
double two_sided(double t, double degrees_of_freedom);

/// That of chi squared.
double chi_squared_quantile(double p, double degrees_of_freedom);

/// A number that is never negative: so much on average, distributed as chi squared.
struct ScaledChiSquared {
    double mean = 0;
    double degrees_of_freedom = 1;
};
/// What such a number is below with probability p (0 < p < 1) if it is any of these (at least one),
/// each as likely. Where their means rest on a variance of so many degrees of freedom (0: known)
/// they are scaled F.
double mixture_quantile(double p, const std::vector<ScaledChiSquared>& parts,
                        double degrees_of_freedom = 0);

}  // namespace posewise::detail
