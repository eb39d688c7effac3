#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "posewise/task/correction.hpp"
#include "support/campaigns.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using testing::input_error_of;

class CartesianTargets : public ::testing::Test {
  protected:
    std::string error(const CartesianTarget& target) const {
        return input_error_of([&] { nominal_configurations(campaign_, {target}, frames_); });
    }
    CartesianTarget target_at(const VectorXd& q) const {
        const Chain& robot = campaign_.robot;
        CartesianTarget target{"hole 7", {}, {}, {}};
        target.frame_from_tool = robot.base_from_flange(q, VectorXd::Zero(robot.parameter_count()));
        return target;
    }
    static VectorXd joints(std::initializer_list<double> values) {
        return Eigen::Map<const VectorXd>(values.begin(), std::ssize(values));
    }

    Campaign campaign_ = testing::tracked_campaign(testing::fanuc());
    CartesianFrames frames_;
};

TEST_F(CartesianTargets, AreRefusedByTheirNames) {
    const VectorXd q = joints({0.2, -0.3, 0.1, 0.5, 0.7, -0.4});
    CartesianTarget target = target_at(q);
    EXPECT_EQ(error(target).find("target 'hole 7' has no joint values to begin at"), 0U)
        << error(target);
    frames_.seed = VectorXd::Zero(6);
    EXPECT_EQ(error(target), "no error");
    target.is_wanted = [](const VectorXd& one) { return one[0] > 3; };
    EXPECT_NE(error(target).find("in the configuration that is stated"), std::string::npos);
    target.is_wanted = {};
    target.frame_from_tool.translation() *= 4;
    EXPECT_EQ(error(target).find("target 'hole 7' is not reached by the nominal robot"), 0U)
        << error(target);
    // Both ways round the wrist are as near.
    EXPECT_NE(error(target_at(joints({0.2, -0.3, 0.1, 1.5707963, 0.3, -1.5707963})))
                  .find("about as near"),
              std::string::npos);
}

TEST_F(CartesianTargets, AtASingularPoseAreRefused) {
    const VectorXd q = joints({0.2, -0.3, 0.1, 0.5, 1e-4, -0.4});
    CorrectedPoses corrected{campaign_.robot, {"hole 7"}, q.transpose(), {}, {}, {}};
    Correction correction;
    correction.joints = q;
    correction.joints[4] = 2e-4;
    corrected.corrections = {correction};
    EXPECT_EQ(corrected_targets(corrected, frames_).size(), 1U);
    corrected.corrections[0].joints[4] = -1e-4;
    EXPECT_EQ(input_error_of([&] {
                  corrected_targets(corrected, frames_);
              }).find("target 'hole 7' is at a singular pose"),
              0U);
}

}  // namespace
}  // namespace posewise
