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

std::uint64_t seed_of(std::uint64_t seed, std::uint64_t item) { return mix(mix(seed) + item); }

double unit(std::uint64_t number) {
    return static_cast<double>(static_cast<std::int64_t>(number >> 11)) * 0x1.0p-53;
}

}  // namespace

template <std::size_t count>
void RandomStream::Engine::seed(const std::array<Engine*, count>& engines,
                                const std::array<std::uint64_t, count>& seeds) {
    std::array<std::uint64_t, count> last = seeds;
    for (std::size_t k = 0; k < count; ++k) engines[k]->state_[0] = last[k];
    for (std::size_t i = 1; i < size; ++i) {
        for (std::size_t k = 0; k < count; ++k) {
            last[k] = 6364136223846793005ULL * (last[k] ^ (last[k] >> 62)) + i;
            engines[k]->state_[i] = last[k];
        }
    }
}

std::uint64_t RandomStream::Engine::renew(std::size_t i, std::size_t after, std::size_t half_on) {
    constexpr std::uint64_t lower_bits = (1ULL << 31) - 1;
    const std::uint64_t y = (state_[i] & ~lower_bits) | (state_[after] & lower_bits);
    const std::uint64_t twisted = (y >> 1) ^ (-(y & 1) & 0xb5026f5aa96619e9ULL);
    std::uint64_t z = state_[half_on] ^ twisted;
    state_[i] = z;
    z ^= (z >> 29) & 0x5555555555555555ULL;
    z ^= (z << 17) & 0x71d67fffeda60000ULL;
    z ^= (z << 37) & 0xfff7eee000000000ULL;
    return z ^ (z >> 43);
}

std::uint64_t RandomStream::Engine::next() {
    constexpr std::size_t half = size / 2;
    const std::size_t after = next_ + 1 < size ? next_ + 1 : 0;
    const std::uint64_t number = renew(next_, after, next_ < half ? next_ + half : next_ - half);
    next_ = after;
    return number;
}

void RandomStream::Engine::fill_uniform(std::span<double> numbers) {
    constexpr std::size_t half = size / 2;
    while (!numbers.empty()) {
        if (next_ + 1 == size) {
            numbers.front() = unit(next());
            numbers = numbers.subspan(1);
            continue;
        }
        // As far as neither the number after nor the one half a state on begins anew.
        const bool is_first_half = next_ < half;
        const std::size_t end = is_first_half ? half : size - 1;
        const std::size_t count = std::min(numbers.size(), end - next_);
        const std::size_t half_on = is_first_half ? next_ + half : next_ - half;
        for (std::size_t k = 0; k < count; ++k) {
            numbers[k] = unit(renew(next_ + k, next_ + k + 1, half_on + k));
        }
        next_ += count;
        numbers = numbers.subspan(count);
    }
}

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t item) {
    Engine::seed<1>({&engine_}, {seed_of(seed, item)});
}

std::array<RandomStream, 4> RandomStream::of_four_items(std::uint64_t seed, std::uint64_t first) {
    std::array<RandomStream, 4> streams{RandomStream(), RandomStream(), RandomStream(),
                                        RandomStream()};
    Engine::seed<4>(
        {&streams[0].engine_, &streams[1].engine_, &streams[2].engine_, &streams[3].engine_},
        {seed_of(seed, first), seed_of(seed, first + 1), seed_of(seed, first + 2),
         seed_of(seed, first + 3)});
    return streams;
}

double RandomStream::uniform(double lower, double upper) {
    return lower + (upper - lower) * unit(engine_.next());
}

void RandomStream::fill_uniform(std::span<double> numbers) { engine_.fill_uniform(numbers); }

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
    std::uint64_t draw = engine_.next();
    while (draw >= limit) draw = engine_.next();
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
