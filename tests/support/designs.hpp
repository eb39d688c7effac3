#pragma once

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "posewise/core/blocks.hpp"
#include "posewise/core/random.hpp"

/// Candidate sets with known properties, for tests of criteria and selection.
namespace posewise::test {

/// 0, 1, ... count - 1.
inline std::vector<Index> indices_below(Index count) {
    std::vector<Index> indices(static_cast<std::size_t>(count));
    std::iota(indices.begin(), indices.end(), Index{0});
    return indices;
}

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

/// All rows of n signs, the first +1: the sign of a whole row does not matter.
inline Blocks sign_rows(Index n) {
    RowMatrixXd rows = RowMatrixXd::Ones(Index{1} << (n - 1), n);
    for (Index i = 0; i < rows.rows(); ++i) {
        for (Index bit = 0; bit < n - 1; ++bit) {
            if ((i >> bit & 1) != 0) rows(i, bit + 1) = -1;
        }
    }
    return make_equal_blocks(rows, 1);
}

/// All edges of the complete graph; det M of a choice counts its spanning trees.
inline Blocks complete_graph(Index vertices) {
    RowMatrixXd incidence(vertices * (vertices - 1) / 2, vertices);
    incidence.setZero();
    Index edge = 0;
    for (Index a = 0; a < vertices; ++a) {
        for (Index b = a + 1; b < vertices; ++b, ++edge) {
            incidence(edge, a) = 1;
            incidence(edge, b) = -1;
        }
    }
    return make_equal_blocks(incidence.leftCols(vertices - 1), 1);
}

/// All choices of K out of `count` candidates that repeats, exclusions, groups and distances allow,
/// by brute force and written independently of the library.
template <typename Options, typename Visit>
void for_each_choice(Index count, const Options& options, const Visit& visit) {
    std::vector<Index> poses;
    const auto is_allowed = [&](Index candidate) {
        for (const Index excluded : options.excluded) {
            if (excluded == candidate) return false;
        }
        Index copies = 0;
        Index in_group = 0;
        for (const Index pose : poses) {
            copies += pose == candidate;
            if (!options.groups.empty()) {
                in_group += options.groups[static_cast<std::size_t>(pose)] ==
                            options.groups[static_cast<std::size_t>(candidate)];
            }
            const bool is_near =
                options.least_distance > 0 && pose != candidate &&
                (options.positions.row(pose) - options.positions.row(candidate)).norm() <
                    options.least_distance;
            if (is_near) return false;
        }
        return copies < options.repeat_limit &&
               (options.group_limit == 0 || in_group < options.group_limit);
    };
    const auto complete = [&](const auto& self, Index from) -> void {
        if (static_cast<Index>(poses.size()) == options.pose_count) return visit(poses);
        for (Index candidate = from; candidate < count; ++candidate) {
            if (!is_allowed(candidate)) continue;
            poses.push_back(candidate);
            self(self, candidate);
            poses.pop_back();
        }
    };
    complete(complete, 0);
}

}  // namespace posewise::test
