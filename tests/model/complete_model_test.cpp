#include "../../src/model/complete_model.hpp"

#include <gtest/gtest.h>

#include "support/robots.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

TEST(CompleteModel, GivesEveryJointItsFiveErrors) {
    const Chain complete = complete_model(planar_arm({1, 1}));
    EXPECT_EQ(complete.parameter_names(),
              (std::vector<std::string>{"dq1", "Tx1", "Ty1", "Rx1", "Ry1",  //
                                        "dq2", "Tx2", "Ty2", "Rx2", "Ry2"}));
    EXPECT_EQ(complete_model(fanuc()).parameter_count(), 30);
}

TEST(CompleteModel, NamesErrorsAfterJointsOfAnyName) {
    const auto names = complete_model(gantry_with_wrist()).parameter_names();
    EXPECT_EQ(names[0], "d_x");
    EXPECT_EQ(names[1], "Ty_x");
    EXPECT_EQ(names.size(), 30U);
}

TEST(CompleteModel, IsTheSameRobotAtNominal) {
    RandomStream stream(31);
    const VectorXd q = random_vector(stream, 6, 2);
    const Isometry3d expected = fanuc().base_from_flange(q, VectorXd::Zero(18));
    const Isometry3d pose = complete_model(fanuc()).base_from_flange(q, VectorXd::Zero(30));
    EXPECT_TRUE(pose.isApprox(expected, 1e-15));
}

TEST(CompleteModel, GivesACoupledJointOneSetOfErrors) {
    const Element elbow{Motion::Rotation, Axis::Z, 0.0, {{1, 1.0}, {0, -1.0}}, ""};
    const Chain arm({{"q1", -1, 1}, {"q2", -1, 1}},
                    {driven(Motion::Rotation, Axis::Z, 0), translation(Axis::X, 1.0), elbow});
    EXPECT_EQ(complete_model(arm).parameter_count(), 10);
}

/// Three joints and an axis that follows the second one, tilted against it and in line with the
/// third one, as a mimic of a URDF.
Chain arm_with_mimic() {
    return Chain({{"q1", -1, 1}, {"q2", -1, 1}, {"q3", -1, 1}},
                 {driven(Motion::Rotation, Axis::Z, 0), translation(Axis::X, 0.5),
                  driven(Motion::Rotation, Axis::X, 1), rotation(Axis::Y, -1.2),
                  Element{Motion::Rotation, Axis::X, 0, {{1, -1.0}}, ""}, translation(Axis::X, 0.2),
                  driven(Motion::Rotation, Axis::X, 2)});
}

TEST(CompleteModel, GivesAnAxisThatOnlyFollowsErrorsOfItsOwn) {
    const Chain complete = complete_model(arm_with_mimic());
    const auto names = complete.parameter_names();
    ASSERT_EQ(names.size(), 20U);
    EXPECT_EQ(std::vector<std::string>(names.begin() + 10, names.begin() + 15),
              (std::vector<std::string>{"dq2_2", "Ty_q2_2", "Tz_q2_2", "Ry_q2_2", "Rz_q2_2"}));
}

TEST(CompleteModel, TakesACoupledJointWrittenInTwoElementsForOneAxis) {
    const Element back{Motion::Rotation, Axis::Z, 0.0, {{0, -1.0}}, ""};
    for (const bool is_first : {false, true}) {
        std::vector<Element> elements{driven(Motion::Rotation, Axis::Z, 0),
                                      translation(Axis::X, 1.0),
                                      driven(Motion::Rotation, Axis::Z, 1)};
        elements.insert(elements.begin() + (is_first ? 2 : 3), back);
        const Chain arm({{"q1", -1, 1}, {"q2", -1, 1}}, elements);
        EXPECT_EQ(complete_model(arm).parameter_count(), 10);
    }
}

TEST(Gains, AreOfEveryAxisThatJointsDrive) {
    const Chain gained = with_gains(arm_with_mimic());
    EXPECT_EQ(gained.parameter_names(),
              (std::vector<std::string>{"q1.gain", "q2.gain", "q2_2.gain", "q3.gain"}));
    VectorXd errors = VectorXd::Zero(4);
    errors[2] = 0.01;
    const VectorXd q = Eigen::Vector3d(0.2, 0.4, -0.1);
    // The axis that follows turns by -q2, times 1.01, about the middle of the range.
    const Chain expected({{"q1", -1, 1}, {"q2", -1, 1}, {"q3", -1, 1}},
                         {driven(Motion::Rotation, Axis::Z, 0), translation(Axis::X, 0.5),
                          driven(Motion::Rotation, Axis::X, 1), rotation(Axis::Y, -1.2),
                          Element{Motion::Rotation, Axis::X, 0, {{1, -1.01}}, ""},
                          translation(Axis::X, 0.2), driven(Motion::Rotation, Axis::X, 2)});
    EXPECT_TRUE(gained.base_from_flange(q, errors).isApprox(
        expected.base_from_flange(q, VectorXd()), 1e-14));
}

TEST(Gains, ScaleASlideAboutItsMiddle) {
    const Chain rail({{"rail", 0, 4}}, {driven(Motion::Translation, Axis::X, 0)});
    const Chain gained = with_gains(rail);
    ASSERT_EQ(gained.parameter_names(), (std::vector<std::string>{"rail.scale"}));
    const VectorXd error = VectorXd::Constant(1, 3e-4);
    for (const double q : {0.0, 2.0, 4.0}) {
        EXPECT_NEAR(gained.base_from_flange(VectorXd::Constant(1, q), error).translation().x(),
                    q + 3e-4 * (q - 2), 1e-15);
    }
}

TEST(CompleteModel, OfItselfIsItself) {
    for (const Chain& chain : {fanuc(), arm_with_mimic()}) {
        const Chain once = complete_model(chain);
        EXPECT_EQ(complete_model(once).parameter_names(), once.parameter_names());
    }
}

}  // namespace
}  // namespace posewise
