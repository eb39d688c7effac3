#include "../../src/model/joint_limits.hpp"

#include <gtest/gtest.h>

namespace posewise {
namespace {

using namespace detail;

TEST(DescribeLimitViolation, NamesTheFirstJointBeyondItsLimits) {
    const Element turn{Motion::Rotation, Axis::Z, 0, {{0, 1}}};
    const Element slide{Motion::Translation, Axis::X, 0, {{1, 1}}};
    const Chain robot({{"q1", -1, 1}, {"lift", 0, 0.25}}, {turn, slide});
    EXPECT_EQ(describe_limit_violation(robot, Eigen::Vector2d(1 + 1e-9, -1e-9)), "");
    EXPECT_EQ(describe_limit_violation(robot, Eigen::Vector2d(0, 0.3)),
              "lift is 300 mm, must be from 0 to 250 mm");
    EXPECT_EQ(describe_limit_violation(robot, Eigen::Vector2d(-1.00001, 0.3)),
              "q1 is -57.2963525 deg, must be from -57.2957795 to 57.2957795 deg");
}

}  // namespace
}  // namespace posewise
