#include "../../src/task/calibration/answers.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "posewise/task/calibration.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

class ResidualAnswers : public ::testing::Test {
  protected:
    /// Residuals of so many configurations, one sample of three targets each: noise of 0.1 mm.
    RowMatrixXd measure(Index configurations, std::uint64_t seed = 1) {
        measurements_ =
            simulate(campaign_, {.pose_count = configurations, .seed = seed}).measurements;
        RandomStream stream(seed);
        RowMatrixXd residuals(3 * configurations, 3);
        for (double& value : residuals.reshaped()) value = 1e-4 * stream.normal();
        return residuals;
    }
    OrderTrend trend_of(const RowMatrixXd& residuals) const {
        return detail::find_order_trend(campaign_, measurements_, residuals).value();
    }

    Campaign campaign_ = testing::tracked_campaign(testing::planar_arm({1, 0.8}));
    Measurements measurements_;
};

TEST_F(ResidualAnswers, FindDriftWhereThereIsSome) {
    RowMatrixXd residuals = measure(30);
    for (Index row = 0; row < residuals.rows(); ++row) {
        residuals(row, 2) += 4e-4 * static_cast<double>(row / 3) / 29;
    }
    const OrderTrend trend = trend_of(residuals);
    EXPECT_EQ(trend.worst().axis, "z");
    EXPECT_TRUE(trend.is_plain());
    EXPECT_TRUE(trend.is_beside_joints);
    EXPECT_NEAR(trend.worst().change, 4e-4, 1e-4);
    EXPECT_LT(trend.worst().early, -1e-4);
    // Means of 3 readings over 30 configurations, as of a line without anything beside it.
    const double alone = 1e-4 / std::sqrt(3.0) * 29 / std::sqrt(30 * (30 * 30 - 1) / 12.0);
    EXPECT_GT(trend.worst().error, 0.7 * alone);
    EXPECT_LT(trend.worst().error, 2 * alone);
    EXPECT_LT(trend.worst().detectable, 4e-4);
}

TEST_F(ResidualAnswers, FindWhatFollowsATemperature) {
    RowMatrixXd residuals = measure(30);
    Condition temperature{"temperature", "C", {}};
    Condition same{"time", "h", {}};
    RandomStream stream(9);
    for (std::size_t i = 0; i < 30; ++i) {
        const double degrees = stream.uniform(20, 24);  // in no order
        if (i != 7) temperature.values[measurements_.ids[i]] = degrees;
        same.values[measurements_.ids[i]] = 3;
        residuals.middleRows(3 * static_cast<Index>(i), 3).col(1).array() += 2e-4 * (degrees - 22);
    }
    const auto trends =
        detail::find_condition_trends(campaign_, measurements_, residuals, {same, temperature});
    ASSERT_EQ(trends.size(), 1U);  // what is the same everywhere is left out
    EXPECT_EQ(trends[0].unit, "C");
    EXPECT_GT(trends[0].range, 3);
    const OrderSlope& worst = trends[0].trend.worst();
    EXPECT_EQ(worst.axis, "y");
    EXPECT_TRUE(trends[0].trend.is_plain());
    EXPECT_NEAR(worst.change / trends[0].range, 2e-4, 3e-5);
    EXPECT_FALSE(trend_of(residuals).is_plain());
    temperature.values.erase(std::next(temperature.values.begin(), 3), temperature.values.end());
    EXPECT_TRUE(
        detail::find_condition_trends(campaign_, measurements_, residuals, {temperature}).empty());
}

TEST_F(ResidualAnswers, HardlyEverFindDriftWhereThereIsNone) {
    Index plain = 0, possible = 0;
    double square = 0;  // of the changes over their standard deviations
    double count = 0;
    constexpr Index campaigns = 400;
    for (Index seed = 1; seed <= campaigns; ++seed) {
        const OrderTrend trend = trend_of(measure(25, static_cast<std::uint64_t>(seed)));
        plain += trend.is_plain() ? 1 : 0;
        possible += trend.is_possible() ? 1 : 0;
        for (const OrderSlope& slope : trend.slopes) {
            square += std::pow(slope.change / slope.error, 2);
            ++count;
        }
    }
    EXPECT_NEAR(square / count, 1.1, 0.25);  // f / (f - 2) of f degrees of freedom
    EXPECT_LE(plain, 16);                    // about 4 would be 1 %
    EXPECT_LE(possible, 44);
}

TEST_F(ResidualAnswers, DoNotTakePosesInAnOrderOfTheirOwnForDrift) {
    RowMatrixXd residuals = measure(40);
    for (Index i = 0; i < 40; ++i) {
        measurements_.configurations(i, 0) = 0.03 * static_cast<double>(i);
        residuals.middleRows(3 * i, 3).col(0).array() +=
            1e-3 * std::sin(measurements_.configurations(i, 0));
    }
    EXPECT_FALSE(trend_of(residuals).is_possible());
    // Fewer configurations than tell joints from order.
    measurements_ = take(measurements_, {0, 4, 8, 12, 16, 20, 24, 28});
    RowMatrixXd few(24, 3);
    for (Index i = 0; i < 8; ++i) few.middleRows(3 * i, 3) = residuals.middleRows(12 * i, 3);
    EXPECT_FALSE(trend_of(few).is_beside_joints);
    EXPECT_TRUE(trend_of(few).is_plain());
    EXPECT_FALSE(
        detail::find_order_trend(campaign_, take(measurements_, {0, 1, 2}), few.topRows(9)));
}

