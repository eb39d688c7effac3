#include "posewise/task/correction.hpp"

#include <gtest/gtest.h>

#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;

TEST(CorrectPoses, BringsTheRobotWhereTheNominalOneWouldBe) {
    const Campaign campaign = testing::tracked_campaign(testing::fanuc());
    Parameters found = draw_truth(campaign, 3);
    const RowMatrixXd program = 0.5 * random_configurations(campaign.robot, 5, 4);
    const std::vector<std::string> ids{"a", "b", "c", "d", "e"};
    const VectorXd no_errors = VectorXd::Zero(campaign.robot.parameter_count());
    for (const auto base : {CorrectionBase::Estimate, CorrectionBase::Campaign}) {
        const CorrectedPoses poses = correct_poses(campaign, found, program, ids, base);
        ASSERT_EQ(poses.corrections.size(), 5U);
        EXPECT_EQ(poses.ids, ids);
        for (Index i = 0; i < 5; ++i) {
            const VectorXd joints = poses.corrections[static_cast<std::size_t>(i)].joints;
            const VectorXd nominal = program.row(i).transpose();
            const Isometry3d there = campaign.robot.base_from_flange(joints, found.robot);
            const Isometry3d wanted = campaign.robot.base_from_flange(nominal, no_errors);
            const bool is_estimate = base == CorrectionBase::Estimate;
            const Isometry3d miss = is_estimate
                                        ? wanted.inverse() * there
                                        : (campaign.nominal.world_from_base * wanted).inverse() *
                                              found.world_from_base * there;
            EXPECT_LT(miss.translation().norm(), 1e-8) << i;
        }
    }
}

TEST(CorrectPoses, NamesWhatItCannotUse) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    const Parameters found = draw_truth(campaign, 3);
    RowMatrixXd program = RowMatrixXd::Zero(2, 6);
    program(1, 0) = 100;
    EXPECT_EQ(testing::input_error_of([&] {
                  correct_poses(campaign, found, program, {"a", "b"});
              }).find("configuration 'b': joint '"),
              0U);
    campaign.has_nominal_base = false;
    program.setZero();
    EXPECT_THROW(correct_poses(campaign, found, program, {"a", "b"}, CorrectionBase::Campaign),
                 InputError);
}

}  // namespace
}  // namespace posewise
