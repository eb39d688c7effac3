#include "inverse_root.hpp"

#include <algorithm>
#include <boost/math/special_functions/ellint_1.hpp>
#include <boost/math/special_functions/jacobi_elliptic.hpp>
#include <cmath>
#include <numbers>

namespace posewise::detail {
namespace {

using InDouble = boost::math::policies::policy<boost::math::policies::promote_double<false>>;

}  // namespace

InverseRoot make_inverse_root(double least, double largest) {
    constexpr double least_part = 1e-14;  // below, rounding of the modulus decides
    least = std::max(least, least_part * largest);
    const double modulus = std::sqrt(1 - least / largest);
    const double period = boost::math::ellint_1(modulus, InDouble());
    // The error is exp(-2 pi^2 nodes / (log(largest / least) + 3)).
    const double nodes =
        std::ceil(25 * (std::log(largest / least) + 3) / (2 * std::numbers::pi * std::numbers::pi));
    InverseRoot root;
    for (double j = 0.5; j < nodes; ++j) {
        double cn = 0;
        double dn = 0;
        const double sn =
            boost::math::jacobi_elliptic(modulus, j * period / nodes, &cn, &dn, InDouble());
        root.shifts.push_back(least * sn * sn / (cn * cn));
        root.weights.push_back(2 * period * std::sqrt(least) * dn /
                               (std::numbers::pi * nodes * cn * cn));
    }
    return root;
}

}  // namespace posewise::detail
