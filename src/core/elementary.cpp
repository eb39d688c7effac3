#include "elementary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "elementary_vectors.hpp"

namespace posewise::detail {
namespace {

// Approximations and constants of fdlibm [Sun Microsystems 1993], "freely distributable"; those of
// sine, cosine and logarithm in elementary_vectors.hpp.

double arc_tangent_near_zero(double x) {
    constexpr double a[11] = {
        3.33333333333329318027e-01,  -1.99999999998764832476e-01, 1.42857142725034663711e-01,
        -1.11111104054623557880e-01, 9.09088713343650656196e-02,  -7.69187620504482999495e-02,
        6.66107313738753120669e-02,  -5.83357013379057348645e-02, 4.97687799461593236017e-02,
        -3.65315727442169155270e-02, 1.62858201153657823623e-02};
    const double z = x * x;
    double p = a[10];
    for (int k = 9; k >= 0; --k) p = a[k] + z * p;
    return x * z * p;  // what it is less than x
}

/// Of x from 0 to 1.
double arc_tangent_to_one(double x) {
    if (x < 0.4375) return x - arc_tangent_near_zero(x);
    // atan(x) = atan(c) + atan((x - c) / (1 + c x)), c = 1/2 or 1.
    const bool is_below = x < 0.6875;
    const double high = is_below ? 4.63647609000806093515e-01 : 7.85398163397448278999e-01;
    const double low = is_below ? 2.26987774529616870924e-17 : 3.06161699786838301793e-17;
    const double rest = is_below ? (2 * x - 1) / (2 + x) : (x - 1) / (x + 1);
    return high - ((arc_tangent_near_zero(rest) - low) - rest);
}

}  // namespace

SineCosine sine_and_cosine(double x) {
    if (!(std::abs(x) < most_turned)) return {std::sin(x), std::cos(x)};
    const double n = (x * (2 * std::numbers::inv_pi) + to_integer) - to_integer;
    Reduced<double> r{x, 0};
    if (n != 0) less_right_angles(x, n, r);
    double s = 0;
    double c = 0;
    sine_near_zero(r, s);
    cosine_near_zero(r, c);
    switch (static_cast<long>(n) & 3) {
        case 0:
            return {s, c};
        case 1:
            return {c, -s};
        case 2:
            return {-s, -c};
        default:
            return {-c, s};
    }
}

double logarithm(double x) {
    if (!(x > 0) || std::isinf(x)) return std::log(x);
    int k = 0;
    double m = std::frexp(x, &k);  // in [1/2, 1)
    if (m < std::numbers::sqrt2 / 2) {
        m *= 2;
        --k;
    }
    double result = 0;
    logarithm_of_parts<double>(m, k, result);
    return result;
}

double exponential(double x) {
    if (!(std::abs(x) < 708)) return std::exp(x);
    const double k = (x * std::numbers::log2e + to_integer) - to_integer;
    const double high = x - k * 6.93147180369123816490e-01;
    const double low = k * 1.90821492927058770002e-10;
    const double r = high - low;
    const double t = r * r;
    const double c =
        r - t * (1.66666666666666019037e-01 +
                 t * (-2.77777777770155933842e-03 +
                      t * (6.61375632143793436117e-05 +
                           t * (-1.65339022054652515390e-06 + t * 4.13813679705723846039e-08))));
    return std::ldexp(1 - ((low - r * c / (2 - c)) - high), static_cast<int>(k));
}

double power(double x, double y) {
    if (y == 0) return 1;
    if (x == 0) return y > 0 ? 0 : std::numeric_limits<double>::infinity();
    return exponential(y * logarithm(x));
}

double arc_tangent(double y, double x) {
    const double rise = std::abs(y);
    const double run = std::abs(x);
    // Where both are 0 (signs of zeros count) or one is no number or infinite.
    if (!(std::max(rise, run) > 0) || !std::isfinite(rise) || !std::isfinite(run)) {
        return std::atan2(y, x);
    }
    constexpr double right = std::numbers::pi / 2;
    constexpr double right_rest = 6.12323399573676603587e-17;
    double angle = rise <= run ? arc_tangent_to_one(rise / run)
                               : right - (arc_tangent_to_one(run / rise) - right_rest);
    if (std::signbit(x)) angle = 2 * right - (angle - 2 * right_rest);
    return std::copysign(angle, y);
}

}  // namespace posewise::detail
