#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

/// A seeded stream of random numbers that is the same on every platform and for any number of
/// threads: item i of a parallel loop draws from RandomStream(seed, i). The distributions are our
/// own because those of the standard library differ between vendors.
class RandomStream {
  public:
    explicit RandomStream(std::uint64_t seed, std::uint64_t item = 0);

    /// Uniform in [lower, upper).
    double uniform(double lower = 0, double upper = 1);

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
        explicit Engine(std::uint64_t seed);
        std::uint64_t operator()();

      private:
        std::array<std::uint64_t, 312> state_;
        std::size_t next_ = 0;
    };

    Engine engine_;
};

}  // namespace posewise
