#include "posewise/task/doubts.hpp"

#include <gtest/gtest.h>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/simulation.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

Campaign tracked_fanuc() { return testing::tracked_campaign(testing::fanuc()); }

Measurements measure(const Campaign& campaign) {
    return simulate(campaign, {.pose_count = 20}).measurements;
}

std::optional<Misfit> misfit_of(const Campaign& campaign, const Measurements& measurements) {
    return find_misfit(campaign, measurements,
                       register_base_and_targets(campaign, measurements).parameters);
}

TEST(FindMisfit, IsNothingForTheRobotsOwnMeasurements) {
    const Campaign campaign = tracked_fanuc();
    const Measurements measurements = measure(campaign);
    EXPECT_FALSE(misfit_of(campaign, measurements));
    EXPECT_NO_THROW(check_is_of_robot(campaign, measurements,
                                      register_base_and_targets(campaign, measurements)));
}

TEST(FindMisfit, NamesTheUnitThatIsWrong) {
    const Campaign campaign = tracked_fanuc();
    const Measurements right = measure(campaign);
    Measurements wrong = right;
    wrong.configurations *= 180 / 3.14159265358979;
    EXPECT_EQ(misfit_of(campaign, wrong)->unit, UnitDoubt::JointsInDegrees);
    wrong = right;
    wrong.observations *= 1000;
    const auto misfit = misfit_of(campaign, wrong);
    EXPECT_EQ(misfit->unit, UnitDoubt::PointsInMillimetres);
    EXPECT_GT(misfit->distance, 10 * misfit->expected);
    const std::string words = describe_misfit(campaign, *misfit);
    EXPECT_NE(words.find("are points in mm where the file says m?"), std::string::npos) << words;
    EXPECT_THROW(check_is_of_robot(campaign, wrong, register_base_and_targets(campaign, wrong)),
                 InputError);
}

TEST(CheckIsOfRobot, CannotTellWithTooFewMeasurements) {
    const Campaign campaign = tracked_fanuc();
    Measurements one = take(measure(campaign), {0});
    one.observations *= 1000;
    const Registration registration = register_base_and_targets(campaign, one);
    EXPECT_FALSE(registration.is_determined());
    EXPECT_NO_THROW(check_is_of_robot(campaign, one, registration));
}

TEST(FindBeyondLimits, CountsConfigurationsAndNamesTheFirst) {
    const Campaign campaign = tracked_fanuc();
    Measurements measurements = measure(campaign);
    EXPECT_FALSE(find_beyond_limits(campaign, measurements.configurations));
    measurements.configurations(3, 1) = measurements.configurations(7, 0) = 10;
    const auto beyond = find_beyond_limits(campaign, measurements.configurations);
    EXPECT_EQ(beyond->count, 2);
    EXPECT_EQ(beyond->first, 3);
    EXPECT_EQ(beyond->violation.find(campaign.robot.joint(1).name), 0U) << beyond->violation;
}

TEST(AddDoubts, JudgesSizesAndResiduals) {
    const Campaign campaign = tracked_fanuc();
    const Measurements measurements = measure(campaign);
    Estimate estimate = identify(campaign, measurements,
                                 register_base_and_targets(campaign, measurements).parameters);
    Doubts doubts;
    add_doubts(campaign, estimate, doubts);
    EXPECT_TRUE(doubts.sizes.empty());
    EXPECT_FALSE(doubts.residual_ratio);
    EXPECT_TRUE(doubts.negative_compliances.empty());

    const VectorXd scale = parameter_scale(campaign);
    estimate.parameters.robot[2] = 25 * scale[6 + 2];
    estimate.variance_factor = 9;
    add_doubts(campaign, estimate, doubts);
    ASSERT_EQ(doubts.sizes.size(), 1U);
    EXPECT_EQ(doubts.sizes[0].parameter, campaign.robot.parameter_names()[2]);
    EXPECT_NEAR(doubts.sizes[0].times, 25, 1e-9);
    EXPECT_EQ(doubts.residual_ratio, 3);
}

}  // namespace
}  // namespace posewise
