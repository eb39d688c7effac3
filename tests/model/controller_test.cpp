#include "posewise/model/controller.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

// The joints that a controller shows, and back.

namespace posewise {
namespace {

using testing::degree;
using testing::fanuc;

std::vector<std::string> six_names() { return {"J1", "J2", "J3", "J4", "J5", "J6"}; }

std::string error_of(const MatrixXd& from_model, const VectorXd& pulses = {}) {
    try {
        ControllerJoints(fanuc(), six_names(), from_model, VectorXd::Zero(6), pulses);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

Isometry3d flange_at(const VectorXd& q) {
    const Chain robot = fanuc();
    return robot.base_from_flange(q, VectorXd::Zero(robot.parameter_count()));
}

TEST(ControllerJoints, AreTheModelsWhereNothingIsStated) {
    const ControllerJoints joints(fanuc());
    EXPECT_TRUE(joints.is_identity());
    EXPECT_EQ(joints.names()[0], fanuc().joint(0).name);
    const VectorXd q = VectorXd::LinSpaced(6, -1, 1);
    EXPECT_EQ(joints.to_controller(q), q);
    EXPECT_EQ(joints.to_model(q), q);
}

TEST(ControllerJoints, ComeBackForRandomCouplings) {
    for (Index i = 0; i < testing::sweep_count(); ++i) {
        RandomStream stream(5, static_cast<std::uint64_t>(i));
        MatrixXd from_model = MatrixXd::Identity(6, 6);
        for (Index k = 0; k < 6; ++k) {
            if (stream.uniform(0, 1) < 0.5) from_model(k, k) = -1;
            if (k > 0) from_model(k, k - 1) = stream.uniform(-1, 1);
        }
        const VectorXd offset = testing::random_vector(stream, 6, 3);
        const ControllerJoints joints(fanuc(), six_names(), from_model, offset);
        const VectorXd q = testing::random_vector(stream, 6, 3);
        EXPECT_LT((joints.to_model(joints.to_controller(q)) - q).cwiseAbs().maxCoeff(), 1e-13);
    }
}

TEST(FanucJoints, KeepTheForearmWhereTheFactorSaysSo) {
    // J3 against the ground: with J2 alone the forearm keeps its direction, and the flange its
    // orientation.
    const ControllerJoints joints = fanuc_joints(fanuc(), 1);
    VectorXd pendant(6);
    pendant << 20, 10, -30, 40, 50, 60;
    VectorXd other = pendant;
    other[1] = 45;
    const Isometry3d a = flange_at(joints.to_model(pendant * degree));
    const Isometry3d b = flange_at(joints.to_model(other * degree));
    EXPECT_LT((a.linear() - b.linear()).norm(), 1e-12);
    EXPECT_GT((a.translation() - b.translation()).norm(), 0.3);

    // With factor 0 the forearm turns with the upper arm, by the 35 deg.
    const ControllerJoints plain = fanuc_joints(fanuc(), 0);
    EXPECT_TRUE(plain.is_identity());
    const Matrix3d turn = flange_at(plain.to_model(other * degree)).linear() *
                          flange_at(plain.to_model(pendant * degree)).linear().transpose();
    EXPECT_NEAR(vector_from_rotation(turn).norm(), 35 * degree, 1e-12);

    // With factor -1 by twice as much.
    const ControllerJoints opposite = fanuc_joints(fanuc(), -1);
    const Matrix3d twice = flange_at(opposite.to_model(other * degree)).linear() *
                           flange_at(opposite.to_model(pendant * degree)).linear().transpose();
    EXPECT_NEAR(vector_from_rotation(twice).norm(), 70 * degree, 1e-12);
}

TEST(FanucJoints, AreRefusedOfOtherRobots) {
    EXPECT_THROW(fanuc_joints(fanuc(), 2), InputError);
    // Joint 3 about the same axis as joint 2.
    std::vector<Element> elements = fanuc().elements();
    for (Element& element : elements) {
        if (!element.joints.empty() && element.joints[0].joint == 2) {
            element.joints[0].coefficient = 1;
        }
    }
    EXPECT_THROW(fanuc_joints(Chain(fanuc().joints(), elements), 1), InputError);
    EXPECT_THROW(fanuc_joints(testing::planar_arm({1, 1}), 1), InputError);
}

TEST(ControllerJoints, RefuseWhatTellsNoJoints) {
    MatrixXd singular = MatrixXd::Identity(6, 6);
    singular.row(2) = singular.row(1);
    EXPECT_NE(error_of(singular).find("matrix is singular"), std::string::npos);
    MatrixXd nan = MatrixXd::Identity(6, 6);
    nan(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(error_of(nan).find("not finite"), std::string::npos);
    EXPECT_NE(error_of(MatrixXd::Identity(5, 5)).find("must be 6"), std::string::npos);
    VectorXd pulses = VectorXd::Constant(6, 1000);
    pulses[4] = -1000;
    EXPECT_NE(error_of(MatrixXd::Identity(6, 6), pulses).find("not positive"), std::string::npos);
    EXPECT_THROW(ControllerJoints(fanuc(), {"a", "a", "b", "c", "d", "e"}, MatrixXd::Identity(6, 6),
                                  VectorXd::Zero(6)),
                 InputError);
}

TEST(ControllerJoints, DoNotAddWhatTurnsToWhatSlides) {
    const Chain robot(
        {{"q1", -1, 1}, {"lift", 0, 1}},
        {{Motion::Rotation, Axis::Z, 0, {{0, 1}}}, {Motion::Translation, Axis::Z, 0, {{1, 1}}}});
    MatrixXd from_model = MatrixXd::Identity(2, 2);
    from_model(0, 1) = 1;
    EXPECT_THROW(ControllerJoints(robot, {"a", "b"}, from_model, VectorXd::Zero(2)), InputError);
    EXPECT_EQ(ControllerJoints(robot).motion(1), Motion::Translation);
}

}  // namespace
}  // namespace posewise
