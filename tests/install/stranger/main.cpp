// A user's program: how well do the two best poses of a planar arm determine its two lengths and
// two joint offsets? Known answer: det M = m^(2n) prod l_k^2 = 2^4 * 0.8^2 = 10.24.
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <posewise/core/blocks.hpp>
#include <posewise/core/version.hpp>
#include <posewise/criteria/criterion.hpp>
#include <posewise/model/chain.hpp>

int main() {
    using namespace posewise;
    const double pi = std::numbers::pi;
    const Chain arm({{"q1", -pi, pi}, {"q2", -pi, pi}},
                    {{Motion::Rotation, Axis::Z, 0.0, {{0, 1.0}}, "dq1"},
                     {Motion::Translation, Axis::X, 1.0, {}, "dl1"},
                     {Motion::Rotation, Axis::Z, 0.0, {{1, 1.0}}, "dq2"},
                     {Motion::Translation, Axis::X, 0.8, {}, "dl2"}});

    RowMatrixXd J(4, 4);
    for (Index pose = 0; pose < 2; ++pose) {
        const VectorXd q = pi * Eigen::Vector2d(0.3, static_cast<double>(pose));
        FlangeMotion motion;
        arm.differentiate(Isometry3d::Identity(), q, VectorXd::Zero(4), motion);
        const Vector3d tip = motion.world_from_flange.translation();
        for (Index k = 0; k < 4; ++k) {
            const auto twist = motion.twists.col(6 + k);
            const Vector3d v = twist.tail<3>() + twist.head<3>().cross(tip);
            J.block<2, 1>(2 * pose, k) = v.head<2>();
        }
    }

    const double log_det = evaluate(Criterion::D, information(make_equal_blocks(J, 2)), 2);
    std::printf("posewise %s: det M = %.12f\n", version, std::exp(log_det));
    return std::abs(std::exp(log_det) - 10.24) < 1e-9 ? 0 : 1;
}
