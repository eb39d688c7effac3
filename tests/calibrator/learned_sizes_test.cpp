#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"

// How large a robot's errors are, learned from measurements.

namespace posewise {
namespace {

class LearnSizes : public ::testing::Test {
  protected:
    LearnSizes() {
        const Chain robot = without_parameters(testing::fanuc());
        expected_ =
            with_robot(testing::tracked_campaign(testing::fanuc()), detail::full_model(robot));
        expected_.spread = population_spread(robot);
        Campaign truth = expected_;
        truth.spread.angle = 0.2e-3;
        truth.spread.gravity = 3e-3;
        truth.spread.harmonic = 0.6e-3;
        measured_ = simulate(truth, {150, 1, 3, 4}).measurements;
        start_ = register_base_and_targets(expected_, measured_).parameters;
    }

    ParameterSpread learn(const Campaign& campaign) const {
        return identify(campaign, measured_, start_).spread.value();
    }

    Campaign expected_;
    Measurements measured_;
    Parameters start_;
};

TEST_F(LearnSizes, FindsThoseThatTheTruthWasDrawnWith) {
    const ParameterSpread learned = learn(expected_);
    EXPECT_NEAR(learned.angle, 0.2e-3, 0.15e-3);
    EXPECT_NEAR(learned.gravity, 3e-3, 1e-3);
    EXPECT_NEAR(learned.harmonic, 0.6e-3, 0.2e-3);
    EXPECT_TRUE(learned.is_prior);
    EXPECT_FALSE(learned.is_open);
}

TEST_F(LearnSizes, HasThemInTheCampaignAsFound) {
    const Estimate estimate = identify(expected_, measured_, start_);
    const Campaign found = with_model_error(expected_, estimate);
    EXPECT_EQ(found.spread.gravity, estimate.spread->gravity);
    // Known by now, they are not learned again, and the parameters are those under them.
    const Estimate again = identify(found, measured_, start_);
    EXPECT_FALSE(again.spread);
    EXPECT_TRUE(again.parameters.robot.isApprox(estimate.parameters.robot, 0.02));
}

TEST_F(LearnSizes, LeavesThoseStatedByName) {
    expected_.spread.by_name["q2.sin(q2)"] = 5e-3;
    const ParameterSpread learned = learn(expected_);
    EXPECT_EQ(learned.by_name, expected_.spread.by_name);
    EXPECT_NEAR(learned.harmonic, 0.6e-3, 0.2e-3);
}

TEST_F(LearnSizes, MovesLittleWithFewPoses) {
    const std::vector<Index> few{0, 20, 40, 60, 80, 100};
    const Estimate estimate = identify(expected_, take(measured_, few), start_);
    const ParameterSpread& learned = estimate.spread.value();
    EXPECT_GT(learned.gravity, expected_.spread.gravity);
    EXPECT_LT(learned.gravity, 3e-3);
    EXPECT_GT(learned.length, expected_.spread.length / 4);
    EXPECT_LT(learned.length, expected_.spread.length * 4);
}

TEST_F(LearnSizes, FindsOneThatIsStatedFarTooSmall) {
    expected_.spread.offset = 2e-3;  // drawn with 20 mrad
    EXPECT_NEAR(learn(expected_).offset.value(), 20e-3, 10e-3);
}

TEST_F(LearnSizes, IsNotWhereSizesAreStatedOrThereIsNothingToLearn) {
    const auto learns = [&](const Campaign& campaign, const LevenbergMarquardtOptions& options) {
        Parameters start = start_;
        start.robot.setZero(campaign.robot.parameter_count());
        return identify(campaign, measured_, start, options).spread.has_value();
    };
    EXPECT_TRUE(learns(expected_, {}));
    EXPECT_FALSE(learns(with_robot(expected_, keep_parameters(expected_.robot, {})), {}));
    LevenbergMarquardtOptions options;
    options.finds_model_error = false;
    EXPECT_FALSE(learns(expected_, options));
    options = {};
    options.loss.kind = LossKind::Huber;
    EXPECT_FALSE(learns(expected_, options));
    expected_.spread.is_open = false;
    EXPECT_FALSE(learns(expected_, {}));
}

}  // namespace
}  // namespace posewise
