#include "statistics.hpp"

#include <algorithm>
#include <bit>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>

namespace posewise::detail {

namespace {

/// In double as it is: long double tells the same 15 digits in ten times as long.
using ChiSquared = boost::math::chi_squared_distribution<
    double, boost::math::policies::policy<boost::math::policies::promote_double<false>>>;

double between(double number, double next, double part) {
    return std::isinf(next) ? next : number + part * (next - number);
}

/// In the order of the numbers.
std::uint64_t key_of(double x) {
    constexpr std::uint64_t sign = std::uint64_t{1} << 63;
    const auto bits = std::bit_cast<std::uint64_t>(x + 0.0);  // -0 is 0
    return (bits & sign) != 0 ? ~bits : bits | sign;
}

/// Keys that are alike but for their last bits.
struct KeyRange {
    static constexpr int part_bits = 16;
    static constexpr std::size_t parts = std::size_t{1} << part_bits;

    std::uint64_t first = 0;
    int open_bits = 64;

    bool has(std::uint64_t key) const {
        return open_bits == 64 || (key >> open_bits) == (first >> open_bits);
    }
    std::size_t part_of(std::uint64_t key) const {
        return (key >> (open_bits - part_bits)) % parts;
    }
    void narrow(std::size_t part) {
        open_bits -= part_bits;
        first |= static_cast<std::uint64_t>(part) << open_bits;
    }
};

}  // namespace

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
    return between(*nth, *std::min_element(nth + 1, values.end()), part);
}

std::optional<double> quantile_of_many(const VisitNumbers& visit, double p, std::size_t in_memory) {
    std::vector<double> values;
    std::size_t count = 0;
    visit([&](double x) {
        if (++count <= in_memory) values.push_back(x);
    });
    if (count == 0) return std::nullopt;
    if (count <= in_memory) {
        return quantile(Eigen::Map<const VectorXd>(values.data(), std::ssize(values)), p,
                        QuantileRule::Linear);
    }
    const double position = p * static_cast<double>(count - 1);
    // From the first digits of the key on, those numbers that share theirs with the one looked for.
    KeyRange range;
    auto rank = static_cast<std::size_t>(position);
    for (std::size_t left = count; left > in_memory && range.open_bits > 0;) {
        std::vector<std::size_t> counts(KeyRange::parts);
        visit([&](double x) {
            if (range.has(key_of(x))) ++counts[range.part_of(key_of(x))];
        });
        std::size_t part = 0;
        for (; counts[part] <= rank; ++part) rank -= counts[part];
        left = counts[part];
        range.narrow(part);
    }
    values.clear();
    std::size_t same = 0;  // in a range of a single number
    double above = std::numeric_limits<double>::infinity();
    visit([&](double x) {
        if (!range.has(key_of(x))) {
            if (key_of(x) > range.first) above = std::min(above, x);
        } else if (range.open_bits > 0 || values.empty()) {
            values.push_back(x);
        } else {
            ++same;
        }
    });
    std::sort(values.begin(), values.end());
    const auto at = [&](std::size_t k) {
        if (k < values.size()) return values[k];
        return k < values.size() + same ? values.back() : above;
    };
    const double part = position - std::floor(position);
    return part > 0 ? between(at(rank), at(rank + 1), part) : at(rank);
}

double rms_spread(const RowMatrixXd& points) {
    return std::sqrt((points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean());
}

std::vector<Index> by_decreasing(const VectorXd& values) {
    std::vector<Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return values[a] > values[b]; });
    return order;
}

double normal_quantile(double p) { return boost::math::quantile(boost::math::normal(), p); }

double student_quantile(double p, double degrees_of_freedom) {
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom), p);
}

double two_sided(double t, double degrees_of_freedom) {
    const boost::math::students_t distribution(degrees_of_freedom);
    return 2 * boost::math::cdf(boost::math::complement(distribution, std::abs(t)));
}

double chi_squared_quantile(double p, double degrees_of_freedom) {
    return boost::math::quantile(ChiSquared(degrees_of_freedom), p);
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
                sum += cdf(ChiSquared(freedom), freedom * x / mean);
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
