#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
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

    Campaign expected_;
    Measurements measured_;
    Parameters start_;
};

TEST_F(LearnSizes, FindsThoseThatTheTruthWasDrawnWith) {
    const ParameterSpread learned = learn_sizes(expected_, measured_, start_);
    EXPECT_NEAR(learned.angle, 0.2e-3, 0.15e-3);
    EXPECT_NEAR(learned.gravity, 3e-3, 1e-3);
    EXPECT_NEAR(learned.harmonic, 0.6e-3, 0.2e-3);
    EXPECT_TRUE(learned.is_prior);
}

TEST_F(LearnSizes, LeavesThoseStatedByName) {
    expected_.spread.by_name["q2.sin(q2)"] = 5e-3;
    const ParameterSpread learned = learn_sizes(expected_, measured_, start_);
    EXPECT_EQ(learned.by_name, expected_.spread.by_name);
    EXPECT_NEAR(learned.harmonic, 0.6e-3, 0.2e-3);
}

TEST_F(LearnSizes, KeepsWhatIsExpectedWhereNothingTells) {
    const Chain robot = keep_parameters(expected_.robot, {});
    const Campaign without = with_robot(expected_, robot);
    Parameters start = start_;
    start.robot.resize(0);
    const ParameterSpread learned = learn_sizes(without, measured_, start);
    EXPECT_EQ(learned.harmonic, expected_.spread.harmonic);
    EXPECT_EQ(learned.length, expected_.spread.length);
}

TEST_F(LearnSizes, AreDoubtedWhereTheyHoldTheirErrorsBack) {
    const auto find_doubt = [&] {
        Campaign learned = expected_;
        learned.spread = learn_sizes(expected_, measured_, start_);
        return find_held_back_size(learned, expected_.spread, measured_, start_);
    };
    EXPECT_FALSE(find_doubt());
    expected_.spread.offset = 0.1e-3;
    const auto doubt = find_doubt();
    ASSERT_TRUE(doubt);
    EXPECT_EQ(doubt->held.key, "offset");
    EXPECT_LT(doubt->held.size, 1e-3);
    EXPECT_NEAR(doubt->fitting, 20e-3, 10e-3);
}

TEST_F(LearnSizes, NeedsPriors) {
    expected_.spread.is_prior = false;
    EXPECT_THROW(learn_sizes(expected_, measured_, start_), InputError);
}

}  // namespace
}  // namespace posewise
