#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "posewise/core/random.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/derivative_check.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

/// Derivatives of a chain's pose, and of those by the joints, against differences.
namespace posewise {
namespace {

using namespace testing;

/// Twist from `reference` to `pose`, exact to first order in their difference.
VectorXd twist_between(const Isometry3d& reference, const Isometry3d& pose) {
    const Matrix3d R = pose.linear() * reference.linear().transpose();
    VectorXd twist(6);
    twist << R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1),
        2 * (pose.translation() - R * reference.translation());
    return twist / 2;
}

/// Chain::differentiate() against differences by base translation, base rotation and errors.
void expect_right_twists(const Chain& chain, const Isometry3d& world_from_base, const VectorXd& q,
                         const VectorXd& parameters) {
    FlangeMotion motion;
    chain.differentiate(world_from_base, q, parameters, motion);
    const Isometry3d expected = world_from_base * chain.base_from_flange(q, parameters);
    ASSERT_TRUE(motion.world_from_flange.isApprox(expected, 1e-14));
    const auto twist = [&](const VectorXd& x) {
        Isometry3d base = world_from_base;
        base.translation() += x.head<3>();
        const Vector3d phi = x.segment<3>(3);
        if (phi.norm() > 0)
            base.linear() = Eigen::AngleAxisd(phi.norm(), phi.normalized()) * base.linear();
        return twist_between(expected, base * chain.base_from_flange(q, x.tail(parameters.size())));
    };
    VectorXd x = VectorXd::Zero(6 + parameters.size());
    x.tail(parameters.size()) = parameters;
    expect_is_jacobian(motion.twists, twist, x);
}

TEST(Chain, DifferentiatesEveryKindOfElement) {
    RandomStream stream(21);
    for (const Motion motion : {Motion::Translation, Motion::Rotation}) {
        for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
            Element element{motion, axis, 0.3, {{0, -1.0}}, "error"};
            const Chain chain({{"q1", -1, 1}}, {rotation(Axis::X, 0.4), translation(Axis::Y, 0.7),
                                                rotation(Axis::Z, -1.1), element,
                                                rotation(Axis::Y, 0.9), translation(Axis::X, 0.5)});
            for (const double error : {0.0, 1e-9, 0.6}) {
                expect_right_twists(chain, random_pose(stream), random_vector(stream, 1, 1),
                                    VectorXd::Constant(1, error));
            }
        }
    }
}

TEST(Chain, DifferentiatesTheFanucAnywhere) {
    RandomStream stream(22);
    const Chain robot = fanuc();
    for (Index sweep = 0; sweep < sweep_count() / 10; ++sweep) {
        for (const double magnitude : {0.0, 1e-9, 1e-3, 0.3}) {
            expect_right_twists(robot, random_pose(stream),
                                random_vector(stream, 6, std::numbers::pi),
                                random_vector(stream, 18, magnitude));
        }
    }
}

/// Chain::differentiate_twice() against differences of differentiate() by the joints.
void expect_right_rates(const Chain& chain, const Isometry3d& world_from_base, const VectorXd& q,
                        const VectorXd& parameters) {
    FlangeMotion motion;
    std::vector<FlangeMotionRate> rates;
    chain.differentiate_twice(world_from_base, q, parameters, motion, rates);
    const auto columns = [](const TwistMatrix& a, const TwistMatrix& b) -> VectorXd {
        VectorXd all(a.size() + b.size());
        all << a.reshaped(), b.reshaped();
        return all;
    };
    const Index joints = chain.joint_count();
    const VectorXd torques = q.tail(q.size() - joints);
    const auto with_torques = [&](const VectorXd& moved) -> VectorXd {
        VectorXd all(q.size());
        all << moved, torques;
        return all;
    };
    MatrixXd J(motion.twists.size() + motion.joint_twists.size(), joints);
    for (Index j = 0; j < joints; ++j) {
        const FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
        J.col(j) = columns(rate.twists, rate.joint_twists);
    }
    const auto twists = [&](const VectorXd& x) {
        FlangeMotion moved;
        chain.differentiate(world_from_base, with_torques(x), parameters, moved);
        return columns(moved.twists, moved.joint_twists);
    };
    expect_is_jacobian(J, twists, q.head(joints));
    const auto pose = [&](const VectorXd& x) {
        return twist_between(motion.world_from_flange,
                             world_from_base * chain.base_from_flange(with_torques(x), parameters));
    };
    expect_is_jacobian(motion.joint_twists, pose, q.head(joints));
}

