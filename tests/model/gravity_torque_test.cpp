#include <gtest/gtest.h>

#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/derivative_check.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

const Vector3d gravity = Vector3d(0, 0, -9.80665);

TEST(GravityTorque, OfAPendulumIsItsWeightTimesItsArm) {
    // Positive about y turns x to -z: the weight helps it.
    const Chain arm({{"q1", -2, 2}},
                    {driven(Motion::Rotation, Axis::Y, 0), translation(Axis::X, 1)});
    const GravityTorque torque(arm, 0, gravity, {{1, 3, Vector3d(0.5, 0, 0)}});
    EXPECT_NEAR(torque.largest(), 3 * 9.80665 * 0.5, 1e-4);
    EXPECT_TRUE(torque.varies());
    for (const double q : {-1.2, 0.0, 0.7}) {
        const TorqueShare share = torque.evaluate_twice(VectorXd::Constant(1, q));
        EXPECT_DOUBLE_EQ(torque.value(VectorXd::Constant(1, q)), share.value);
        const double scale = 3 * 9.80665 * 0.5 / torque.largest();
        EXPECT_NEAR(share.value, scale * std::cos(q), 1e-14);
        EXPECT_NEAR(share.gradient[0], -scale * std::sin(q), 1e-14);
        EXPECT_NEAR(share.hessian(0, 0), -scale * std::cos(q), 1e-14);
    }
}

TEST(GravityTorque, IsTheForceAlongAnAxisThatSlides) {
    const Chain lift({{"z", 0, 1}, {"q", -1, 1}}, {driven(Motion::Translation, Axis::Z, 0),
                                                   driven(Motion::Rotation, Axis::X, 1)});
    const GravityTorque force(lift, 0, gravity, {{1, 2, Vector3d::Zero()}, {3, 1, {0, 0.4, 0}}});
    EXPECT_NEAR(force.largest(), 3 * 9.80665, 1e-12);
    EXPECT_FALSE(force.varies());
    EXPECT_NEAR(force.evaluate(Eigen::Vector2d(0.3, 0.2)).value, -1, 1e-14);
}

TEST(GravityTorque, IsNothingForWhatItsElementDoesNotMove) {
    const Chain robot = fanuc();
    const GravityTorque torque(robot, 8, gravity, {{2, 50, {0.1, 0.2, 0.5}}, {0, 9, {1, 0, 0}}});
    EXPECT_FALSE(torque.varies());
    EXPECT_EQ(torque.evaluate(VectorXd::Zero(6)).value, 0);
}

/// Loads on every link of the robot and its flange.
std::vector<Load> random_loads(RandomStream& stream, const Chain& robot) {
    std::vector<Load> loads;
    for (Index link = 0; link <= robot.joint_count() + 1; ++link) {
        loads.push_back({link, stream.uniform(1, 20), random_vector(stream, 3, 0.3)});
    }
    return loads;
}

/// Its potential energy, from where the centres of mass are; `element` is moved by `amount`.
double potential(Chain robot, const std::vector<Load>& loads, std::size_t element, double amount,
                 const VectorXd& q) {
    std::vector<Element> elements = without_parameters(robot).elements();
    elements[element].value += amount;
    robot = robot.with_elements(std::move(elements));
    const auto links = robot.base_from_links(q, VectorXd());
    double energy = 0;
    for (const Load& load : loads) {
        const Vector3d center = links[static_cast<std::size_t>(load.link)] * load.center;
        energy -= load.mass * gravity.dot(center);
    }
    return energy;
}

TEST(GravityTorque, IsWhatTakesThePotentialEnergyOfAnyRobot) {
    const Chain coupled({{"q1", -3, 3}, {"q2", -3, 3}, {"s", -1, 1}},
                        {driven(Motion::Rotation, Axis::Y, 0),
                         translation(Axis::X, 0.7),
                         {Motion::Rotation, Axis::X, 0.2, {{0, -0.5}, {1, 1}}, ""},
                         driven(Motion::Translation, Axis::Z, 2),
                         driven(Motion::Rotation, Axis::Z, 1, "", 2)});
    std::uint64_t seed = 0;
    for (const Chain& robot :
         {fanuc(), ur_type(), seven_joint_arm(), gantry_with_wrist(), rail_with_fanuc(), coupled}) {
        RandomStream stream(61, seed++);
        const std::vector<Load> loads = random_loads(stream, robot);
        const RowMatrixXd configurations = random_configurations(robot, 3, seed);
        for (std::size_t k = 0; k < robot.elements().size(); ++k) {
            if (robot.elements()[k].joints.empty()) continue;
            const GravityTorque torque(robot, k, gravity, loads);
            for (Index i = 0; i < configurations.rows(); ++i) {
                const VectorXd q = configurations.row(i).transpose();
                const TorqueShare share = torque.evaluate_twice(q);
                const MatrixXd value = MatrixXd::Constant(1, 1, -torque.largest() * share.value);
                expect_is_jacobian(
                    value,
                    [&](const VectorXd& x) -> VectorXd {
                        return VectorXd::Constant(1, potential(robot, loads, k, x[0], q));
                    },
                    VectorXd::Zero(1));
                expect_is_jacobian(
                    share.gradient.transpose(),
                    [&](const VectorXd& x) -> VectorXd {
                        return VectorXd::Constant(1, torque.evaluate(x).value);
                    },
                    q);
                expect_is_jacobian(
                    share.hessian,
                    [&](const VectorXd& x) -> VectorXd { return torque.evaluate(x).gradient; }, q);
            }
        }
    }
}

TEST(GravityTorque, DoesNotVaryByRounding) {
    // A weight on the last axis of the wrist, wherever that is.
    const Chain robot = fanuc();
    const std::vector<Load> on_axis{{7, 5, {0.1, 0, 0}}};
    EXPECT_FALSE(GravityTorque(robot, robot.elements().size() - 1, gravity, on_axis).varies());
    EXPECT_TRUE(GravityTorque(robot, 4, gravity, on_axis).varies());
    // A tilt of the base that nobody can measure turns nothing about the upright axis.
    const Vector3d tilted(1e-16, 0, -9.80665);
    EXPECT_FALSE(GravityTorque(robot, 0, tilted, on_axis).varies());
}

TEST(GravityTorque, RefusesLoadsThatMakeNoSense) {
    const Chain robot = fanuc();
    EXPECT_THROW(GravityTorque(robot, 1, gravity, {}), InputError) << "element that stands still";
    EXPECT_THROW(GravityTorque(robot, 99, gravity, {}), InputError) << "no such element";
    EXPECT_THROW(GravityTorque(robot, 0, gravity, {{8, 1, Vector3d::Zero()}}), InputError)
        << "no such link";
    EXPECT_THROW(GravityTorque(robot, 0, gravity, {{1, -1, Vector3d::Zero()}}), InputError);
    EXPECT_THROW(GravityTorque(robot, 0, Vector3d(0, 0, std::nan("")), {}), InputError);
}

}  // namespace
}  // namespace posewise
