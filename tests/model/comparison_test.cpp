#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "posewise/model/chain.hpp"
#include "support/robots.hpp"

namespace posewise {
namespace {

using namespace testing;

TEST(CompareFlanges, FindsTheLargestDifferenceAndTellsJointsByName) {
    const auto arm = [](Index shoulder, Index elbow) {
        std::vector<Joint> joints(2);
        joints[static_cast<std::size_t>(shoulder)] = {"shoulder", -1, 1};
        joints[static_cast<std::size_t>(elbow)] = {"elbow", -2, 2};
        const auto R = Motion::Rotation;
        return Chain(joints, {driven(R, Axis::Z, shoulder), translation(Axis::X, 1, "length"),
                              driven(R, Axis::Z, elbow, "offset"), translation(Axis::X, 1)});
    };
    const Chain a = arm(0, 1);
    const Chain b = arm(1, 0);
    const Eigen::Vector2d errors(0.1, 0);
    const FlangeDifference same = compare_flanges(a, errors, b, errors);
    EXPECT_LT(same.position, 1e-15);
    EXPECT_LT(same.orientation, 1e-15);
    EXPECT_EQ(same.configuration_count, 1000);
    const FlangeDifference longer = compare_flanges(a, errors, b, Eigen::Vector2d(0.3, 0));
    EXPECT_NEAR(longer.position, 0.2, 1e-15);
    EXPECT_LT(longer.orientation, 1e-15);
    const FlangeDifference turned = compare_flanges(a, errors, b, Eigen::Vector2d(0.1, 0.25));
    EXPECT_NEAR(turned.position, 2 * std::sin(0.125), 1e-15);
    EXPECT_NEAR(turned.orientation, 0.25, 1e-15);
}

TEST(CompareFlanges, NeedsTheSameJoints) {
    EXPECT_THROW(compare_flanges(scara(), VectorXd::Zero(scara().parameter_count()), fanuc(),
                                 VectorXd::Zero(fanuc().parameter_count())),
                 InputError);
}

}  // namespace
}  // namespace posewise
