#include <gtest/gtest.h>

#include "posewise/measurement/sensors.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/planning.hpp"
#include "support/cells.hpp"

namespace posewise {
namespace {

TEST(FormatChoice, SaysWhatTheValueMeansWhereItMeansMillimetres) {
    const auto value_line = [](const Plan& plan) {
        const std::string text = format_choice(plan);
        const auto begin = text.find("value: ");
        return text.substr(begin, text.find('\n', begin) - begin);
    };
    Plan plan;
    plan.request.criterion = Criterion::V;
    plan.value = 0.3766;
    EXPECT_EQ(value_line(plan), "value:      0.3766");
    plan.value_rms = 9.41e-5;
    EXPECT_EQ(value_line(plan), "value:      0.3766 (predicted 0.0941 mm RMS by the parameters)");
    plan.request.criterion = Criterion::G;
    EXPECT_EQ(value_line(plan),
              "value:      0.3766 (predicted 0.0941 mm RMS at the worst pose by the parameters)");
}

TEST(AnswersOfPlans, CompareMorePosesWithWhatIsPlannedAndNotWithWorseChoices) {
    Campaign campaign = testing::cell_campaign();
    campaign.spread.is_prior = true;
    PlanningOptions options;
    options.pose_count = 4;
    options.pool_count = 300;
    options.starts = 1;
    options.workspace_count = 20;
    const Planning planning = make_plan(campaign, options);
    const auto answer_with = [&](double of_the_plan) {
        const PredictedAccuracy planned = planning.plan.predicted.value();
        PredictedAccuracy chosen = planned;
        chosen.rms *= 10;
        PredictedAccuracy twice = planned;
        twice.rms *= of_the_plan;
        twice.left_over *= of_the_plan;
        for (const Answer& one :
             answer(planning, {{4, false, chosen}, {4, true, planned}, {8, false, twice}})) {
            if (one.key == "more") return one.text;
        }
        return std::string();
    };
    const std::string hardly = answer_with(0.9);
    EXPECT_TRUE(hardly.starts_with("more than 4")) << hardly;
    EXPECT_NE(hardly.find(": 8 new poses leave 90 % of what 4 leave; "), std::string::npos)
        << hardly;
    const std::string well = answer_with(0.7);
    EXPECT_TRUE(well.starts_with("about 3 new poses more")) << well;
}

TEST(FormatChoice, HasAsManyDigitsAsAsked) {
    Plan plan;
    plan.request.criterion = Criterion::D;
    plan.value = 1.0 / 3;
    plan.bound = 2.0 / 3;
    EXPECT_NE(format_choice(plan).find("value:      0.33333333\nbound:      0.66666667\n"),
              std::string::npos);
    EXPECT_NE(
        format_choice(plan, 12).find("value:      0.333333333333\nbound:      0.666666666667\n"),
        std::string::npos);
}

TEST(FormatDesign, ListsTheWeights) {
    ApproximateDesign design;
    design.request.criterion = Criterion::D;
    design.request.pose_count = 2;
    design.candidate_count = 40;
    design.weights = {{"a", 1}, {"b", 2.0 / 3}, {"c", 1.0 / 3}};
    design.value = 1.5;
    design.bound = 1.6;
    design.efficiency = 0.95;
    design.ending = Ending::Converged;
    EXPECT_EQ(format(design, 3),
              "weights:    of 3 of 40 candidates, for 2 poses\ncriterion:  d\nvalue:      1.5\n"
              "bound:      1.6: no choice of 2 poses has a larger value\n"
              "efficiency: 0.950000 proven, converged\n"
              "\nWeights, heaviest first\n\ncandidate  weight\n---------  ------\n"
              "a               1\nb           0.667\nc           0.333\n");
}

TEST(FormatChoice, SaysThatNoStartEndedBeforeTheStop) {
    Plan plan;
    plan.request.criterion = Criterion::D;
    plan.ending = Ending::Interrupted;
    plan.efficiency = 0.5;
    const std::string text = format_choice(plan);
    EXPECT_NE(text.find("starts:     none ended before the stop, interrupted\n"), std::string::npos)
        << text;
    EXPECT_NE(text.find("note:       the bound is loose at so few poses\n"), std::string::npos);
    plan.request.starts = 4;
    EXPECT_NE(
        format_choice(plan).find("starts:     0 of 4 ended here (found after them), interrupted\n"),
        std::string::npos);
    plan.ending = Ending::Converged;
    EXPECT_NE(format_choice(plan).find("starts:     0 of 4 ended here (found after them), too few "
                                       "to say that none is better (more: --starts)\n"),
              std::string::npos);
    plan.request.starts = 5;
    EXPECT_NE(
        format_choice(plan).find("starts:     0 of 5 ended here (found after them), converged\n"),
        std::string::npos);
}

TEST(FormatPlanning, SaysTheSameBesideTheUnit) {
    Planning planning;
    planning.plan.kind = CandidateKind::Pool;
    planning.plan.request.criterion = Criterion::V;
    planning.plan.value = 4e6;
    planning.plan.value_rms = 5e-4;
    planning.plan.predicted.emplace();
    planning.campaign.sensor =
        std::make_shared<PointSensor>(Targets({Vector3d(0, 0, 1)}), IsotropicNoise{1e-4});
    planning.campaign.has_nominal_base = planning.campaign.has_nominal_targets = true;
    EXPECT_NE(format_planning(planning).find(
                  "value:       4000000 /m^2 (predicted 0.5000 mm RMS by the parameters)\n"),
              std::string::npos)
        << format_planning(planning);
}

}  // namespace
}  // namespace posewise
