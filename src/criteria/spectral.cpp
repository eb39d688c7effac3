#include "spectral.hpp"

#include <cmath>

#include "core/elementary.hpp"

namespace posewise::detail {

Eigen::ArrayXd powers(const Eigen::ArrayXd& x, double exponent) {
    return x.unaryExpr([exponent](double one) { return power(one, exponent); });
}

Sloped soft_least(const VectorXd& x, double p) {
    Sloped result{0, VectorXd::Zero(x.size())};
    Index at = 0;
    const double least = x.minCoeff(&at);
    if (std::isinf(p)) {
        result.slope[at] = 1;
        result.value = least;
        return result;
    }
    const Eigen::ArrayXd ratio = least / x.array();  // in (0, 1]
    const double sum = powers(ratio, p).sum();
    result.value = least * power(sum, -1 / p);
    result.slope = power(sum, -(1 + 1 / p)) * powers(ratio, p + 1);
    return result;
}

Sloped soft_largest(const VectorXd& x, double p) {
    Sloped result{0, VectorXd::Zero(x.size())};
    Index at = 0;
    const double largest = x.maxCoeff(&at);
    if (std::isinf(p)) {
        result.slope[at] = 1;
        result.value = largest;
        return result;
    }
    const Eigen::ArrayXd ratio = x.array() / largest;
    const double sum = powers(ratio, p).sum();
    result.value = largest * power(sum, 1 / p);
    result.slope = power(sum, 1 / p - 1) * powers(ratio, p - 1);
    return result;
}

double value_of_log_determinant(const Objective& objective, double log_determinant, Index L) {
    if (objective.criterion == Criterion::D) return log_determinant;
    return exponential(log_determinant / (2.0 * static_cast<double>(L))) /
           std::sqrt(static_cast<double>(objective.pose_count));
}

namespace {

/// D, O1, A and O5.
Sloped smooth_criterion(const Objective& objective, const VectorXd& eigenvalues) {
    const Eigen::ArrayXd inverse = eigenvalues.array().inverse();
    const Index L = eigenvalues.size();
    if (objective.criterion == Criterion::A) {
        const double value = 1 / inverse.sum();
        return {value, value * value * inverse.square()};
    }
    if (objective.criterion == Criterion::O5) {
        const double value = 1 / eigenvalues.array().rsqrt().sum();
        return {value, 0.5 * value * value * eigenvalues.array().rsqrt().cube()};
    }
    const double value =
        value_of_log_determinant(objective, eigenvalues.unaryExpr(&logarithm).sum(), L);
    if (objective.criterion == Criterion::D) return {value, inverse};
    return {value, value / (2.0 * static_cast<double>(L)) * inverse};
}

}  // namespace

Sloped spectral_criterion(const Objective& objective, const VectorXd& eigenvalues) {
    if (is_smooth(objective.criterion)) return smooth_criterion(objective, eigenvalues);
    const double p = objective.sharpness;
    const Sloped least = soft_least(eigenvalues, p);
    if (objective.criterion == Criterion::E) return least;
    if (objective.criterion == Criterion::O3) {
        const double value = std::sqrt(least.value);
        return {value, least.slope / (2 * value)};
    }
    const Sloped largest = soft_largest(eigenvalues, p);
    const double condition = least.value / largest.value;
    if (objective.criterion == Criterion::O2) {
        const double value = std::sqrt(condition);
        return {value, 0.5 * value * (least.slope / least.value - largest.slope / largest.value)};
    }
    const double value = std::sqrt(least.value * condition);  // O4
    return {value, value * (least.slope / least.value - 0.5 * largest.slope / largest.value)};
}

}  // namespace posewise::detail
