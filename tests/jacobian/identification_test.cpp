#include "posewise/jacobian/identification.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "posewise/core/errors.hpp"
#include "posewise/model/sampling.hpp"
#include "support/campaigns.hpp"
#include "support/derivative_check.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

TEST(DifferentiatePose, AgreesWithDifferencesInAll33ColumnsOfTheFanuc) {
    const Campaign campaign = tracked_campaign(fanuc());
    const RowMatrixXd poses = random_configurations(campaign.robot, sweep_count() / 4, 61);
    FlangeMotion motion;
    RowMatrixXd J(9, 33);
    for (Index i = 0; i < poses.rows(); ++i) {
        RandomStream stream(62, static_cast<std::uint64_t>(i));
        const double magnitudes[] = {0, 1e-9, 1e-3, 0.2};
        const VectorXd errors = random_vector(stream, 33, magnitudes[i % 4]);
        const Parameters parameters = advance(campaign.nominal, errors);
        const VectorXd q = poses.row(i).transpose();
        differentiate_pose(campaign, parameters, q, motion, J);
        const auto predict = [&](const VectorXd& step) {
            const Parameters moved = advance(parameters, step);
            return campaign.sensor->predict(world_from_flange(campaign, moved, q), moved.sensor);
        };
        expect_is_jacobian(J, predict, VectorXd::Zero(33));
    }
}

TEST(MakePlainBlocks, StackTheJacobiansOfThePoses) {
    const Campaign campaign = tracked_campaign(fanuc());
    const RowMatrixXd poses = random_configurations(campaign.robot, 7, 63);
    const Blocks blocks = make_plain_blocks(campaign, campaign.nominal, poses);
    ASSERT_EQ(blocks.count(), 7);
    ASSERT_EQ(blocks.parameter_count(), 33);
    FlangeMotion motion;
    RowMatrixXd J(9, 33);
    for (Index i = 0; i < 7; ++i) {
        differentiate_pose(campaign, campaign.nominal, poses.row(i).transpose(), motion, J);
        EXPECT_EQ(RowMatrixXd(blocks[i]), J);
    }
}

TEST(MakeBlocks, AreThePlainOnesDividedByNoiseAndMultipliedByScale) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.model_error = 1.2e-4;
    campaign.spread = {2e-3, 5e-4, {{"Tx1", 7e-3}}};
    const RowMatrixXd poses = random_configurations(campaign.robot, 7, 64);
    const RowMatrixXd plain = make_plain_blocks(campaign, campaign.nominal, poses).matrix;
    const RowMatrixXd blocks = make_blocks(campaign, campaign.nominal, poses, 4).matrix;
    const double sigma = std::sqrt(1.2e-4 * 1.2e-4 + 5e-5 * 5e-5 / 4);
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    for (std::size_t k = 0; k < names.size(); ++k) {
        const double scale = names[k] == "Tx1" ? 7e-3 : is_angle[k] ? 5e-4 : 2e-3;
        const auto column = static_cast<Index>(k);
        EXPECT_TRUE(blocks.col(column).isApprox(plain.col(column) * scale / sigma, 1e-14));
    }
}

TEST(MakeBlocks, ScaleInverselyWithTheNoise) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.model_error = 0;
    const RowMatrixXd poses = random_configurations(campaign.robot, 3, 65);
    const RowMatrixXd once = make_blocks(campaign, campaign.nominal, poses, 1).matrix;
    const RowMatrixXd four_times = make_blocks(campaign, campaign.nominal, poses, 4).matrix;
    EXPECT_TRUE(four_times.isApprox(2 * once, 1e-14));
}

TEST(MakeBlocks, RefuseConfigurationsTheRobotCannotTake) {
    const Campaign campaign = tracked_campaign(fanuc());
    EXPECT_THROW(make_blocks(campaign, campaign.nominal, RowMatrixXd::Zero(2, 5)), InputError);
    RowMatrixXd poses = RowMatrixXd::Zero(2, 6);
    poses(1, 3) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(make_blocks(campaign, campaign.nominal, poses), InputError);
}

}  // namespace
}  // namespace posewise