TEST(Chain, KnowsHowItsTwistsChangeWithTheJoints) {
    const Chain coupled({{"q1", -3, 3}, {"q2", -3, 3}, {"s", -1, 1}},
                        {driven(Motion::Rotation, Axis::Y, 0, "a"),
                         translation(Axis::X, 0.7, "b"),
                         {Motion::Rotation, Axis::X, 0.2, {{0, -0.5}, {1, 1}}, "c"},
                         rotation(Axis::Z, 0.3, "d"),
                         driven(Motion::Translation, Axis::Z, 2, "e", 0.8),
                         driven(Motion::Rotation, Axis::Z, 1, "f", 2),
                         translation(Axis::Y, 0.1, "g")});
    for (const Chain& chain : {coupled, fanuc(), gantry_with_wrist(), scara(),
                               with_gains(with_torque_shapes(arm_on_lift())),
                               with_harmonics(with_pitch(arm_on_lift(), 0, 1), {1, 2})}) {
        for (std::uint64_t item = 0; item < static_cast<std::uint64_t>(sweep_count() / 50);
             ++item) {
            RandomStream stream(44, item);
            const Isometry3d base = random_pose(stream);
            const VectorXd q = random_vector(stream, chain.joint_count(), 2);
            expect_right_rates(chain, base, q, random_vector(stream, chain.parameter_count(), 0.2));
        }
    }
}

TEST(Chain, DifferentiatesErrorsThatDependOnTheConfiguration) {
    const Chain chain = with_every_term();
    ASSERT_EQ(chain.parameter_names(), (std::vector<std::string>{"b", "a", "sine", "cosine", "sag",
                                                                 "ratio", "coupling", "c"}));
    EXPECT_EQ(chain.parameter_term(1), nullptr);
    EXPECT_EQ(chain.parameter_term(3)->parameter, "cosine");
    EXPECT_EQ(chain.parameter_element(6).motion, Motion::Translation);
    RandomStream stream(45);
    for (Index sweep = 0; sweep < sweep_count() / 50; ++sweep) {
        for (const double magnitude : {0.0, 1e-3, 0.3}) {
            const Isometry3d base = random_pose(stream);
            const VectorXd q = random_vector(stream, 3, 2);
            const VectorXd errors = random_vector(stream, 8, magnitude);
            expect_right_twists(chain, base, q, errors);
            expect_right_rates(chain, base, q, errors);
            EXPECT_TRUE(chain.base_from_links(q, errors).back().isApprox(
                chain.base_from_flange(q, errors), 1e-15));
        }
    }
}

TEST(Chain, DifferentiatesCompliances) {
    const std::vector<Load> loads{
        {2, 20, {0.1, 0.05, 0.5}}, {4, 9, {0.2, 0, 0}}, {7, 5, {0.1, 0, 0.1}}};
    const Chain weighted = with_compliance(fanuc(), loads, Vector3d(0.1, 0.2, -1));
    const Chain measured = with_measured_compliance(with_every_term(), {{1, 300}, {0, 20}});
    const std::vector<std::string> names = measured.parameter_names();
    EXPECT_EQ(std::count(names.begin(), names.end(), "q2.compliance"), 1);
    EXPECT_EQ(measured.configuration_size(), 5);
    EXPECT_GT(weighted.parameter_count(), 18 + 3);
    RandomStream stream(46);
    for (Index sweep = 0; sweep < sweep_count() / 50; ++sweep) {
        for (const Chain& chain : {weighted, measured}) {
            for (const double magnitude : {0.0, 1e-3, 0.3}) {
                const Isometry3d base = random_pose(stream);
                VectorXd q = random_vector(stream, chain.configuration_size(), 2);
                q.tail(chain.configuration_size() - chain.joint_count()) *= 50;
                const VectorXd errors = random_vector(stream, chain.parameter_count(), magnitude);
                expect_right_twists(chain, base, q, errors);
                expect_right_rates(chain, base, q, errors);
            }
        }
    }
}

}  // namespace
}  // namespace posewise