TEST_F(ResidualAnswers, NameTheConfigurationThatTheOthersMiss) {
    const RowMatrixXd residuals = measure(12);
    CrossValidation held_out;
    held_out.folds = 12;
    held_out.residuals = 1.2 * residuals;
    held_out.residuals.middleRows(21, 3) = 9 * residuals.middleRows(21, 3);
    held_out.residuals.middleRows(3, 3).setConstant(std::nan(""));  // could not be predicted
    held_out.samples.distance_rms = 3e-4;
    const Influence most =
        detail::find_influence(campaign_, measurements_, residuals, held_out).value();
    EXPECT_EQ(most.id, measurements_.ids[7]);
    EXPECT_TRUE(most.is_alone);
    EXPECT_NEAR(most.held_out, 9 * most.fit, 1e-15);
    EXPECT_NEAR(most.fit, std::sqrt(residuals.middleRows(21, 3).squaredNorm() / 3), 1e-15);
    const RmsInterval interval =
        detail::held_out_interval(campaign_, measurements_, held_out).value();
    EXPECT_NEAR(interval.lower * interval.upper, 9e-8, 1e-15);
    EXPECT_EQ(interval.degrees_of_freedom, 10);
}

/// The factor is Student's quantile times the relative deviation of the mean square, halved.
TEST_F(ResidualAnswers, IntervalHoldsTheTruthInNineteenOfTwentyCampaigns) {
    Index inside = 0;
    constexpr Index campaigns = 1000;
    for (Index seed = 1; seed <= campaigns; ++seed) {
        CrossValidation held_out;
        held_out.folds = 20;
        held_out.residuals = measure(20, static_cast<std::uint64_t>(seed));
        held_out.samples.distance_rms =
            std::sqrt(held_out.residuals.squaredNorm() / static_cast<double>(60));
        const auto interval = detail::held_out_interval(campaign_, measurements_, held_out);
        const double truth = 1e-4 * std::sqrt(3);
        inside += interval->lower <= truth && truth <= interval->upper ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(inside), 950, 30);
}

TEST(MorePoses, AreReadOffTheCurve) {
    std::vector<ErrorAtCount> points;
    for (const Index count : {32, 8, 4, 16}) {
        points.push_back({count, 1 / std::sqrt(static_cast<double>(count))});
    }
    // 1 / sqrt(n) falls to 0.8 of itself at 1.5625 n.
    EXPECT_EQ(more_poses(points, 8)->more.expected, 5);
    EXPECT_EQ(more_poses(points, 10)->more.expected, 6);
    EXPECT_EQ(more_poses(points, 10)->more.lower, 6) << "no band, no difference";
    const MorePoses none = more_poses(points, 30).value();
    EXPECT_FALSE(none.more.expected);
    EXPECT_EQ(none.most, 32);
    EXPECT_NEAR(none.ratio, std::sqrt(30.0 / 32), 1e-12);
    EXPECT_FALSE(more_poses(points, 3));
    EXPECT_FALSE(more_poses(points, 33));
    EXPECT_FALSE(more_poses({}, 5));
}

/// Where errors turn out large, a part that no number of poses reduces hides the others.
TEST(MorePoses, HaveABandWhereTheErrorHasOne) {
    std::vector<ErrorAtCount> points;
    for (const Index count : {4, 8, 16, 32}) {
        const double by_poses = 1 / static_cast<double>(count);
        points.push_back(
            {count, std::sqrt(by_poses + 0.04), std::sqrt(by_poses), std::sqrt(by_poses + 1)});
    }
    const MorePoses found = more_poses(points, 8).value();
    EXPECT_EQ(found.more.lower, 5);
    EXPECT_GT(found.more.expected, 5);
    EXPECT_FALSE(found.more.upper);
    for (ErrorAtCount& point : points) std::swap(point.lower, point.upper);
    EXPECT_EQ(more_poses(points, 8)->more.lower, 5) << "whichever curve asks for less";
}

TEST(Calibrate, AnswersByItsResiduals) {
    const Campaign campaign = testing::tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate(campaign, {.pose_count = 20}).measurements;
    const Calibration found = calibrate(campaign, measurements);
    ASSERT_TRUE(found.held_out_interval && found.influence && found.order_trend);
    EXPECT_LT(found.held_out_interval->lower, found.held_out->samples.rms());
    EXPECT_GT(found.held_out_interval->upper, found.held_out->samples.rms());
    EXPECT_GT(found.influence->held_out, found.influence->fit);
    EXPECT_EQ(found.order_trend->slopes.size(), 3U);
    EXPECT_FALSE(calibrate(campaign, measurements, {.folds = 0}).influence);
}

}  // namespace
}  // namespace posewise
