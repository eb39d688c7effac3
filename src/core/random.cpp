#include "posewise/core/random.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "elementary.hpp"

namespace posewise {
namespace {

/// SplitMix64 finaliser [Steele, Lea, Flood 2014]: nearby seeds give unrelated streams.
std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t item)
    : engine_(mix(mix(seed) + item)) {}

double RandomStream::uniform(double lower, double upper) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1.0p-53;
    return lower + (upper - lower) * unit;
}

double RandomStream::normal() {
    const double u = 1.0 - uniform();  // in (0, 1], so that log(u) is finite
    const double v = uniform();
    return std::sqrt(-2.0 * detail::logarithm(u)) *
           detail::sine_and_cosine(2.0 * std::numbers::pi * v).cosine;
}

VectorXd RandomStream::normals(Index count) {
    VectorXd z(count);
    for (double& one : z) one = normal();
    return z;
}

Index RandomStream::index(Index count) {
    assert(count > 0);
    // Rejection keeps every index equally likely.
    const auto n = static_cast<std::uint64_t>(count);
    const std::uint64_t limit = UINT64_MAX - UINT64_MAX % n;
    std::uint64_t draw = engine_();
    while (draw >= limit) draw = engine_();
    return static_cast<Index>(draw % n);
}

std::vector<Index> RandomStream::subset(Index count, Index k) {
    assert(0 <= k && k <= count);
    std::vector<Index> all(static_cast<std::size_t>(count));
    std::iota(all.begin(), all.end(), Index{0});
    for (Index i = 0; i < k; ++i) {
        std::swap(all[static_cast<std::size_t>(i)],
                  all[static_cast<std::size_t>(i + index(count - i))]);
    }
    all.resize(static_cast<std::size_t>(k));
    std::sort(all.begin(), all.end());
    return all;
}

}  // namespace posewise
