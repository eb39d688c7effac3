#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

/// A seeded stream of random numbers, identical on every platform and for any number of threads:
/// item i of a parallel loop draws from RandomStream(seed, i). The distributions are our own
/// because those of the standard library differ between vendors.
class RandomStream {
  public:
    explicit RandomStream(std::uint64_t seed, std::uint64_t item = 0);

    /// Streams of the items first, ..., first + 3, seeded together in a third of the time.
    static std::array<RandomStream, 4> of_four_items(std::uint64_t seed, std::uint64_t first);

    /// Uniform in [lower, upper).
    double uniform(double lower = 0, double upper = 1);
    /// Fills `numbers` in order, uniform in [0, 1).
    void fill_uniform(std::span<double> numbers);

    /// Standard normal (Box-Muller).
    double normal();
    /// `count` standard normal numbers, in order.
    VectorXd normals(Index count);

    /// Uniform in {0, ..., count - 1}; count must be positive.
    Index index(Index count);

    /// k different indices out of {0, ..., count - 1}, sorted. Requires 0 <= k <= count.
    std::vector<Index> subset(Index count, Index k);

  private:
    /// The numbers of std::mt19937_64 [Nishimura 2000], generated one at a time instead of 312 at
    /// once. That makes short streams cheap; studies use one per configuration.
    class Engine {
      public:
        /// Seeds engines side by side, because each number of a state depends on the previous one.
        template <std::size_t count>
        static void seed(const std::array<Engine*, count>& engines,
                         const std::array<std::uint64_t, count>& seeds);

        std::uint64_t next();
        void fill_uniform(std::span<double> numbers);

      private:
        static constexpr std::size_t size = 312;

        /// Renews number i of the state from the next number and the one half a state further on.
        std::uint64_t renew(std::size_t i, std::size_t after, std::size_t half_on);

        std::array<std::uint64_t, size> state_;
        std::size_t next_ = 0;
    };

    RandomStream() = default;  // not seeded

    Engine engine_;
};

}  // namespace posewise
