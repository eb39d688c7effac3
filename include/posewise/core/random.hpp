#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

/// A seeded stream of random numbers that is the same on every platform and for any number of
/// threads: item i of a parallel loop draws from RandomStream(seed, i). The distributions are our
/// own because those of the standard library differ between vendors.
class RandomStream {
  public:
    explicit RandomStream(std::uint64_t seed, std::uint64_t item = 0);

    /// Those of items first, ..., first + 3, seeded side by side in a third of the time.
    static std::array<RandomStream, 4> of_four_items(std::uint64_t seed, std::uint64_t first);

    /// Uniform in [lower, upper).
    double uniform(double lower = 0, double upper = 1);
    /// As many as there is room for, in order, in [0, 1).
    void fill_uniform(std::span<double> numbers);

    /// Standard normal (Box-Muller).
    double normal();
    /// So many of them, in order.
    VectorXd normals(Index count);

    /// Uniform in {0, ..., count - 1}; count must be positive.
    Index index(Index count);

    /// k different indices out of {0, ..., count - 1}, sorted. Requires 0 <= k <= count.
    std::vector<Index> subset(Index count, Index k);

  private:
    /// The numbers of std::mt19937_64 [Nishimura 2000], each made when it is asked for, not 312 at
    /// once: streams of a few numbers, of which studies take one a configuration, cost as much
    /// less.
    class Engine {
      public:
        /// Seeds engines side by side: each number of a state waits for the last one.
        template <std::size_t count>
        static void seed(const std::array<Engine*, count>& engines,
                         const std::array<std::uint64_t, count>& seeds);

        std::uint64_t next();
        void fill_uniform(std::span<double> numbers);

      private:
        static constexpr std::size_t size = 312;

        /// Makes number i of the state anew, from the one after and the one half a state on.
        std::uint64_t renew(std::size_t i, std::size_t after, std::size_t half_on);

        std::array<std::uint64_t, size> state_;
        std::size_t next_ = 0;
    };

    RandomStream() = default;  // not seeded

    Engine engine_;
};

}  // namespace posewise
