#include <nlohmann/json.hpp>

#include "program.hpp"

/// Plain blocks, anybody's Jacobians, in every command that takes them.
namespace posewise::testing {
namespace {

class PlainBlocks : public Program {
  protected:
    /// 30 candidates of 2 rows and 4 columns; the first column is 1 and 0 in turn.
    void SetUp() override {
        Program::SetUp();
        std::string text;
        for (int row = 0; row < 60; ++row) {
            text += std::to_string(row % 2) + ' ' + std::to_string(0.1 * (row * 37 % 41) - 1.97) +
                    ' ' + std::to_string(0.01 * (row * 17 % 43) - 0.213) + ' ' +
                    std::to_string(row * row * 29 % 47 - 23.5) + '\n';
        }
        write_text("b.txt", "# made up\n" + text);
        run_well("indices --blocks b.txt --rows 2 --write-blocks b.npy");
        run_well("indices --blocks b.txt --rows 2 --write-blocks b.npz");
    }

    const std::string size_ = "30 candidates, 2 rows, 4 parameters\n";
};

TEST_F(PlainBlocks, AreTheSameFromEveryFile) {
    const std::string text = run_well("select --blocks b.txt --rows 2 -k 6 -o p.json");
    EXPECT_EQ(text.rfind(size_, 0), 0U) << text;
    for (const std::string input :
         {"b.npy", "b.npz", "b.npz --variable blocks", "b.npy --rows 2"}) {
        EXPECT_EQ(run_well("select --blocks " + input + " -k 6 -o p.json"), text) << input;
    }
    EXPECT_EQ(run_well("verify p.json").rfind(size_, 0), 0U);
    run_well("verify p.json --blocks b.npz");
    EXPECT_EQ(run_well("select --blocks b.npy -k 6 --relax").rfind(size_, 0), 0U);
    EXPECT_EQ(run_well("indices --blocks b.npy").rfind(size_, 0), 0U);
    EXPECT_EQ(run_well("study --blocks b.npy -k 6 --random 5").rfind(size_, 0), 0U);
}

TEST_F(PlainBlocks, AreRefusedWithOtherRowsThanTheirArrayHas) {
    expect_input_error("select --blocks b.npy --rows 3 -k 6",
                       "b.npy: is 30 x 2 x 4, so a candidate has 2 rows; --rows is 3");
    expect_input_error("study --blocks b.txt --rows 7 -k 6", "not a multiple of 7");
    const Outcome outcome = run("select --blocks b.txt --rows 3 -k 6");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.err.find("the zeros of the matrix come again every 2 rows"),
              std::string::npos)
        << outcome.err;
}

TEST_F(PlainBlocks, HaveAStudyOfEachNumberOfPoses) {
    write_text("own.txt", "3\n4\n5\n6\n7\n8\n");
    const std::string study =
        "study --blocks b.npy -k 3..5 -c d,a --random 30 --subset own.txt --subset p.json ";
    run_well("select --blocks b.npy -k 4 -c a -o p.json");
    run_well(study + "--csv s.csv");
    const auto document = nlohmann::json::parse(run_well(study + "--json"));
    ASSERT_EQ(document.at("rows").size(), 8U);  // 3, 4, 5 and own.txt's 6
    for (const auto& row : document.at("rows")) {
        const std::string criterion = row.at("criterion");
        const std::string count = std::to_string(row.at("pose_count").get<int>());
        const auto plan = nlohmann::json::parse(
            run_well("select --blocks b.npy -o q.json --json -k " + count + " -c " + criterion));
        EXPECT_EQ(row.at("value"), plan.at("value"));
        EXPECT_EQ(row.at("bound"), plan.at("bound"));
        for (const auto& own : row.at("subsets")) {
            const auto rated = nlohmann::json::parse(run_well(
                "indices --blocks b.npy --json --subset " + own.at("name").get<std::string>()));
            EXPECT_EQ(own.at("value"), rated.at("scaled").at(criterion));
            if (own.at("name") == "p.json" && criterion == "a") {
                EXPECT_EQ(own.at("value"), row.at("value"));
            }
        }
    }
    const std::string csv = text_of("s.csv");
    EXPECT_EQ(
        csv.rfind("poses,criterion,chosen_by,value,bound,efficiency,candidates\n3,d,best,", 0), 0U);
    EXPECT_NE(csv.find("\n6,a,own.txt,"), std::string::npos);
    EXPECT_NE(csv.find(",3 4 5 6 7 8\n"), std::string::npos);
}

TEST_F(PlainBlocks, StudyIsDrawn) {
    run_well("study --blocks b.npy -k 3..5 -c d,a --random 9 --plot s.svg");
    EXPECT_NE(text_of("s.svg").find("proven bound"), std::string::npos);
}

TEST_F(PlainBlocks, StudyHasAPage) {
    const std::string text = run_well("study --blocks b.npy -k 3..5 --random 9 --report s.html");
    EXPECT_NE(text.find("of 30 candidates reach"), std::string::npos) << text;
    const std::string page = text_of("s.html");
    EXPECT_NE(page.find("\"kind\":\"posewise blocks study\""), std::string::npos);
    EXPECT_NE(page.find("How much they tell"), std::string::npos);
}

TEST_F(PlainBlocks, NeedNoRobotsOptions) {
    for (const auto& [arguments, words] : std::vector<std::pair<std::string, std::string>>{
             {"study --blocks b.npy", "--poses: is required with --blocks"},
             {"study --blocks b.npy -k 4 --splits 2",
              "--splits: is not of a study of plain blocks"},
             {"study --blocks b.txt -k 4", "--rows: is required with --blocks"},
             {"study a.yaml --simulate --rows 3", "--rows: goes with --blocks only"},
             {"study a.yaml --simulate --subset s.txt", "--subset requires --blocks"},
             {"indices --blocks b.npy -m m.csv", "--measurements: is not of plain blocks"},
             {"indices -m m.csv", "CAMPAIGN is required"},
             {"indices a.yaml", "--measurements is required"}}) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << arguments << ": " << outcome.err;
    }
    expect_input_error("indices --blocks b.npy --write-blocks ./b.npy", "b.npy");
    expect_input_error("indices --blocks b.npy --write-blocks b.mat",
                       "must end in .npy, .npz or .csv");
    write_text("own.txt", "30\n");
    expect_input_error("study --blocks b.npy --subset own.txt",
                       "own.txt: names candidate 30; must be from 0 to 29");
}

}  // namespace
}  // namespace posewise::testing
