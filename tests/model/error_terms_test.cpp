#include "posewise/model/error_terms.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "posewise/core/errors.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;
using Names = std::vector<std::string>;

constexpr auto R = Motion::Rotation;

/// UR-type arm: axes z, then three parallel about -y (alpha 90), then the wrist.
Chain ur_type() {
    std::vector<Joint> joints;
    for (int j = 1; j <= 6; ++j) joints.push_back({"q" + std::to_string(j), -3, 3});
    return Chain(
        joints,
        {driven(R, Axis::Z, 0), translation(Axis::Z, 0.127), rotation(Axis::X, 90 * degree),
         driven(R, Axis::Z, 1), translation(Axis::X, -0.612), driven(R, Axis::Z, 2),
         translation(Axis::X, -0.572), driven(R, Axis::Z, 3), rotation(Axis::X, 90 * degree),
         driven(R, Axis::Z, 4), rotation(Axis::X, -90 * degree), driven(R, Axis::Z, 5)});
}

Names terms_of(const Chain& chain) { return chain.parameter_names(); }

TEST(GravityTerms, OfASixAxisArmAreSixWithTheSignsOfItsElements) {
    EXPECT_EQ(terms_of(with_gravity_terms(without_parameters(fanuc()))),
              (Names{"q2.sin(q2)", "q2.cos(q2)", "q2.sin(q2-q3)", "q2.cos(q2-q3)", "q3.sin(q2-q3)",
                     "q3.cos(q2-q3)"}));
}

TEST(GravityTerms, OfAUrAreTwelve) {
    const Names names = terms_of(with_gravity_terms(ur_type()));
    ASSERT_EQ(names.size(), 12U);
    EXPECT_EQ(names[5], "q2.cos(q2+q3+q4)");
    EXPECT_EQ(names[6], "q3.sin(q2+q3)");
    EXPECT_EQ(names[11], "q4.cos(q2+q3+q4)");
}

TEST(Compliance, IsOfTheJointsThatTheWeightsTurn) {
    const Chain arm = without_parameters(fanuc());
    const std::vector<Load> forearm{{3, 40, {0.4, 0, 0.1}}, {7, 10, {0.3, 0.2, 0}}};
    EXPECT_EQ(terms_of(with_compliance(arm, forearm)),
              (Names{"q2.compliance", "q3.compliance", "q4.compliance", "q5.compliance",
                     "q6.compliance"}));
    EXPECT_EQ(terms_of(with_compliance(arm, forearm, -Vector3d::UnitZ(), {2})),
              Names{"q3.compliance"});
    // On a wall every joint bends.
    EXPECT_EQ(terms_of(with_compliance(arm, forearm, Vector3d::UnitX())).size(), 6U);
    EXPECT_EQ(compliances(with_compliance(arm, forearm))[1].joint, 2);
    EXPECT_NEAR(compliances(with_compliance(arm, {{2, 10, {0, 0, 1}}}))[0].largest,
                10 * 9.80665 * std::sin(76 * degree), 0.1);
    EXPECT_THROW(with_compliance(arm, forearm, -Vector3d::UnitZ(), {0}), InputError);
    EXPECT_THROW(with_compliance(arm, {}), InputError);
    EXPECT_THROW(with_compliance(arm, {{1, 10, {1, 0, 0}}}), InputError) << "turns no joint";
    EXPECT_THROW(with_compliance(arm, forearm, Vector3d::Zero()), InputError);
    EXPECT_THROW(with_compliance(with_compliance(arm, forearm), forearm), InputError) << "twice";
}

TEST(Compliance, OfAnArmWithoutWristIsACombinationOfItsGravityTerms) {
    const Chain arm = without_parameters(fanuc());
    const Chain waves = with_gravity_terms(arm);
    const Chain joint = with_compliance(arm, {{2, 30, {0.1, 0, 0.6}}, {3, 50, {0.4, 0.3, 0.2}}});
    // Amounts of joint 2 at 40 configurations: rows; one column a term.
    MatrixXd shapes(40, 4);
    VectorXd torque(40);
    RandomStream stream(47);
    const auto amount = [](const Chain& chain, const VectorXd& q, Index parameter) {
        FlangeMotion motion;
        chain.differentiate(Isometry3d::Identity(), q, VectorXd::Zero(chain.parameter_count()),
                            motion);
        return motion.twists(1, 6 + parameter) / std::cos(q[0]);  // about y, turned by q1
    };
    for (Index i = 0; i < 40; ++i) {
        const VectorXd q = random_vector(stream, 6, 1);
        for (Index k = 0; k < 4; ++k) shapes(i, k) = amount(waves, q, k);
        torque[i] = amount(joint, q, 0);
    }
    const VectorXd combination = shapes.colPivHouseholderQr().solve(torque);
    EXPECT_LT((shapes * combination - torque).norm(), 1e-12 * torque.norm());
    EXPECT_GT(torque.norm(), 0.5);
}

