#include <gtest/gtest.h>

#include <cmath>

#include "../../src/core/statistics.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/planning.hpp"
#include "support/fanuc_planning.hpp"

namespace posewise {
namespace {

using namespace testing;

struct Reach {
    explicit Reach(Index pose_count, double model_error = 1e-4) {
        campaign.model_error = model_error;
        errors = make_position_errors(campaign, fanuc_workspace(30));
        const RowMatrixXd configurations = fanuc_pool(pose_count);
        poses = make_blocks(campaign, campaign.nominal, configurations);
        M = information(poses);
        by_noise = information_by_noise(campaign, campaign.nominal, configurations,
                                        RowMatrixXd::Ones(pose_count, 3));
    }
    Campaign campaign = fanuc_planning_campaign();
    PositionErrors errors;
    Blocks poses;
    MatrixXd M;
    InformationByNoise by_noise;
};

/// Of one position and a model error that is known the distance is Maxwell's.
TEST(PredictRange, OfOnePositionIsTheLengthOfANormalVector) {
    Campaign campaign = fanuc_planning_campaign();
    campaign.model_error = 2e-4;
    campaign.known_within.model_error = 1;
    const PositionErrors errors = make_position_errors(campaign, fanuc_workspace(1), 0);
    for (const auto quantity : {ErrorQuantity::Max, ErrorQuantity::Percentile95}) {
        const ErrorRange range = predict_range(errors, campaign, {}, {}, quantity, 0.9);
        EXPECT_NEAR(range.assured / 2e-4, std::sqrt(detail::chi_squared_quantile(0.9, 3)), 0.07);
        EXPECT_NEAR(range.expected / 2e-4, std::sqrt(detail::chi_squared_quantile(0.5, 3)), 0.05);
        EXPECT_NEAR(range.lower / 2e-4, std::sqrt(detail::chi_squared_quantile(0.05, 3)), 0.05);
    }
    const ErrorRange rms = predict_range(errors, campaign, {}, {}, ErrorQuantity::Rms, 0.9);
    EXPECT_NEAR(rms.assured, std::sqrt(3.0) * 2e-4, 1e-12);
}

/// Repeatability of one joint moves all by its arm.
TEST(PredictRange, TakesTheRepeatabilityOfTheJointsIn) {
    Campaign campaign = fanuc_planning_campaign();
    campaign.joint_repeatability = VectorXd::Zero(6);
    campaign.joint_repeatability[0] = 1e-4;
    const RowMatrixXd workspace = fanuc_workspace(40);
    const PositionErrors errors = make_position_errors(campaign, workspace, 1);
    double square = 0;
    for (Index i = 0; i < workspace.rows(); ++i) {
        const auto place = [&](double turn) {
            VectorXd q = workspace.row(i).transpose();
            q[0] += turn;
            return Vector3d(world_from_flange(campaign, campaign.nominal, q) *
                            campaign.sensor->target_position(1, campaign.nominal.sensor));
        };
        square += (place(5e-5) - place(-5e-5)).squaredNorm() / 40;
    }
    const ErrorRange range = predict_range(errors, campaign, {}, {}, ErrorQuantity::Rms, 0.95);
    EXPECT_NEAR(range.expected, std::sqrt(square), 1e-9);
    EXPECT_NEAR(range.assured, std::sqrt(square), 1e-9);
    const ErrorRange largest = predict_range(errors, campaign, {}, {}, ErrorQuantity::Max, 0.95);
    EXPECT_GT(largest.assured, 2 * range.assured);
    EXPECT_NEAR(make_budget(errors, campaign, {}, {}).repeatability, std::sqrt(square), 1e-9);
}

TEST(PredictRange, GrowsFromTheRmsToTheLargestAndIsTheSameForAnyThreads) {
    const Reach reach(20);
    double before = 0;
    for (const auto quantity :
         {ErrorQuantity::Rms, ErrorQuantity::Percentile95, ErrorQuantity::Max}) {
        set_thread_count(1);
        const auto predict = [&] {
            return predict_range(reach.errors, reach.campaign, reach.M, reach.by_noise, quantity,
                                 0.95);
        };
        const auto one = predict();
        set_thread_count(3);
        const auto three = predict();
        EXPECT_EQ(one.assured, three.assured);
        EXPECT_EQ(one.expected, three.expected);
        EXPECT_GT(one.assured, 1.2 * before);
        EXPECT_EQ(one.assured, one.upper);
        before = one.assured;
    }
    for (const double assurance : {0.0, 1.0, -1.0, std::nan("")}) {
        EXPECT_THROW(predict_range(reach.errors, reach.campaign, reach.M, reach.by_noise,
                                   ErrorQuantity::Rms, assurance),
                     InputError);
    }
}

/// Noise and model error in the ratio of their squares where they are alike in all directions.
TEST(MakeBudget, DividesWhatThePosesLeaveAsTheNoiseIs) {
    const double sigma = 0.05185e-3;
    const Reach reach(20, 2 * sigma);
    const ErrorBudget budget = make_budget(reach.errors, reach.campaign, reach.M, reach.by_noise);
    EXPECT_NEAR(budget.model, 2 * budget.noise, 1e-9);
    EXPECT_EQ(budget.prior, 0);
    EXPECT_NEAR(std::hypot(budget.model, budget.noise), budget.parameters, 1e-12);
    EXPECT_NEAR(budget.total, std::hypot(budget.parameters, std::sqrt(3.0) * 2 * sigma), 1e-12);
}

TEST(DropEach, IsThePredictionWithoutThePose) {
    const Reach reach(12);
    const auto each = drop_each(reach.errors.by_parameters, reach.poses, reach.M);
    ASSERT_EQ(each.size(), 12u);
    for (const DropOut& one : each) {
        const auto block = reach.poses[one.pose];
        const MatrixXd left = reach.M - block.transpose() * block;
        const double expected = predict_accuracy(reach.errors.by_parameters, left).rms;
        EXPECT_NEAR(one.rms, expected, 1e-6 * expected);
    }
    // 33 parameters take five poses: none of these can be missing.
    const Reach least(5);
    MatrixXd M = least.M;
    EXPECT_TRUE(std::isinf(drop_each(least.errors.by_parameters, least.poses, M).front().rms));
    EXPECT_EQ(drop_worst(least.errors.by_parameters, least.poses, 3, M).size(), 1u);
    EXPECT_EQ(M, least.M);
}

TEST(DropWorst, TakesTheOneThatThenHurtsMost) {
    const Reach reach(12);
    MatrixXd M = reach.M;
    const auto worst = drop_worst(reach.errors.by_parameters, reach.poses, 3, M);
    ASSERT_EQ(worst.size(), 3u);
    std::vector<Index> left{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    for (const DropOut& dropped : worst) {
        DropOut expected;
        for (const Index pose : left) {
            std::vector<Index> others = left;
            std::erase(others, pose);
            const double rms =
                predict_accuracy(reach.errors.by_parameters, information(reach.poses, others)).rms;
            if (rms > expected.rms) expected = {pose, rms};
        }
        EXPECT_EQ(dropped.pose, expected.pose);
        EXPECT_NEAR(dropped.rms, expected.rms, 1e-6 * expected.rms);
        std::erase(left, dropped.pose);
    }
    EXPECT_TRUE(M.isApprox(information(reach.poses, left), 1e-9));
}

}  // namespace
}  // namespace posewise
