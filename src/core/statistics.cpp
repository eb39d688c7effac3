#include "statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace posewise::detail {

double quantile(VectorXd values, double p, QuantileRule rule) {
    assert(values.size() > 0 && p >= 0 && p <= 1);
    const Index last = values.size() - 1;
    const auto count = static_cast<double>(values.size());
    const double position = rule == QuantileRule::Linear  ? p * static_cast<double>(last)
                            : rule == QuantileRule::Lower ? std::ceil(p * count) - 1
                                                          : std::floor(p * count);
    const auto index = std::clamp(static_cast<Index>(position), Index{0}, last);
    const auto nth = values.begin() + index;
    std::nth_element(values.begin(), nth, values.end());
    const double part = rule == QuantileRule::Linear ? position - static_cast<double>(index) : 0;
    if (!(part > 0)) return *nth;
    const double next = *std::min_element(nth + 1, values.end());
    return std::isinf(next) ? next : *nth + part * (next - *nth);
}

double rms_spread(const RowMatrixXd& points) {
    return std::sqrt((points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean());
}

double normal_quantile(double p) { return boost::math::quantile(boost::math::normal(), p); }

double student_quantile(double p, double degrees_of_freedom) {
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), p);
}

double chi_squared_quantile(double p, double degrees_of_freedom) {
    return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), p);
}

double mixture_quantile(double p, const std::vector<ScaledChiSquared>& parts,
                        double degrees_of_freedom) {
    assert(!parts.empty());
    const auto excess = [&](double x) {
        double sum = 0;
        for (const auto& [mean, freedom] : parts) {
            if (mean <= 0) {
                sum += 1;
            } else if (degrees_of_freedom > 0) {
                sum += cdf(boost::math::fisher_f(freedom, degrees_of_freedom), x / mean);
            } else {
                sum += cdf(boost::math::chi_squared(freedom), freedom * x / mean);
            }
        }
        return sum / static_cast<double>(parts.size()) - p;
    };
    if (excess(0) >= 0) return 0;
    double upper = 0;
    for (const ScaledChiSquared& part : parts) upper = std::max(upper, part.mean);
    while (excess(upper) < 0) upper *= 2;
    std::uintmax_t most_evaluations = 100;
    const boost::math::tools::eps_tolerance<double> digits(40);
    return boost::math::tools::toms748_solve(excess, 0.0, upper, digits, most_evaluations).second;
}

}  // namespace posewise::detail