TEST(GravityTerms, FollowTheWeightNotTheJointOfAParallelogram) {
    Element elbow = driven(R, Axis::Y, 2);
    elbow.joints.push_back({1, -1});
    const Chain arm({{"q1", -1, 1}, {"q2", -1, 1}, {"q3", -1, 1}},
                    {driven(R, Axis::Z, 0), driven(R, Axis::Y, 1), translation(Axis::Z, 1), elbow,
                     translation(Axis::X, 1)});
    EXPECT_EQ(terms_of(with_gravity_terms(arm)), (Names{"q2.sin(q2)", "q2.cos(q2)", "q2.sin(q3)",
                                                        "q2.cos(q3)", "q3.sin(q3)", "q3.cos(q3)"}));
}

TEST(GravityTerms, AreThePhysicsOfAnArmThatBends) {
    // Forearm pitch of q2 - q3: what the weight of the forearm does to joint 2 is some
    // a cos(pitch), so amounts of joint 2 at equal pitch are the same whatever q2 alone is.
    const Chain arm = with_gravity_terms(without_parameters(fanuc()));
    VectorXd errors = VectorXd::Zero(6);
    errors[3] = 1e-2;  // q2.cos(q2-q3)
    VectorXd q = VectorXd::Zero(6);
    q[1] = 0.4;
    q[2] = 0.1;
    VectorXd shifted = q;
    shifted[1] += 1e-2 * std::cos(0.3);
    EXPECT_TRUE(arm.base_from_flange(q, errors).isApprox(
        arm.base_from_flange(shifted, VectorXd::Zero(6)), 1e-15));
}

TEST(GravityTerms, DependOnHowTheRobotStands) {
    // On a wall gravity is along x: joint 1 turns about a level axis, joint 2 not always.
    EXPECT_EQ(terms_of(with_gravity_terms(without_parameters(fanuc()), Vector3d::UnitX())),
              (Names{"q1.sin(q1)", "q1.cos(q1)"}));
    // Upside down all is the same.
    EXPECT_EQ(with_gravity_terms(fanuc(), Vector3d(0, 0, 9.81)).parameter_count(), 18 + 6);
    EXPECT_THROW(with_gravity_terms(scara()), InputError);
    EXPECT_THROW(with_gravity_terms(fanuc(), Vector3d::Zero()), InputError);
}

TEST(GravityTerms, AreOnTheChosenJointsOnly) {
    EXPECT_EQ(terms_of(with_gravity_terms(without_parameters(fanuc()), -Vector3d::UnitZ(), {2})),
              (Names{"q3.sin(q2-q3)", "q3.cos(q2-q3)"}));
    EXPECT_THROW(with_gravity_terms(fanuc(), -Vector3d::UnitZ(), {1, 4}), InputError);
    EXPECT_THROW(with_gravity_terms(fanuc(), -Vector3d::UnitZ(), {4}), InputError);
    EXPECT_THROW(with_gravity_terms(fanuc(), -Vector3d::UnitZ(), {6}), InputError);
}

TEST(GravityTerms, OfAGantryAreThoseOfTheFirstLevelAxis) {
    EXPECT_EQ(terms_of(with_gravity_terms(gantry_with_wrist())), (Names{"b.sin(b)", "b.cos(b)"}));
}

TEST(Harmonics, AreSinesAndCosinesOfOrders) {
    EXPECT_EQ(terms_of(with_harmonics(without_parameters(fanuc()), {1, 2.5}, {3})),
              (Names{"q4.sin(q4)", "q4.cos(q4)", "q4.sin(2.5q4)", "q4.cos(2.5q4)"}));
    EXPECT_EQ(with_harmonics(gantry_with_wrist(), {1}).parameter_count(), 6);
    EXPECT_THROW(with_harmonics(gantry_with_wrist(), {1}, {0}), InputError);
    EXPECT_THROW(with_harmonics(fanuc(), {0}), InputError);
}

