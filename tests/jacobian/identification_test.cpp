#include "posewise/jacobian/identification.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "../../src/measurement/noise.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "support/campaigns.hpp"
#include "support/derivative_check.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
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
        const Parameters parameters = advance(campaign, campaign.nominal, errors);
        const VectorXd q = poses.row(i).transpose();
        differentiate_pose(campaign, parameters, q, motion, J);
        const auto predict = [&](const VectorXd& step) {
            const Parameters moved = advance(campaign, parameters, step);
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

TEST(MakeBlocks, ATargetThatIsNotSeenTellsAsMuchAsOneWithEndlessNoise) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.joint_repeatability = VectorXd::Constant(6, 4e-5);  // correlates the targets
    const RowMatrixXd poses = random_configurations(campaign.robot, 4, 66);
    const RowMatrixXd repeats{{3, 0, 2}, {0, 0, 1}, {1, 5, 2}, {0, 0, 0}};
    const Blocks blocks = make_blocks(campaign, campaign.nominal, poses, repeats);
    const Blocks plain = make_plain_blocks(campaign, campaign.nominal, poses);
    EXPECT_EQ(blocks.first_row, (std::vector<Index>{0, 6, 9, 18, 18}));
    const VectorXd scale = parameter_scale(campaign);
    for (Index i = 0; i < 4; ++i) {
        FlangeMotion motion;
        campaign.robot.differentiate(campaign.nominal.world_from_base, poses.row(i).transpose(),
                                     campaign.nominal.robot, motion);
        const VectorXd times = repeats.row(i).transpose().cwiseMax(1);
        MatrixXd S = mean_covariance(campaign, motion, campaign.nominal.sensor, times);
        for (Index j = 0; j < 3; ++j) {
            if (repeats(i, j) == 0) S.diagonal().segment<3>(3 * j).array() += 1e4;
        }
        const MatrixXd J = plain[i] * scale.asDiagonal();
        const MatrixXd expected = J.transpose() * S.ldlt().solve(J);
        const MatrixXd found = blocks[i].transpose() * blocks[i];
        EXPECT_LT((found - expected).norm(), 1e-6 * (1 + expected.norm())) << i;
    }
}

TEST(MakePlainBlocks, HaveTheRowsOfTheTargetsSeen) {
    const Campaign campaign = tracked_campaign(fanuc());
    const RowMatrixXd poses = random_configurations(campaign.robot, 2, 67);
    const Blocks all = make_plain_blocks(campaign, campaign.nominal, poses);
    const Blocks some =
        make_plain_blocks(campaign, campaign.nominal, poses, RowMatrixXd{{0, 0.3, 7}, {0, 1, 0}});
    EXPECT_EQ(RowMatrixXd(some[0]), RowMatrixXd(all[0].bottomRows(6)));
    EXPECT_EQ(RowMatrixXd(some[1]), RowMatrixXd(all[1].middleRows(3, 3)));
}

TEST(MakeBlocks, RefuseRepeatsThatDoNotFit) {
    const Campaign campaign = tracked_campaign(fanuc());
    const RowMatrixXd poses = random_configurations(campaign.robot, 2, 68);
    const auto make = [&](const RowMatrixXd& repeats) {
        make_blocks(campaign, campaign.nominal, poses, repeats);
    };
    EXPECT_THROW(make(RowMatrixXd::Ones(2, 2)), InputError);
    EXPECT_THROW(make(RowMatrixXd::Ones(3, 3)), InputError);
    EXPECT_THROW(make(-RowMatrixXd::Ones(2, 3)), InputError);
    EXPECT_THROW(make(RowMatrixXd::Constant(2, 3, std::nan(""))), InputError);
    EXPECT_NO_THROW(make(RowMatrixXd::Zero(2, 3)));
}

TEST(MakeBlocks, HaveTheRowsOfTargetsSeenOnly) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.joint_repeatability = VectorXd::Constant(6, 1e-5);  // correlates the targets
    const RowMatrixXd q = random_configurations(campaign.robot, 3, 1);
    const Seen seen{{true, true, true}, {false, true, false}, {false, false, false}};
    const Blocks blocks = make_blocks(campaign, campaign.nominal, q, times_seen(seen, 1));
    EXPECT_EQ(blocks.first_row, (std::vector<Index>{0, 9, 12, 12}));
    const Blocks all = make_blocks(campaign, campaign.nominal, q);
    EXPECT_LT((blocks[0] - all[0]).cwiseAbs().maxCoeff(), 1e-12);

    // A sensor that has the second target only must tell the same of the robot.
    Campaign one = campaign;
    const auto& sensor = dynamic_cast<const PointSensor&>(*campaign.sensor);
    one.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1), sensor.noise());
    one.nominal.sensor = campaign.nominal.sensor.segment<3>(3);
    const Blocks expected = make_blocks(one, one.nominal, q);
    EXPECT_LT((blocks[1].leftCols(24) - expected[1].leftCols(24)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((blocks[1].middleCols(27, 3) - expected[1].rightCols(3)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_EQ(blocks[1].middleCols(24, 3).norm(), 0);

    EXPECT_EQ(make_blocks(campaign, campaign.nominal, q, times_seen(all_seen(3, 3), 1)).matrix,
              all.matrix);
    EXPECT_THROW(make_blocks(campaign, campaign.nominal, q, times_seen(all_seen(1, 1), 1)),
                 InputError);
    EXPECT_THROW(make_blocks(campaign, campaign.nominal, q, times_seen(all_seen(3, 1), 1)),
                 InputError);
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
