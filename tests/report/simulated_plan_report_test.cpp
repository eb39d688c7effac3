#include <gtest/gtest.h>

#include <limits>

#include "posewise/report/reports.hpp"

namespace posewise {
namespace {

SimulatedPlan found_by_simulation() {
    SimulatedPlan simulated;
    simulated.assurance = 0.9;
    simulated.expected = {2e-4, 2.1234e-4, 3e-7};
    simulated.lower = {1e-4, 1.1e-4, 1e-6};
    simulated.upper = {5e-4, 5.4321e-4, 1.1e-5};
    simulated.assured = {4e-4, 4.4e-4, 1e-5};
    simulated.robot_count = 1000;
    simulated.expected_count = 250;
    simulated.deviation = 1.234e-4;
    simulated.tolerance = 5e-5;
    simulated.digits = 1;
    simulated.ending = Ending::Converged;
    return simulated;
}

TEST(SimulatedPlanReport, HasTheDigitsThatAreSure) {
    SimulatedPlan simulated = found_by_simulation();
    std::string text = format(simulated);
    for (const char* const words :
         {"expected            0.2000          0.2123      0.0006\n",
          "95 % below          0.5000            0.54       0.022\n", "\n90 % below ",
          "1000 robots and 250 of expected sizes; sure as asked, 1 digit of 0.12 mm"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words << '\n' << text;
    }
    EXPECT_EQ(text.find("could not be"), std::string::npos) << text;
    simulated.uncalibrated_count = 70;
    simulated.upper.found = simulated.upper.uncertainty = std::numeric_limits<double>::infinity();
    simulated.ending = Ending::TimeLimit;
    text = format(simulated);
    for (const char* const words :
         {"95 % below          0.5000               -           -\n", "stopped (time limit)",
          "70 robots could not be calibrated, and count as the worst\n"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words << '\n' << text;
    }
    simulated.robot_count = 0;
    EXPECT_NE(format(simulated).find("before the first"), std::string::npos);
}

TEST(SimulatedPlanReport, SaysWhetherALimitIsKept) {
    const SimulatedPlan simulated = found_by_simulation();
    TargetPlanning found;
    TargetOptions& target = found.target;
    target.assurance = 0.9;
    EXPECT_EQ(describe_verified(found, simulated), "");
    target.limit = 4.1e-4;
    EXPECT_EQ(describe_verified(found, std::nullopt), "");
    EXPECT_EQ(describe_verified(found, simulated),
              "verified:    THE LIMIT OF 0.41 mm IS NOT KEPT: 0.44 mm (sure to 0.02) with 90 %, of "
              "1000 robots and 250 of expected sizes; plan with --target-mm 0.373\n");
    SimulatedPlan failed = simulated;
    failed.uncalibrated_count = 130;
    failed.assured.found = failed.assured.uncertainty = std::numeric_limits<double>::infinity();
    EXPECT_EQ(
        describe_verified(found, failed),
        "verified:    THE LIMIT OF 0.41 mm IS NOT KEPT: 130 of 1000 robots and 250 of expected "
        "sizes could not be calibrated; plan more poses\n");
    target.limit = 4.5e-4;
    EXPECT_EQ(describe_verified(found, simulated).rfind("verified:    too close to 0.45 mm", 0),
              0u);
    target.limit = 5e-4;
    EXPECT_EQ(describe_verified(found, simulated).rfind("verified:    the limit is kept: ", 0), 0u);
    // Simulated robots have the errors that are fitted, and no others.
    found.planning.emplace().left_out.emplace();
    EXPECT_EQ(
        describe_verified(found, simulated)
            .rfind("verified:    the limit is kept, if the robot has no errors but those that "
                   "are fitted: ",
                   0),
        0u);
}

}  // namespace
}  // namespace posewise