TEST(Harmonics, OfASlideArePeriodicInItsPitch) {
    const Chain rail = with_harmonics(with_pitch(rail_with_fanuc(), 0, 0.02), {1, 2}, {0});
    std::vector<std::string> names = rail.parameter_names();
    names.resize(4);
    ASSERT_EQ(names,
              (Names{"rail.sin(rail)", "rail.cos(rail)", "rail.sin(2rail)", "rail.cos(2rail)"}));
    EXPECT_EQ(rail.parameter_element(0).motion, Motion::Translation);
    VectorXd errors = VectorXd::Zero(rail.parameter_count());
    errors.head<4>() << 8e-6, -3e-6, 2e-6, 1e-6;
    VectorXd q = VectorXd::Zero(7);
    const auto advance = [&](double at) {
        q[0] = at;
        return rail.base_from_flange(q, errors).translation().y() - at;
    };
    const double at_zero = rail.base_from_flange(VectorXd::Zero(7), 0 * errors).translation().y();
    EXPECT_NEAR(advance(0) - at_zero, -3e-6 + 1e-6, 1e-14);
    EXPECT_NEAR(advance(0.005) - at_zero, 8e-6 - 1e-6, 1e-14);  // a quarter of a turn
    EXPECT_NEAR(advance(0.0137), advance(2.0137), 1e-14);
}

TEST(Harmonics, AreOfSlidesWhosePitchIsStated) {
    const Chain gantry = with_pitch(gantry_with_wrist(), 1, 0.01);
    EXPECT_EQ(with_harmonics(gantry, {1}).parameter_count(), 6 + 2);
    EXPECT_EQ(terms_of(with_harmonics(gantry, {2.5}, {1})), (Names{"y.sin(2.5y)", "y.cos(2.5y)"}));
    EXPECT_THROW(with_harmonics(gantry, {1}, {0}), InputError);
    EXPECT_THROW(with_axis_tilt(gantry, {1}, {1}), InputError);
    // With and without a pitch that divides 2 pi into no whole number.
    for (const double pitch : {0.02, 0.012345, 1e-6, 0.3}) {
        EXPECT_EQ(terms_of(with_harmonics(with_pitch(gantry, 1, pitch), {1, 3}, {1})),
                  (Names{"y.sin(y)", "y.cos(y)", "y.sin(3y)", "y.cos(3y)"}));
    }
}

TEST(Harmonics, AreNotAddedWhereGravityHasThem) {
    const Chain both = with_harmonics(with_gravity_terms(without_parameters(fanuc())), {1});
    EXPECT_EQ(both.parameter_count(), 6 + 12 - 2);
    EXPECT_EQ(both.parameter_term(2)->parameter, "q2.sin(q2)");
    EXPECT_EQ(both.parameter_term(2)->kind, TermKind::Gravity);
}

TEST(AxisTilt, IsOfRotationsAboutTheTwoOtherAxes) {
    EXPECT_EQ(terms_of(with_axis_tilt(without_parameters(fanuc()), {2}, {1})),
              (Names{"q2.Rx.sin(2q2)", "q2.Rx.cos(2q2)", "q2.Rz.sin(2q2)", "q2.Rz.cos(2q2)"}));
    EXPECT_EQ(with_axis_tilt(gantry_with_wrist(), {1, 2}).parameter_count(), 3 * 2 * 4);
    EXPECT_THROW(with_axis_tilt(gantry_with_wrist(), {1}, {0}), InputError);
    EXPECT_THROW(with_axis_tilt(fanuc(), {0}), InputError);
}

TEST(AxisTilt, TurnsWhatFollowsTheJoint) {
    const Chain tilting = with_axis_tilt(without_parameters(fanuc()), {2}, {1});
    VectorXd q = VectorXd::Zero(6);
    q[1] = 0.4;
    VectorXd errors = VectorXd::Zero(4);
    errors[2] = 1e-2;  // q2.Rz.sin(2q2)
    std::vector<Element> elements = tilting.elements();
    const auto tilt = std::find_if(elements.begin(), elements.end(), [](const Element& element) {
        return !element.terms.empty() && element.axis == Axis::Z;
    });
    tilt->value = 1e-2 * std::sin(0.8);
    EXPECT_TRUE(tilting.base_from_flange(q, errors).isApprox(
        tilting.with_elements(elements).base_from_flange(q, VectorXd::Zero(4)), 1e-15));
}

TEST(ErrorTerms, AreRemovedWithTheOtherParameters) {
    EXPECT_EQ(without_parameters(with_gravity_terms(fanuc())).parameter_count(), 0);
}

}  // namespace
}  // namespace posewise
