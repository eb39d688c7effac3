#include "posewise/core/random.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "elementary.hpp"
#include "normals.hpp"

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

RandomStream::Engine::Engine(std::uint64_t seed) {
    state_[0] = seed;
    for (std::size_t i = 1; i < state_.size(); ++i) {
        const std::uint64_t last = state_[i - 1];
        state_[i] = 6364136223846793005ULL * (last ^ (last >> 62)) + i;
    }
}

std::uint64_t RandomStream::Engine::operator()() {
    constexpr std::uint64_t lower_bits = (1ULL << 31) - 1;
    constexpr std::size_t middle = 156;
    const std::size_t size = state_.size();
    const std::size_t after = next_ + 1 < size ? next_ + 1 : 0;
    const std::uint64_t y = (state_[next_] & ~lower_bits) | (state_[after] & lower_bits);
    const std::uint64_t twisted = (y >> 1) ^ ((y & 1) != 0 ? 0xb5026f5aa96619e9ULL : 0);
    std::uint64_t z = state_[next_ < middle ? next_ + middle : next_ - middle] ^ twisted;
    state_[next_] = z;
    next_ = after;
    z ^= (z >> 29) & 0x5555555555555555ULL;
    z ^= (z << 17) & 0x71d67fffeda60000ULL;
    z ^= (z << 37) & 0xfff7eee000000000ULL;
    return z ^ (z >> 43);
}

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
    detail::fill_normals(*this, z);
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
