#include "program.hpp"

/// A campaign whose section `planning` states more errors than are fitted.
namespace posewise::testing {
namespace {

class PlanningSection : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        const std::string text = "name: six\nrobot:\n  errors: geometric\n" + six_joints +
                                 "base: {position_mm: [1000, 200, 30], rpy_deg: [0, 0, 90]}\n"
                                 "sensor: {kind: points, sigma_mm: 0.05, targets: "
                                 "{position_mm: [[100, 20, 30], [-50, 80, 40], [10, -90, 60]]}}\n";
        write_text("fitted.yaml", text);
        write_text("c.yaml", text + "planning: {errors: full}\n");
    }
    int least(const std::string& campaign) const {
        return static_cast<int>(
            number_behind(run_well("inspect " + campaign), "least number of poses:"));
    }
};

TEST_F(PlanningSection, AsksForAsManyPosesAsTheFittedModelNeeds) {
    const int needed = least("fitted.yaml");
    EXPECT_EQ(least("c.yaml"), needed);
    const std::string fewer = std::to_string(needed - 1);
    const std::string words = "--poses is " + fewer + ", must be at least " +
                              std::to_string(needed) +
                              ": fewer do not identify the errors that calibrate fits";
    const std::string plan = "plan c.yaml --pool 300 --workspace-poses 50 ";
    const std::string select = "select c.yaml --random 40 --starts 1 -o p.json ";
    expect_input_error(select + "-k " + fewer, words);
    expect_input_error(plan + "-o p.json -k " + fewer, words);
    run_well(select + "--prior -k " + fewer);  // calibrate --prior does with them

    run_well(plan + "-o p.json -k " + std::to_string(needed));
    run_well("verify p.json");
    // The least number alone hardly determines what is fitted: the plan is of all errors' sizes.
    run_well(plan + "-o p.json --csv p.csv -k " + std::to_string(needed + 2));
    run_well("simulate c.yaml --configurations p.csv -o m.csv");
    const Outcome outcome = run("calibrate c.yaml -m m.csv --folds 0");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(PlanningSection, IsSaidWhereItIsUsedAndWhereNot) {
    run_well("simulate c.yaml --poses 20 -o m.csv");
    // Of a robot that has more errors than are fitted there may be doubts.
    const auto run_in_doubt = [&](const std::string& command) {
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return outcome.out;
    };
    const std::string used = run_in_doubt("select c.yaml -m m.csv -k 8 --starts 1 -o p.json");
    EXPECT_NE(used.find("\nerrors: full, as planning.errors says: the accuracy predicted is that "
                        "of a calibration that fits these, calibrate fits those of "
                        "robot.errors\n"),
              std::string::npos)
        << used;
    for (const std::string command : {"inspect c.yaml", "indices c.yaml -m m.csv",
                                      "study c.yaml -m m.csv --random 2 --splits 0 --poses 8"}) {
        EXPECT_NE(
            run_in_doubt(command).find("\nplanning.errors, full, is for select and plan, and not "
                                       "used here\n"),
            std::string::npos)
            << command;
    }
    EXPECT_EQ(run_well("inspect fitted.yaml").find("planning"), std::string::npos);
}

}  // namespace
}  // namespace posewise::testing
