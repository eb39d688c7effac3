#include "../../src/model/sampling.hpp"

#include <gtest/gtest.h>

#include "support/robots.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::fanuc;

TEST(RandomConfigurations, FillTheJointLimits) {
    const Chain robot = fanuc();
    const RowMatrixXd q = random_configurations(robot, 2000, 1);
    for (Index j = 0; j < 6; ++j) {
        const Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
        const double margin = 0.01 * (joint.upper - joint.lower);
        EXPECT_GE(q.col(j).minCoeff(), joint.lower);
        EXPECT_LE(q.col(j).minCoeff(), joint.lower + margin);
        EXPECT_LE(q.col(j).maxCoeff(), joint.upper);
        EXPECT_GE(q.col(j).maxCoeff(), joint.upper - margin);
    }
}

TEST(RandomConfigurations, ALongerListBeginsWithTheShorterOne) {
    const RowMatrixXd longer = random_configurations(fanuc(), 30, 5);
    EXPECT_EQ(random_configurations(fanuc(), 10, 5), longer.topRows(10));
    EXPECT_NE(random_configurations(fanuc(), 10, 6), longer.topRows(10));
    EXPECT_EQ(random_configurations(fanuc(), 0, 5).rows(), 0);
}

}  // namespace
}  // namespace posewise
