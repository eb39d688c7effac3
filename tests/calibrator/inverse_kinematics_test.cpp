#include <gtest/gtest.h>

#include <numbers>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/correction.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/campaign.hpp"
#include "support/campaigns.hpp"
#include "support/robots.hpp"

namespace posewise {
namespace {

using namespace detail;

VectorXd no_errors(const Chain& robot) { return VectorXd::Zero(robot.parameter_count()); }

double largest_change(const VectorXd& a, const VectorXd& b) {
    return (a - b).cwiseAbs().maxCoeff();
}

TEST(InverseKinematics, ComesBackToTheConfigurationNearTheSeed) {
    const Chain robot = testing::fanuc();
    const RowMatrixXd poses = random_configurations(robot, 40, 3);
    const RowMatrixXd away = random_configurations(robot, 40, 4);
    for (Index i = 0; i < poses.rows(); ++i) {
        const VectorXd q = poses.row(i).transpose();
        const VectorXd seed = q + 0.05 * (away.row(i).transpose() - q);
        const InverseSolution solution = inverse_kinematics(
            robot, no_errors(robot), robot.base_from_flange(q, no_errors(robot)), seed);
        ASSERT_EQ(solution.joints.size(), robot.joint_count()) << i;
        EXPECT_LT(largest_change(solution.joints, q), 1e-6) << i;
    }
}

TEST(InverseKinematics, FindsTheBranchThatIsWanted) {
    const Chain robot = testing::fanuc();
    VectorXd q = VectorXd::Zero(6);
    q << 0.2, -0.3, 0.1, 0.5, 0.7, -0.4;
    const Isometry3d flange = robot.base_from_flange(q, no_errors(robot));
    InverseOptions flipped;
    flipped.is_wanted = [](const VectorXd& joints) { return joints[4] < 0; };
    const InverseSolution other = inverse_kinematics(robot, no_errors(robot), flange, q, flipped);
    ASSERT_EQ(other.joints.size(), 6);
    // The other way round the wrist.
    EXPECT_NEAR(other.joints[4], -q[4], 1e-6);
    EXPECT_NEAR(std::abs(other.joints[3] - q[3]), std::numbers::pi, 1e-6);
    const Isometry3d left =
        flange.inverse() * robot.base_from_flange(other.joints, no_errors(robot));
    EXPECT_LT(left.translation().norm(), 1e-9);
    flipped.is_wanted = [](const VectorXd& joints) { return joints[4] < -3; };
    EXPECT_EQ(inverse_kinematics(robot, no_errors(robot), flange, q, flipped).joints.size(), 0);
}

TEST(InverseKinematics, SaysWhichOtherBranchIsAsNear) {
    const Chain robot = testing::fanuc();
    VectorXd q = VectorXd::Zero(6);
    q << 0.2, -0.3, 0.1, 0.5 * std::numbers::pi, 0.3, -0.5 * std::numbers::pi;
    const Isometry3d flange = robot.base_from_flange(q, no_errors(robot));
    VectorXd between = q;  // between both ways round the wrist
    between[3] = between[4] = between[5] = 0;
    EXPECT_EQ(inverse_kinematics(robot, no_errors(robot), flange, between).rival.size(), 6);
    EXPECT_EQ(inverse_kinematics(robot, no_errors(robot), flange, q).rival.size(), 0);
}

TEST(InverseKinematics, ReachesNothingBeyondTheArm) {
    const Chain robot = testing::fanuc();
    Isometry3d flange = Isometry3d::Identity();
    flange.translation() << 9, 0, 0;
    EXPECT_EQ(inverse_kinematics(robot, no_errors(robot), flange, VectorXd::Zero(6)).joints.size(),
              0);
    EXPECT_THROW(inverse_kinematics(robot, no_errors(robot), flange, VectorXd::Constant(6, 9)),
                 InputError);
}

}  // namespace
}  // namespace posewise
