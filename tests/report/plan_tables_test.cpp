#include <gtest/gtest.h>

#include "posewise/report/reports.hpp"

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

TEST(FormatChoice, SaysThatNoStartEndedBeforeTheStop) {
    Plan plan;
    plan.ending = Ending::Interrupted;
    plan.efficiency = 0.5;
    const std::string text = format_choice(plan);
    EXPECT_NE(text.find("starts:     none ended before the stop, interrupted\n"), std::string::npos)
        << text;
    EXPECT_NE(text.find("note:       the bound is loose at so few poses\n"), std::string::npos);
    plan.request.starts = 4;
    EXPECT_NE(format_choice(plan).find("starts:     0 of 4 ended here, interrupted\n"),
              std::string::npos);
}

TEST(FormatPlanning, SaysTheSameBesideTheUnit) {
    Planning planning;
    planning.plan.kind = CandidateKind::Pool;
    planning.plan.request.criterion = Criterion::V;
    planning.plan.value = 4e6;
    planning.plan.value_rms = 5e-4;
    planning.plan.predicted.emplace();
    planning.campaign.has_nominal_base = planning.campaign.has_nominal_targets = true;
    EXPECT_NE(format_planning(planning).find(
                  "value:       4000000 /m^2 (predicted 0.5000 mm RMS by the parameters)\n"),
              std::string::npos)
        << format_planning(planning);
}

}  // namespace
}  // namespace posewise
