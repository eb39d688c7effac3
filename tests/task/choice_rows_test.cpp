#include <gtest/gtest.h>

#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/planning.hpp"
#include "support/campaigns.hpp"
#include "support/ill_conditioned.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

/// What is chosen, planned and verified where rows are few or nearly dependent.
namespace posewise {
namespace {

/// A robot whose tool has one target: 6 of the base, 18 of the robot, 3 of the target.
Campaign campaign_of_one_target() {
    Campaign campaign = testing::tracked_campaign(testing::ur_type());
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>{std::nullopt}, 5e-5);
    campaign.nominal.sensor.conservativeResize(3);
    return campaign;
}

std::string refusal_of(const Campaign& campaign, const Candidates& candidates,
                       const ChoiceOptions& options) {
    return testing::input_error_of([&] { choose(campaign, candidates, options); });
}

TEST(ChooseByRows, VerifiesEveryFreshPlanHoweverNearlyDependentTheParametersAre) {
    const Index problems = std::max<Index>(5, testing::sweep_count() / 100);
    for (Index k = 0; k < problems; ++k) {
        RandomStream random(static_cast<std::uint64_t>(k), 3);
        const Index L = 3 + random.index(5);
        const double condition = std::pow(10.0, random.uniform(0, 8));
        const Blocks candidates =
            test::ill_conditioned_blocks(20, 2, L, condition, static_cast<std::uint64_t>(k));
        for (const Criterion criterion : all_criteria) {
            ChoiceOptions options;
            options.criterion = criterion;
            options.pose_count = L / 2 + 1 + random.index(3);
            options.starts = 2;
            options.has_prior = random.index(4) == 0;
            options.repeat_limit = 1 + random.index(2);
            SCOPED_TRACE(::testing::Message()
                         << "problem " << k << ", criterion " << criterion_name(criterion)
                         << ", condition " << condition);
            const Plan plan = choose(candidates, options);
            EXPECT_TRUE(std::isfinite(plan.value));
            const Verification verification = verify(plan, candidates, options);
            EXPECT_TRUE(verification.is_right()) << ::testing::PrintToString(verification.wrong());
        }
    }
}

TEST(ChooseByRows, RefusesFewerRowsThanParametersByEveryWay) {
    const Campaign campaign = campaign_of_one_target();
    const Index L = parameter_count(campaign);
    const Index enough = (L + 2) / 3;
    const Candidates candidates = random_candidates(campaign, 200, 1);
    for (const Criterion criterion : all_criteria) {
        ChoiceOptions options;
        options.criterion = criterion;
        options.pose_count = enough - 1;
        options.starts = 1;
        const std::string words = refusal_of(campaign, candidates, options);
        const std::string rule = "must be at least " + std::to_string(enough);
        EXPECT_NE(words.find(rule), std::string::npos) << words;
        EXPECT_EQ(testing::input_error_of([&] { relax_choice(campaign, candidates, options); }),
                  words);
    }
    ChoiceOptions options;
    options.criterion = Criterion::V;
    options.pose_count = enough;
    options.starts = 1;
    const Plan plan = choose(campaign, candidates, options);
    EXPECT_TRUE(std::isfinite(plan.value));
    EXPECT_TRUE(verify(plan, campaign, candidates, options).is_right());
}

TEST(ChooseByRows, FindsAPlanWrongWhosePosesDoNotIdentifyTheParameters) {
    const Blocks candidates = test::random_blocks(13, 3, 7, 1);
    ChoiceOptions options;
    options.pose_count = 3;
    Plan plan = choose(candidates, options);
    plan.poses.pop_back();
    plan.request.pose_count = options.pose_count = 2;
    plan.value = -std::numeric_limits<double>::infinity();
    plan.efficiency = 0;
    const Verification verification = verify(plan, candidates, options);
    EXPECT_FALSE(verification.is_right());
    const std::vector<std::string> wrong = verification.wrong();
    EXPECT_NE(std::find(wrong.begin(), wrong.end(), "value"), wrong.end());
}

}  // namespace
}  // namespace posewise
