#pragma once

#include <cstdint>
#include <numbers>

#include "simd.hpp"

/// Elementary functions of one number or of a vector of them, with the same digits. What may be a
/// vector is neither taken nor returned by value: how that is done depends on the instruction set.
namespace posewise::detail {

// Approximations and constants of fdlibm [Sun Microsystems 1993], "freely distributable".

constexpr double to_integer = 0x1.8p52;  ///< added and subtracted it rounds to the nearest one
/// Beyond, n times the first part of pi/2 is no longer exact; no joint turns so far.
constexpr double most_turned = 1e6;

/// x + rest, at most pi/4 in magnitude, rest far below x.
template <typename T>
struct Reduced {
    T x, rest;
};

template <typename T>
POSEWISE_INLINE void sine_near_zero(const Reduced<T>& r, T& sine) {
    const T z = r.x * r.x;
    const T v = z * r.x;
    const T p = 8.33333333332248946124e-03 +
                z * (-1.98412698298579493134e-04 +
                     z * (2.75573137070700676789e-06 +
                          z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    sine = r.x - ((z * (0.5 * r.rest - v * p) - r.rest) - v * -1.66666666666666324348e-01);
}

template <typename T>
POSEWISE_INLINE void cosine_near_zero(const Reduced<T>& r, T& cosine) {
    const T z = r.x * r.x;
    const T p =
        z * (4.16666666666666019037e-02 +
             z * (-1.38888888888741095749e-03 +
                  z * (2.48015872894767294178e-05 +
                       z * (-2.75573143513906633035e-07 +
                            z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    const T half = 0.5 * z;
    const T w = 1 - half;
    cosine = w + (((1 - w) - half) + (z * p - r.x * r.rest));
}

/// x less n pi/2, pi/2 being the sum of three parts, so that no digit of it cancels.
template <typename T>
POSEWISE_INLINE void less_right_angles(const T& x, const T& n, Reduced<T>& reduced) {
    constexpr double part1 = 1.57079632673412561417e+00;
    constexpr double part2 = 6.07710050630396597660e-11;
    constexpr double rest2 = 2.02226624879595063154e-21;
    const T first = x - n * part1;
    const T second = n * part2;
    const T difference = first - second;
    const T rest = n * rest2 - ((first - difference) - second);
    reduced.x = difference - rest;
    reduced.rest = (difference - reduced.x) - rest;
}

/// Of a vector of doubles, all below most_turned in magnitude.
template <typename V>
POSEWISE_INLINE void sines_and_cosines(const V& x, V& sine, V& cosine) {
    using Bits [[gnu::vector_size(sizeof(V))]] = std::int64_t;
    const V shifted = x * (2 * std::numbers::inv_pi) + to_integer;
    const V n = shifted - to_integer;
    Reduced<V> r;
    less_right_angles(x, n, r);
    V s;
    V c;
    sine_near_zero(r, s);
    cosine_near_zero(r, c);
    // The integer's last bits are the last ones of what it was rounded in.
    const Bits quarter = reinterpret_cast<Bits>(shifted);
    const Bits is_odd = (quarter & 1) != 0;
    const V a = is_odd ? c : s;
    const V b = is_odd ? s : c;
    sine = (quarter & 2) != 0 ? -a : a;
    cosine = ((quarter + 1) & 2) != 0 ? -b : b;
}

/// log(m 2^k), m from sqrt(1/2) to sqrt(2).
template <typename T>
POSEWISE_INLINE void logarithm_of_parts(const T& m, const T& k, T& result) {
    const T f = m - 1;
    const T s = f / (2 + f);
    const T z = s * s;
    const T w = z * z;
    const T even = w * (3.999999999940941908e-01 +
                        w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
    const T odd = z * (6.666666666666735130e-01 +
                       w * (2.857142874366239149e-01 +
                            w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
    const T half = 0.5 * f * f;
    const T high = k * 6.93147180369123816490e-01;
    const T low = k * 1.90821492927058770002e-10;
    result = high - ((half - (s * (half + even + odd) + low)) - f);
}

/// Of a vector of doubles, all positive and normal.
template <typename V>
POSEWISE_INLINE void logarithms(const V& x, V& result) {
    using Bits [[gnu::vector_size(sizeof(V))]] = std::int64_t;
    constexpr std::int64_t mantissa = (std::int64_t{1} << 52) - 1;
    constexpr std::int64_t exponent_of_half = std::int64_t{1022} << 52;
    const Bits bits = reinterpret_cast<Bits>(x);
    const V m = reinterpret_cast<V>((bits & mantissa) | exponent_of_half);
    // An integer in the last bits of to_integer.
    const V zero = V{} + to_integer;
    const Bits shifted = reinterpret_cast<Bits>(zero) + ((bits >> 52) - 1022);
    const V k = reinterpret_cast<V>(shifted) - to_integer;
    const Bits is_below = m < std::numbers::sqrt2 / 2;
    logarithm_of_parts<V>(is_below ? m * 2 : m, is_below ? k - 1 : k, result);
}

}  // namespace posewise::detail
