#include <nlohmann/json.hpp>

#include "program.hpp"

/// inspect --measurements: which joints the campaign file has reversed.
namespace posewise::testing {
namespace {

class Directions : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        design_ = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    }
    void replace(const std::string& part, const std::string& by) {
        ASSERT_NE(design_.find(part), std::string::npos) << part;
        design_.replace(design_.find(part), part.size(), by);
    }
    std::string design_;
};

TEST_F(Directions, AsStatedAreOneLine) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    const std::string text = run_well("inspect " + fanuc_design + " -m m.csv");
    EXPECT_NE(text.find("joint directions: as stated; the registered robot misses the points by"),
              std::string::npos)
        << text;
    EXPECT_EQ(text.find("Joint directions that fit best"), std::string::npos);
}

TEST_F(Directions, ThatAreReversedAreNamed) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    replace("Ry q2", "Ry -q2");
    replace("Rx -q6", "Rx q6");
    write_text("c.yaml", design_);
    const std::string text = run_well("inspect c.yaml -m m.csv");
    EXPECT_NE(text.find("joint directions: reversed are q2, q6; write each with the opposite sign"),
              std::string::npos)
        << text;
    EXPECT_GT(number_behind(text, "as stated:"), 10 * number_behind(text, "q2, q6"));
}

TEST_F(Directions, ThatAreReversedAreNamedWhereNothingElseExplainsTheMisfit) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    replace("Ry q2", "Ry -q2");
    write_text("c.yaml", design_);
    const std::string words = "They fit clearly better with q2 reversed, see inspect";
    const Outcome calibrated = run("calibrate c.yaml -m m.csv -o e.json");
    EXPECT_EQ(calibrated.code, 3);
    EXPECT_NE(calibrated.err.find(words), std::string::npos) << calibrated.err;
    expect_input_error("select c.yaml -m m.csv -k 20", words);
    const auto json = nlohmann::json::parse(run("calibrate c.yaml -m m.csv --force --json").out);
    EXPECT_EQ(json["doubts"]["misfit"]["reversed"], nlohmann::json::array({"q2"}));
    replace("Tx 1280 mm", "Tx 200 mm");
    replace("Ry -q2", "Ry q2 + 70 deg");
    write_text("c.yaml", design_);
    const Outcome wrong = run("calibrate c.yaml -m m.csv");
    EXPECT_NE(wrong.err.find("another robot?"), std::string::npos) << wrong.err;
    EXPECT_EQ(wrong.err.find("reversed"), std::string::npos) << wrong.err;
}

TEST_F(Directions, OfAWristAreNamedThoughItIsLittleOff) {
    std::string robot = read_text(source_folder() + "/designs/abb_irb120/planning.yaml");
    robot.replace(robot.find("{count: 3}"), 10,
                  "{position_mm: [[80, 0, 30], [20, 70, 10], [20, -60, -50]]}\n"
                  "base: {position_mm: [2000, 300, -400], rpy_deg: [0, 0, 90]}");
    write_text("c.yaml", robot);
    run_well("simulate c.yaml --poses 40 --truth 3 -o m.csv");
    EXPECT_EQ(run("calibrate c.yaml -m m.csv --folds 0").code, 0);
    robot.replace(robot.find("Rx q6"), 5, "Rx -q6");
    write_text("r.yaml", robot);
    const std::string words = "They fit clearly better with q6 reversed, see inspect";
    const Outcome outcome = run("calibrate r.yaml -m m.csv --folds 0 -o e.json");
    EXPECT_EQ(outcome.code, 3) << "even with the model error found";
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("times what sigma and model error say"), std::string::npos);
    expect_input_error("select r.yaml -m m.csv -k 10", words);
}

TEST_F(Directions, OfAWrongRobotAreNotGuessed) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    replace("Tx 1280 mm", "Tx 200 mm");
    replace("Ry q2", "Ry q2 + 70 deg");
    write_text("c.yaml", design_);
    const std::string text = run_well("inspect c.yaml -m m.csv");
    EXPECT_EQ(text.find("reversed are"), std::string::npos) << text;
}

TEST_F(Directions, OfThePublishedCampaignFitTenTimesBetterThanAnyOther) {
    const std::string csv = real_data() + "/fanuc_r2000ic_165f/measurements.csv";
    if (!std::filesystem::exists(csv)) {
        GTEST_SKIP() << "no real campaign at POSEWISE_REAL_DATA = " << real_data();
    }
    replace("Rx -q4", "Rx q4");
    write_text("c.yaml", design_);
    const std::string text = run_well("inspect c.yaml -m '" + csv + "'");
    EXPECT_NE(text.find("reversed are q4;"), std::string::npos) << text;
    const std::string table = text.substr(text.find("Joint directions that fit best"));
    EXPECT_NEAR(number_behind(table, "q4 "), 0.615, 0.001);
    EXPECT_NEAR(number_behind(table, "q4, q6 "), 50.15, 0.01);
}

TEST_F(Directions, NeedACampaignAndMeasurements) {
    expect_input_error(
        "inspect robot.urdf -m m.csv",
        "robot.urdf: is a robot alone; --measurements and --from need a campaign file");
    expect_input_error("inspect " + fanuc_design + " -m absent.csv", "absent.csv");
}

}  // namespace
}  // namespace posewise::testing
