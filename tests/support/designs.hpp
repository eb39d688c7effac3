#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "posewise/core/blocks.hpp"
#include "posewise/core/random.hpp"

/// Candidate sets with known properties, for tests of criteria and selection.
namespace posewise::test {

/// Blocks of standard normal entries.
inline Blocks random_blocks(Index count, Index rows, Index parameters, std::uint64_t seed) {
    RandomStream random(seed);
    RowMatrixXd matrix(count * rows, parameters);
    for (double& entry : matrix.reshaped<Eigen::RowMajor>()) entry = random.normal();
    return make_equal_blocks(matrix, rows);
}

/// Poses of a planar arm with x and y measured; parameters are lengths, then joint offsets.
/// `angles` is poses x joints.
inline Blocks planar_arm_blocks(const VectorXd& lengths, const RowMatrixXd& angles) {
    const Index n = lengths.size();
    RowMatrixXd matrix = RowMatrixXd::Zero(2 * angles.rows(), 2 * n);
    for (Index i = 0; i < angles.rows(); ++i) {
        double absolute = 0;
        for (Index link = 0; link < n; ++link) {
            absolute += angles(i, link);
            const Eigen::Vector2d along(std::cos(absolute), std::sin(absolute));
            const Eigen::Vector2d across(-std::sin(absolute), std::cos(absolute));
            matrix.block<2, 1>(2 * i, link) = along;
            // Every joint up to this link turns it.
            matrix.block(2 * i, n, 2, link + 1).colwise() += lengths[link] * across;
        }
    }
    return make_equal_blocks(matrix, 2);
}

/// The optimal plan of the planar arm: q2 = ... = qn = 2 pi i / m.
inline RowMatrixXd optimal_planar_angles(Index joints, Index poses) {
    RowMatrixXd angles(poses, joints);
    for (Index i = 0; i < poses; ++i) {
        angles.row(i).setConstant(2 * std::numbers::pi * static_cast<double>(i) /
                                  static_cast<double>(poses));
    }
    angles.col(0).setLinSpaced(0.3, 1.7);  // the first joint does not matter
    return angles;
}

/// All K-subsets of {0, ..., count - 1}, in lexicographic order.
template <typename Visit>
void for_each_subset(Index count, Index k, const Visit& visit) {
    std::vector<Index> subset(static_cast<std::size_t>(k));
    for (Index i = 0; i < k; ++i) subset[static_cast<std::size_t>(i)] = i;
    while (true) {
        visit(subset);
        Index at = k - 1;
        while (at >= 0 && subset[static_cast<std::size_t>(at)] == count - k + at) --at;
        if (at < 0) return;
        ++subset[static_cast<std::size_t>(at)];
        for (Index i = at + 1; i < k; ++i) {
            subset[static_cast<std::size_t>(i)] = subset[static_cast<std::size_t>(i - 1)] + 1;
        }
    }
}

}  // namespace posewise::test
