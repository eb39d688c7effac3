#include <fmt/format.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "program.hpp"

/// inspect --measurements, and calibrate where nothing fits: which joints the campaign file has
/// reversed, and how else the measurements may be meant.
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
    static constexpr std::size_t q2 = 3, q3 = 4, first_point = 8;  // columns

    /// m.csv with its rows changed.
    void write_changed(const std::string& name,
                       const std::function<void(std::vector<double>& row)>& change) const {
        std::istringstream lines(text_of("m.csv"));
        std::string text;
        bool is_header = true;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] == '#') continue;
            if (is_header) {
                text += line + '\n';
                is_header = false;
                continue;
            }
            std::vector<double> row;
            std::istringstream cells(line);
            for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
            change(row);
            for (std::size_t k = 0; k < row.size(); ++k) {
                text += fmt::format("{}{:.12g}", k == 0 ? "" : ",", row[k]);
            }
            text += '\n';
        }
        write_text(name, text);
    }

    std::string design_;
};

TEST_F(Directions, AsStatedAreOneLine) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    const std::string text = run_well("inspect " + fanuc_design + " -m m.csv");
    EXPECT_NE(text.find("joint directions: as stated; the registered robot misses the points by"),
              std::string::npos)
        << text;
    EXPECT_EQ(text.find("Readings that fit best"), std::string::npos);
}

TEST_F(Directions, ThatAreReversedAreNamed) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    replace("Ry q2", "Ry -q2");
    replace("Rx -q6", "Rx q6");
    write_text("c.yaml", design_);
    const std::string text = run_well("inspect c.yaml -m m.csv");
    EXPECT_NE(text.find("they fit clearly better with q2, q6 reversed ("), std::string::npos)
        << text;
    EXPECT_GT(number_behind(text, "as stated:"), 10 * number_behind(text, "q2, q6 reversed"));
    EXPECT_NE(text.find(" mm RMS): write each with the opposite sign (-q for q)"),
              std::string::npos);
}

TEST_F(Directions, ThatAreReversedAreNamedWhereNothingElseExplainsTheMisfit) {
    run_well("simulate " + fanuc_design + " --poses 80 --truth 3 -o m.csv");
    replace("Ry q2", "Ry -q2");
    write_text("c.yaml", design_);
    const std::string words = "they fit clearly better with q2 reversed (";
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
    const std::string words = "they fit clearly better with q6 reversed";
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
    EXPECT_EQ(text.find("they fit clearly better"), std::string::npos) << text;
}

TEST_F(Directions, OfThePublishedCampaignFitTenTimesBetterThanAnyOther) {
    const std::string csv = real_data() + "/fanuc_r2000ic_165f/measurements.csv";
    if (!std::filesystem::exists(csv)) {
        GTEST_SKIP() << "no real campaign at POSEWISE_REAL_DATA = " << real_data();
    }
    replace("Rx -q4", "Rx q4");
    write_text("c.yaml", design_);
    const std::string text = run_well("inspect c.yaml -m '" + csv + "'");
    EXPECT_NE(text.find("they fit clearly better with q4 reversed (0.615 instead of "),
              std::string::npos)
        << text;
    const std::string table = text.substr(text.find("Readings that fit best"));
    EXPECT_NEAR(number_behind(table, "q4 reversed"), 0.615, 0.001);
    EXPECT_NEAR(number_behind(table, "q4, q6 reversed"), 50.15, 0.01);
}

/// As a FANUC or a palletiser shows the elbow: against the ground.
TEST_F(Directions, OfAJointThatCountsFromTheGroundAreNamedAsACoupling) {
    run_well("simulate " + fanuc_design + " --poses 40 --truth 3 -o m.csv");
    write_changed("g.csv", [](std::vector<double>& row) { row[q3] += row[q2]; });
    const std::string words = "they fit clearly better with q3 - q2 in place of q3 (";
    const std::string cure = "write q3 - q2 into the column q3";
    const std::string text = run("inspect " + fanuc_design + " -m g.csv").out;
    EXPECT_NE(text.find(words), std::string::npos) << text;
    EXPECT_NE(text.find(cure), std::string::npos) << text;
    const Outcome calibrated = run("calibrate " + fanuc_design + " -m g.csv --folds 0");
    EXPECT_EQ(calibrated.code, 3);
    EXPECT_NE(calibrated.err.find(words), std::string::npos) << calibrated.err;
    const auto json = nlohmann::json::parse(
        run("calibrate " + fanuc_design + " -m g.csv --folds 0 --force --json").out);
    const auto& reading = json["doubts"]["misfit"]["reading"];
    EXPECT_EQ(reading["read_with"], "q3 - q2 in place of q3");
    EXPECT_EQ(reading["cure"], cure);
    EXPECT_LT(reading["rms_mm"], 10);
    EXPECT_GT(reading["as_stated_rms_mm"], 100);
    // With the cure it is the file that was simulated.
    write_changed("g.csv", [](std::vector<double>&) {});
    EXPECT_EQ(run("calibrate " + fanuc_design + " -m g.csv --folds 0").code, 0);
}

TEST_F(Directions, OfPointsInFeetAndOfALeftHandedInstrumentAreAsStated) {
    run_well("simulate " + fanuc_design + " --poses 40 --truth 3 -o m.csv");
    write_changed("feet.csv", [](std::vector<double>& row) {
        for (std::size_t k = first_point; k < row.size(); ++k) row[k] /= 304.8;
    });
    const std::string feet = run("inspect " + fanuc_design + " -m feet.csv").out;
    EXPECT_NE(feet.find("they fit clearly better with points in feet where the file says mm ("),
              std::string::npos)
        << feet;
    EXPECT_NE(feet.find(": multiply them by 304.8\n"), std::string::npos) << feet;
    write_changed("left.csv", [](std::vector<double>& row) {
        for (std::size_t k = first_point + 1; k < row.size(); k += 3) row[k] *= -1;
    });
    const std::string left = run("inspect " + fanuc_design + " -m left.csv").out;
    EXPECT_NE(left.find("with the instrument's frame left-handed, or as well with q1, q4, q6 "
                        "reversed ("),
              std::string::npos)
        << left;
}

TEST_F(Directions, NeedACampaignAndMeasurements) {
    expect_input_error(
        "inspect robot.urdf -m m.csv",
        "robot.urdf: is a robot alone; --measurements and --from need a campaign file");
    expect_input_error("inspect " + fanuc_design + " -m absent.csv", "absent.csv");
}

}  // namespace
}  // namespace posewise::testing
