#include <gtest/gtest.h>

#include <numbers>

#include "../../src/model/complete_model.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/dh.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

FlangeDifference difference(const Chain& chain, const VectorXd& errors) {
    return compare_flanges(chain, errors, ur_chain(ur_frames(chain, errors), chain.joints()),
                           VectorXd());
}

/// Errors of the complete model but those behind the last joint.
VectorXd random_errors(const Chain& complete, double size, std::uint64_t seed) {
    RandomStream stream(seed);
    VectorXd errors = random_vector(stream, complete.parameter_count(), size);
    errors.tail<4>().setZero();
    return errors;
}

/// Where the makers put them: origins in m, turned about x only.
TEST(UrFrames, OfANominalUr10StandWhereItsMakersPutThem) {
    const UrFrames frames = ur_frames(ur_type(), VectorXd());
    const std::array<Vector3d, 6> origins{Vector3d(0, 0, 0.1273),  Vector3d(0, 0, 0),
                                          Vector3d(-0.612, 0, 0),  Vector3d(-0.5723, 0, 0.163941),
                                          Vector3d(0, -0.1157, 0), Vector3d(0, 0.0922, 0)};
    const double quarter = std::numbers::pi / 2;
    const std::array<double, 6> rolls{0, quarter, 0, 0, quarter, -quarter};
    for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_LT((frames[k].translation() - origins[k]).norm(), 1e-15) << k;
        const Matrix3d R = rotation_from_rpy({rolls[k], 0, 0});
        EXPECT_LT((frames[k].linear() - R).norm(), 1e-15) << k;
    }
}

TEST(UrFrames, MoveTheFlangeExactlyAsTheChainDoes) {
    const Chain complete = complete_model(ur_type());
    for (const double size : {0.0, 1e-5, 1e-3, 0.2}) {
        const VectorXd errors = random_errors(complete, size, 3);
        EXPECT_LT(difference(complete, errors).position, 1e-13) << size;
        EXPECT_LT(difference(complete, errors).orientation, 1e-13) << size;
        if (size > 1e-3) continue;
        for (const Isometry3d& frame : ur_frames(complete, errors)) {
            EXPECT_LT(frame.translation().norm(), 0.7) << "no link is far longer than it is";
        }
    }
}

/// The flange's z axis is the last joint's, whatever axes the others have and how they turn.
TEST(UrFrames, TakeAnyAxesAndJointsThatAreReversed) {
    std::vector<Element> elements = fanuc().elements();
    elements.push_back(rotation(Axis::Y, -std::numbers::pi / 2));  // x of the last joint, reversed
    const Chain chain(fanuc().joints(), elements);
    VectorXd errors = random_errors(chain, 1e-3, 4);
    EXPECT_LT(difference(chain, errors).position, 1e-13);
    EXPECT_LT(difference(chain, errors).orientation, 1e-13);
}

TEST(UrFrames, TakeHalvesOfPiThatAreRounded) {
    for (const double half : {1.570796, 1.5708}) {
        std::vector<Element> elements = fanuc().elements();
        elements.push_back(rotation(Axis::Y, -half));
        const Chain chain(fanuc().joints(), elements);
        const FlangeDifference off = difference(chain, random_errors(chain, 1e-3, 4));
        EXPECT_LT(off.position, 1e-12);
        EXPECT_NEAR(off.orientation, std::abs(half - std::numbers::pi / 2), 1e-9) << half;
    }
    std::vector<Element> elements = fanuc().elements();
    elements.push_back(rotation(Axis::Y, -1.571));
    const Chain chain(fanuc().joints(), elements);
    EXPECT_NE(input_error_of([&] {
                  ur_frames(chain, VectorXd::Zero(chain.parameter_count()));
              }).find("its z axis 0.2037 mrad off it"),
              std::string::npos);
}

/// Descriptions with ROS's base_link begin with half a turn; frames begin after it.
TEST(UrFrames, LeaveOutTheHalfTurnBeforeBaseLinkInertia) {
    const auto turned = [](double angle) {
        std::vector<Element> elements = ur_type().elements();
        elements.insert(elements.begin(), rotation(Axis::Z, angle));
        return Chain(ur_type().joints(), elements);
    };
    const UrFrames expected = ur_frames(ur_type(), VectorXd());
    for (const double half : {std::numbers::pi, -std::numbers::pi, 3.14159}) {
        const UrFrames frames = ur_frames(turned(half), VectorXd());
        for (std::size_t k = 0; k < 6; ++k) {
            EXPECT_TRUE(frames[k].isApprox(expected[k], 1e-14)) << half << ' ' << k;
        }
    }
    EXPECT_NE(input_error_of([&] {
                  ur_frames(turned(3.1), VectorXd());
              }).find("the shoulder is turned by 177.6 deg about the base's z axis"),
              std::string::npos);
}

TEST(UrFrames, AreRefusedWhereTheyCannotExpressTheRobot) {
    const auto error = [](const Chain& chain, const VectorXd& errors) {
        return input_error_of([&] { ur_frames(chain, errors); });
    };
    const auto zero = [](const Chain& chain) { return VectorXd::Zero(chain.parameter_count()); };
    for (const Chain& chain : {seven_joint_arm(), scara(), gantry_with_wrist()}) {
        EXPECT_NE(error(chain, zero(chain)).find("six joints that turn"), std::string::npos);
    }
    EXPECT_NE(error(fanuc(), zero(fanuc())).find("its z axis 1570.7963 mrad off it"),
              std::string::npos);
    const Chain complete = complete_model(ur_type());
    VectorXd errors = zero(complete);
    errors[complete.parameter_count() - 4] = 1e-3;
    EXPECT_EQ(error(complete, errors),
              "the flange is 1.0000 mm beside the axis of joint 'q6', its z axis 0.0000 mrad off "
              "it; frames of a UR end with that joint, so that its z axis must be the flange's");
    std::vector<Element> geared = ur_type().elements();
    for (Element& element : geared) {
        if (!element.joints.empty()) element.joints.front().coefficient = 0.5;
    }
    const Chain slow(ur_type().joints(), geared);
    EXPECT_NE(error(slow, VectorXd()).find("neither geared nor coupled"), std::string::npos);
}

}  // namespace
}  // namespace posewise
