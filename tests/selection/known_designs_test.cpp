#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "posewise/selection/choice.hpp"
#include "support/designs.hpp"

/// Optimal designs that are known in closed form or by proof.
namespace posewise {
namespace {

double best_determinant(const Blocks& candidates, Index pose_count, Index repeat_limit = 1) {
    SelectOptions options;
    options.pose_count = pose_count;
    options.repeat_limit = repeat_limit;
    return std::exp(select_poses(candidates, options).value);
}

TEST(KnownDesigns, PlanarArmOfTwoAndThreeLinks) {
    RowMatrixXd two = RowMatrixXd::Zero(24, 2);
    for (Index i = 0; i < 24; ++i) two(i, 1) = 2 * std::numbers::pi * static_cast<double>(i) / 24;
    EXPECT_NEAR(best_determinant(test::planar_arm_blocks(Eigen::Vector2d(1, 0.8), two), 2), 10.24,
                1e-10);
    RowMatrixXd three = RowMatrixXd::Zero(144, 3);
    for (Index i = 0; i < 144; ++i) {
        three(i, 1) = 2 * std::numbers::pi * static_cast<double>(i / 12) / 12;
        three(i, 2) = 2 * std::numbers::pi * static_cast<double>(i % 12) / 12;
    }
    const Blocks arm = test::planar_arm_blocks(Vector3d(1, 0.8, 0.5), three);
    EXPECT_NEAR(best_determinant(arm, 3), 116.64, 1e-9);
    EXPECT_NEAR(best_determinant(arm, 4), 655.36, 1e-8);
}

/// Rows of the quadratic model in two factors.
Blocks quadratic_rows(const std::vector<Eigen::Vector2d>& points) {
    RowMatrixXd rows(static_cast<Index>(points.size()), 6);
    for (Index i = 0; i < rows.rows(); ++i) {
        const Eigen::Vector2d& p = points[static_cast<std::size_t>(i)];
        rows.row(i) << 1, p.x(), p.y(), p.x() * p.x(), p.y() * p.y(), p.x() * p.y();
    }
    return make_equal_blocks(rows, 1);
}

/// A square grid around the point, clipped to [-1, 1]^2.
void add_grid(const Eigen::Vector2d& centre, double step, int reach,
              std::vector<Eigen::Vector2d>& points) {
    for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
            const Eigen::Vector2d moved = centre + step * Eigen::Vector2d(i, j);
            points.emplace_back(moved.cwiseMax(-1.0).cwiseMin(1.0));
        }
    }
}

/// The largest determinant of n points of the square, on ever finer grids around the last plan.
double best_determinant_of_square(Index n) {
    std::vector<Eigen::Vector2d> points;
    add_grid(Eigen::Vector2d::Zero(), 0.1, 10, points);
    SelectOptions options;
    options.pose_count = n;
    options.repeat_limit = n;
    options.proof = 0;
    double best = 0;
    for (double step = 0.05; step > 1e-7; step /= 2) {
        const Choice plan = select_poses(quadratic_rows(points), options);
        best = std::exp(plan.value);
        std::vector<Eigen::Vector2d> finer;
        for (const Index i : plan.poses) {
            add_grid(points[static_cast<std::size_t>(i)], step, 2, finer);
        }
        points = std::move(finer);
        options.starts = 2;
    }
    return best;
}

TEST(KnownDesigns, QuadraticInTwoFactors) {
    // [Box, Draper 1971]; n = 9 is the 3 x 3 grid.
    for (const auto& [n, optimum] : {std::pair{6, 267.737219}, std::pair{7, 980.77022},
                                     std::pair{8, 2361.72939}, std::pair{9, 5184.0}}) {
        EXPECT_NEAR(best_determinant_of_square(n), optimum, 5e-9 * optimum) << n;
    }
}

TEST(KnownDesigns, LargestDeterminantsOfSignMatrices) {
    const std::array<double, 10> largest = {4,    16,    48,    160,    576,
                                            4096, 14336, 73728, 327680, 2985984};
    for (Index n = 3; n <= 12; ++n) {
        const double expected = largest[static_cast<std::size_t>(n - 3)];
        EXPECT_NEAR(std::sqrt(best_determinant(test::sign_rows(n), n, n)), expected,
                    1e-6 * expected)
            << n;
    }
}

TEST(KnownDesigns, GraphsWithTheMostSpanningTrees) {
    EXPECT_NEAR(best_determinant(test::complete_graph(6), 9), 81, 1e-6);      // K33
    EXPECT_NEAR(best_determinant(test::complete_graph(8), 16), 4096, 1e-6);   // K44
    EXPECT_NEAR(best_determinant(test::complete_graph(10), 15), 2000, 1e-6);  // Petersen
}

}  // namespace
}  // namespace posewise
