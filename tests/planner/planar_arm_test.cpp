#include <gtest/gtest.h>

#include <numbers>

#include "../../src/planner/refinement.hpp"
#include "posewise/core/random.hpp"
#include "support/designs.hpp"

/// The planar n-link arm with x and y measured (parameters: lengths, joint offsets), whose optimal
/// plans are known in closed form.
namespace posewise {
namespace {

using namespace detail;

constexpr double pi = std::numbers::pi;

VectorXd lengths(Index n) { return Eigen::Vector4d(1, 0.8, 0.5, 0.7).head(n); }

/// The arm's poses as a design space. Every pose is refined; |q_2| is at most `limit`.
/// `absolute_angles`: the offsets are those of the links' absolute angles, not of the joints.
DesignSpace planar_space(Index n, double limit, bool absolute_angles = false) {
    // Joint offsets dq to absolute offsets: dtheta_k = dq_1 + ... + dq_k.
    MatrixXd parameters_from_own = MatrixXd::Identity(2 * n, 2 * n);
    if (absolute_angles) {
        for (Index k = 1; k < n; ++k) parameters_from_own(n + k, n + k - 1) = -1;
    }
    const auto block = [n, parameters_from_own](const VectorXd& q) -> RowMatrixXd {
        return test::planar_arm_blocks(lengths(n), q.transpose()).matrix * parameters_from_own;
    };
    DesignSpace space;
    space.lower = VectorXd::Constant(n, -4 * pi);
    space.upper = VectorXd::Constant(n, 4 * pi);
    space.lower[1] = -limit;
    space.upper[1] = limit;
    space.parameter_count = 2 * n;
    space.rows = block;
    space.information = [block](const VectorXd& q) -> MatrixXd {
        const RowMatrixXd B = block(q);
        return B.transpose() * B;
    };
    // B is trigonometric in each joint, so d B / d q_j = (B(q_j + pi / 2) - B(q_j - pi / 2)) / 2.
    space.information_gradient = [block](const VectorXd& q, const MatrixXd& Z) -> VectorXd {
        const RowMatrixXd BZ = block(q) * Z;
        VectorXd gradient(q.size());
        for (Index j = 0; j < q.size(); ++j) {
            const VectorXd quarter = pi / 2 * VectorXd::Unit(q.size(), j);
            const RowMatrixXd slope = (block(q + quarter) - block(q - quarter)) / 2;
            gradient[j] = 2 * BZ.cwiseProduct(slope).sum();
        }
        return gradient;
    };
    return space;
}

/// The best of several random starts.
double best_value(const DesignSpace& space, const Objective& objective, Index poses) {
    double best = -std::numeric_limits<double>::infinity();
    for (std::uint64_t start = 0; start < 20; ++start) {
        RandomStream random(91, start);
        RowMatrixXd q(poses, space.joint_count());
        for (Index i = 0; i < poses; ++i) {
            for (Index j = 0; j < q.cols(); ++j) {
                const double reach = std::min(pi, space.upper[j]);
                q(i, j) = random.uniform(-reach, reach);
            }
        }
        const Refinement refined = refine_poses(space, objective, {}, q);
        EXPECT_GE(refined.value, refined.start_value);
        best = std::max(best, refined.value);
    }
    return best;
}

/// log det M = 2 n log m + 2 sum log l_k, and 4 log sin a less where |q_2| <= a < 90 deg: the
/// Gram matrix of links 1 and 2 has an off-diagonal entry of at least cos a [Fischer's inequality].
TEST(RefinePoses, ReachesTheDOptimalPlanarArm) {
    for (const Index n : {2, 3, 4}) {
        for (const double limit : {4 * pi, 1.0, 0.6}) {
            for (const Index m : {4, 8}) {
                const double squeeze = limit < pi / 2 ? std::sin(limit) : 1;
                const double expected = 2.0 * static_cast<double>(n) * std::log(m) +
                                        2 * lengths(n).array().log().sum() + 4 * std::log(squeeze);
                const double value =
                    best_value(planar_space(n, limit), make_objective(Criterion::D, m), m);
                // Relative to det M.
                EXPECT_NEAR(value, expected, 1e-8) << n << " links, limit " << limit << ", " << m;
            }
        }
    }
}

/// trace M^-1 of lengths and absolute angles: sum of (1 + 1 / l_k^2) / m, links 1 and 2 divided by
/// sin^2 a.
TEST(RefinePoses, ReachesTheAOptimalPlanarArm) {
    for (const Index n : {2, 3, 4}) {
        for (const double limit : {4 * pi, 1.0}) {
            const Index m = 4;
            const double squeeze = limit < pi / 2 ? std::sin(limit) : 1;
            VectorXd variances = 1 + lengths(n).array().square().inverse();
            variances.head(2) /= squeeze * squeeze;
            const double expected = static_cast<double>(m) / variances.sum();
            const double value =
                best_value(planar_space(n, limit, true), make_objective(Criterion::A, m), m);
            EXPECT_NEAR(value / expected, 1, 1e-8) << n << " links, limit " << limit;
        }
    }
}

/// Test poses with q_2 = +-90 deg that are an optimal plan themselves: the worst prediction is
/// (2 / m)(n - 2 + 2 / sin^2 a), and no better than the mean.
TEST(RefinePoses, ReachesTheGOptimalPlanarArm) {
    for (const Index n : {2, 3, 4}) {
        for (const double limit : {4 * pi, 1.0}) {
            const Index m = 4;
            RowMatrixXd test_angles(4, 4);
            test_angles << 0, 90, 0, 0, 90, -90, 180, 180, 0, 90, 180, 0, 90, -90, 0, 180;
            const Blocks test_poses =
                test::planar_arm_blocks(lengths(n), test_angles.leftCols(n) * pi / 180);
            const double squeeze = limit < pi / 2 ? std::sin(limit) : 1;
            const double worst = 2.0 / static_cast<double>(m) *
                                 (static_cast<double>(n) - 2 + 2 / (squeeze * squeeze));
            const double value =
                best_value(planar_space(n, limit), make_objective(Criterion::G, m, &test_poses), m);
            EXPECT_NEAR(value * worst, 1, 1e-8) << n << " links, limit " << limit;
        }
    }
}

}  // namespace
}  // namespace posewise
