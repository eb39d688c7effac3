#pragma once

#include <Eigen/QR>
#include <cmath>

#include "designs.hpp"

namespace posewise::test {

/// Blocks of standard normal entries times V diag(1 ... 1 / condition) V^T for a random rotation V:
/// no scaling of columns makes them better.
inline Blocks ill_conditioned_blocks(Index count, Index rows, Index parameters, double condition,
                                     std::uint64_t seed) {
    Blocks blocks = random_blocks(count, rows, parameters, seed);
    const MatrixXd normal = random_blocks(parameters, 1, parameters, seed + 1000).matrix;
    const MatrixXd V = Eigen::HouseholderQR<MatrixXd>(normal).householderQ();
    VectorXd sizes(parameters);
    for (Index k = 0; k < parameters; ++k) {
        sizes[k] = std::pow(condition, -static_cast<double>(k) /
                                           static_cast<double>(std::max<Index>(1, parameters - 1)));
    }
    blocks.matrix *= V * sizes.asDiagonal() * V.transpose();
    return blocks;
}

}  // namespace posewise::test
