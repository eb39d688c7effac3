#include "../../src/task/doubt/held_out_doubt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../src/task/calibration/expected_distance.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "support/campaigns.hpp"

/// What data say against a calibration: what is refused, what only doubted, what cures it.
namespace posewise {
namespace {

/// A robot with all geometric errors that can be told apart, and its model error.
Campaign geometric_fanuc() {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    return with_robot(campaign, irreducible_model(with_robot(campaign, testing::fanuc())));
}

Measurements measure(const Campaign& campaign, Index count = 24) {
    return simulate(campaign, {.pose_count = count, .repeats = 2, .truth_seed = 11}).measurements;
}

bool holds(const std::vector<std::string>& texts, const std::string& words) {
    for (const std::string& text : texts) {
        if (text.find(words) != std::string::npos) return true;
    }
    return false;
}

TEST(RankDeviations, AreThoseOfSignedRanks) {
    VectorXd before = VectorXd::Ones(10);
    VectorXd after(10);
    for (Index i = 0; i < 10; ++i) after[i] = 1.1 + 0.1 * static_cast<double>(i);
    Index count = 0;
    EXPECT_NEAR(detail::rank_deviations(after, before, &count), 55 / std::sqrt(385.0), 1e-12);
    EXPECT_EQ(count, 10);
    EXPECT_NEAR(detail::rank_deviations(before, after), -55 / std::sqrt(385.0), 1e-12);
    after[9] = 1e9;  // one gross error counts no more than any rank
    EXPECT_NEAR(detail::rank_deviations(after, before), 55 / std::sqrt(385.0), 1e-12);
    after[0] = before[1] = 0;  // not held out
    detail::rank_deviations(after, before, &count);
    EXPECT_EQ(count, 8);
    EXPECT_EQ(detail::rank_deviations(before, before), 0);
}

TEST(HeldOutComparison, OfFewConfigurationsShowsNothing) {
    EXPECT_TRUE((HeldOutComparison{1, 1, 0, 5}.is_no_better()));
    EXPECT_FALSE((HeldOutComparison{1, 1, 0, 4}.is_no_better()));
    EXPECT_FALSE((HeldOutComparison{1, 1, 2.5, 9}.is_worse()));
    EXPECT_TRUE((HeldOutComparison{1, 1, 2.6, 9}.is_worse()));
}

TEST(Calibrate, OfGoodDataHasNoFaultAndTriesNothing) {
    const Campaign campaign = geometric_fanuc();
    for (const Index folds : {0, 5, 24}) {
        const Calibration found = calibrate(campaign, measure(campaign), {.folds = folds});
        EXPECT_TRUE(found.faults.empty()) << found.faults.front();
        EXPECT_FALSE(found.doubts.held_out);
        EXPECT_TRUE(found.cures.found.empty() && found.cures.without_effect.empty());
    }
}

TEST(Calibrate, NamesTheConfigurationThatSpoilsItAndWhatIsLeftWithoutIt) {
    const Campaign campaign = geometric_fanuc();
    Measurements measured = measure(campaign);
    measured.configurations(5, 2) += 0.0872664626;
    for (const Index folds : {0, 24}) {
        const Calibration found = calibrate(campaign, measured, {.folds = folds});
        ASSERT_FALSE(found.faults.empty());
        EXPECT_EQ(found.faults.front().find("without configuration '" + measured.ids[5] +
                                            "' it leaves 0."),
                  0U)
            << found.faults.front();
        const auto cure =
            std::ranges::find(found.cures.found, exclusion({measured.ids[5]}), &Cure::remedy);
        ASSERT_NE(cure, found.cures.found.end());
        EXPECT_LT(cure->after, 0.4e-3);
        EXPECT_GT(cure->before, 10e-3);
    }
}

TEST(Calibrate, RefusesWhatPredictsNoBetterThanTheNominalRobotAndMisfits) {
    const Campaign campaign = geometric_fanuc();
    Measurements measured = measure(campaign);
    RandomStream noise(6);
    for (Index i = 0; i < measured.configurations.size(); ++i) {
        measured.configurations.data()[i] += 5e-3 * noise.normal();
    }
    const Calibration found = calibrate(campaign, measured);
    EXPECT_TRUE(found.doubts.held_out);
    EXPECT_TRUE(holds(found.faults, "by the nominal robot by")) << found.faults.size();
}

TEST(Calibrate, RefusesAJointOffsetBeyondTenDegrees) {
    const Campaign campaign = geometric_fanuc();
    const Measurements right = measure(campaign);
    Campaign rough = campaign;
    rough.spread.angle = 0.05;
    for (const double degrees : {8.0, 12.0}) {
        Measurements measured = right;
        measured.configurations.col(1).array() += degrees * std::numbers::pi / 180;
        EXPECT_EQ(holds(calibrate(rough, measured, {.folds = 0}).faults, "dq2 is "), false);
        rough.spread.angle = 0.02;  // five times: 5.7 deg
        EXPECT_EQ(holds(calibrate(rough, measured, {.folds = 0}).faults, "dq2 is "), degrees > 10);
        rough.spread.angle = 0.05;  // 14.3 deg
    }
}

TEST(LargestLeftOver, IsWhatARobotIsExpectedToMissBeforeItIsCalibrated) {
    const Campaign campaign = geometric_fanuc();
    const Measurements measured = measure(campaign);
    const double most = detail::largest_left_over(campaign, campaign.nominal, measured, false);
    EXPECT_GT(most, 1e-3);
    EXPECT_LT(most, 20e-3);
    // Whatever is identified of it, it has all errors.
    const Campaign poor = with_robot(campaign, without_parameters(campaign.robot));
    EXPECT_NEAR(detail::largest_left_over(poor, campaign.nominal, measured, false), most,
                0.2 * most);
}

TEST(ExpectedDistance, HoldsTheInstrumentsNoise) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.spread.length = campaign.spread.angle = 1e-6;
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 2e-3);
    const Measurements measured = simulate(campaign, {.pose_count = 30}).measurements;
    EXPECT_NEAR(detail::expected_distance(campaign, measured), std::sqrt(3) * 2e-3, 1e-3);
    EXPECT_FALSE(
        find_misfit(campaign, measured, register_base_and_targets(campaign, measured).parameters));
}

}  // namespace
}  // namespace posewise
