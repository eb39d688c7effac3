#include <algorithm>

#include "program.hpp"

namespace posewise::testing {
namespace {

class Usage : public Program {};

const std::string commands[] = {"inspect", "indices", "select", "verify",  "calibrate",
                                "export",  "correct", "study",  "simulate"};

TEST_F(Usage, VersionIsThatOfTheProject) {
    EXPECT_EQ(run_well("--version"), std::string("posewise ") + POSEWISE_VERSION + '\n');
}

TEST_F(Usage, HelpNamesEveryCommand) {
    const std::string help = run_well("--help");
    for (const auto& command : commands) {
        EXPECT_NE(help.find("\n  " + command), std::string::npos) << command;
    }
}

TEST_F(Usage, HelpOfEveryCommandHasAnExample) {
    for (const auto& command : commands) {
        const std::string help = run_well(command + " --help");
        EXPECT_NE(help.find("Example:\n  posewise " + command), std::string::npos) << help;
    }
}

TEST_F(Usage, WrongUsageExitsWithTwo) {
    for (const std::string arguments :
         {"",
          "calibrated",
          "inspect",
          "inspect a.yaml --nonsense",
          "select a.yaml -m b.csv",
          "select a.yaml -m b.csv -k 6 --criterion o6",
          "select a.yaml -m b.csv -k -1",
          "select a.yaml -m b.csv -k six",
          "select a.yaml -k 6",
          "select -m b.csv -k 6",
          "select a.yaml -m b.csv --random 9 -k 6",
          "select --blocks b.csv -k 6",
          "select a.yaml --blocks b.csv --rows 3 -k 6",
          "select a.yaml -m b.csv --rows 3 -k 6",
          "select --blocks b.csv --rows 3 -k 6 --focus robot",
          "select --blocks b.csv --rows 3 -k 6 --least-distance-deg 4",
          "select a.yaml -m b.csv -k 6 --groups g.csv",
          "select a.yaml -m b.csv -k 6 --per-group 2",
          "select a.yaml -m b.csv -k 6 --time 0",
          "select a.yaml -m b.csv -k 6 --exclude a,,b",
          "select a.yaml -m b.csv -k 6 --exclude ,",
          "select a.yaml -m b.csv -k 6 -o ''",
          "select --blocks b.csv --rows 3 -k 6 --repeats 2",
          "select --blocks b.csv --rows 3 -k 6 --variable J",
          "plan a.yaml -k 6 -o ''",
          "plan a.yaml -k 6 --workspace w.csv --workspace-poses 9",
          "plan a.yaml -k 6 --workspace w.csv --workspace-box-mm 0,0,0,1,1,1",
          "plan a.yaml --plan p.json --drop p1,",
          "verify",
          "export a.yaml b.json",
          "correct a.yaml b.json",
          "correct a.yaml b.json --poses c.csv --tool-mm 1 2",
          "correct a.yaml b.json --poses c.csv --base robot",
          "correct a.yaml b.json --poses c.csv --largest-change-deg 0",
          "calibrate a.yaml -m b.csv --method newton",
          "calibrate a.yaml -m b.csv --alpha 0",
          "calibrate a.yaml -m b.csv --alpha 0.5",
          "calibrate a.yaml -m b.csv --starts 5",
          "calibrate a.yaml -m b.csv --method two-step --angle-error-deg 9",
          "calibrate a.yaml -m b.csv --loss bisquare",
          "calibrate a.yaml -m b.csv --loss huber --method two-step",
          "calibrate a.yaml -m b.csv --loss huber --loss-width 0",
          "calibrate a.yaml -m b.csv --loss-width 2",
          "calibrate a.yaml -m b.csv --model-selection --method two-step",
          "calibrate a.yaml -m b.csv --model-selection --folds 0",
          "study a.yaml -m b.csv --poses 5-9",
          "study a.yaml -m b.csv --poses 9:5",
          "study a.yaml -m b.csv --poses ,",
          "study a.yaml -m b.csv --criteria d,q",
          "simulate a.yaml -k 5",
          "simulate a.yaml -k 5 --seed -1 --out a.csv"}) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_NE(outcome.err, "") << arguments;
    }
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(Usage, AMissingFileIsAnInputError) {
    expect_input_error("inspect absent.yaml", "absent.yaml");
    expect_input_error("calibrate " + fanuc_design + " -m absent.csv", "absent.csv");
    expect_input_error("calibrate " + fanuc_design + " -m absent.mat", "absent.mat");
}

}  // namespace
}  // namespace posewise::testing
