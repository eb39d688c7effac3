#pragma once

#include <cstdint>
#include <random>
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
    std::mt19937_64 engine_;
};

}  // namespace posewise
