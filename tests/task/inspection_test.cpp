#include "posewise/task/inspection.hpp"

#include <gtest/gtest.h>

#include "posewise/core/types.hpp"
#include "support/campaigns.hpp"
#include "support/robots.hpp"

namespace posewise {
namespace {

Campaign with_limits(Index joint, double lower, double upper) {
    const Campaign campaign = testing::tracked_campaign(testing::fanuc());
    std::vector<Joint> joints = campaign.robot.joints();
    joints[static_cast<std::size_t>(joint)].lower = lower;
    joints[static_cast<std::size_t>(joint)].upper = upper;
    return with_robot(campaign, Chain(joints, campaign.robot.elements()));
}

TEST(NarrowLimits, AreThoseThatSeemToBeInRad) {
    EXPECT_TRUE(find_narrow_limits(testing::tracked_campaign(testing::fanuc())).empty());
    EXPECT_EQ(find_narrow_limits(with_limits(3, to_radians(-3.1), to_radians(3.1))),
              std::vector<Index>{3});
    EXPECT_TRUE(find_narrow_limits(with_limits(3, to_radians(-20), to_radians(20))).empty());
}

}  // namespace
}  // namespace posewise
