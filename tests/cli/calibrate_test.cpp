#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "program.hpp"

/// What calibrate says about its measurements and its model, on simulated ones with the FANUC's.
namespace posewise::testing {
namespace {

using Json = nlohmann::json;

class Calibrate : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design +
                 " --truth 7 --seed 3 --poses 30 --repeats 3 -o s.csv");
    }

    /// s.csv with target 2 of these configurations 5 mm too high, as bad.csv.
    void spoil(const std::vector<std::string>& ids) const {
        std::istringstream lines(text_of("s.csv"));
        std::string spoiled;
        std::size_t column = 0;
        for (std::string line; std::getline(lines, line);) {
            std::vector<std::string> cells;
            std::istringstream text(line);
            for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
            const auto found = std::find(cells.begin(), cells.end(), "p2_z_mm");
            if (found != cells.end()) column = static_cast<std::size_t>(found - cells.begin());
            if (column > 0 && std::find(ids.begin(), ids.end(), cells[0]) != ids.end()) {
                cells[column] = std::to_string(std::stod(cells[column]) + 5);
            }
            for (const std::string& cell : cells)
                spoiled += cell + (&cell == &cells.back() ? "\n" : ",");
        }
        ASSERT_GT(column, 0U);
        write_text("bad.csv", spoiled);
    }

    std::string design_with(const std::string& part, const std::string& by) const {
        std::string text = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
        EXPECT_NE(text.find(part), std::string::npos);
        return text.replace(text.find(part), part.size(), by);
    }

    const std::string clean_ = "calibrate " + fanuc_design + " -m s.csv ";
    const std::string bad_ = "calibrate " + fanuc_design + " -m bad.csv ";
};

TEST_F(Calibrate, ListsOutliersUnderARobustLossAndIsNotBentByThem) {
    spoil({"4", "11", "27"});
    const double clean = number_behind(run_well(clean_), "distance RMS", 4);
    const Outcome bent = run(bad_);
    EXPECT_EQ(bent.code, 0) << bent.err;
    EXPECT_GT(number_behind(bent.out, "distance RMS", 4), 3 * clean);
    EXPECT_EQ(bent.out.find("outliers\n"), std::string::npos);
    EXPECT_NE(bent.err.find("configurations 4, 11, 27 do not fit the others"), std::string::npos)
        << bent.err;
    for (const std::string loss : {"huber", "cauchy"}) {
        const std::string text = run_well(bad_ + "--loss " + loss + " --out e.json");
        EXPECT_NE(text.find("standard deviations: 3 outliers\n"), std::string::npos) << text;
        EXPECT_NEAR(number_behind(text, "11 ", 1), 5, 0.4);  // mm
        EXPECT_LT(number_behind(text, "11 ", 3), 0.1);       // weight
        EXPECT_NEAR(number_behind(text, "without them: means", 4), clean, 0.2 * clean) << text;
        const Json estimate = Json::parse(text_of("e.json"));
        EXPECT_EQ(estimate.at("loss").at("kind"), loss);
        ASSERT_EQ(estimate.at("outliers").size(), 3U);
        const Json& second = estimate.at("outliers").at(1);
        EXPECT_EQ(second.at("configuration"), "11");
        EXPECT_EQ(second.at("target"), "target2");
        EXPECT_NEAR(second.at("distance_mm").get<double>(), 5, 0.4);
        EXPECT_NEAR(estimate.at("accuracy")
                        .at("without_outliers")
                        .at("held_out_means_rms_mm")
                        .get<double>(),
                    clean, 0.2 * clean);
    }
    EXPECT_NE(run_well(clean_ + "--loss cauchy").find(": 0 outliers"), std::string::npos);
}

TEST_F(Calibrate, TakesAWidthOfTheLoss) {
    const std::string wide = run_well(clean_ + "--loss huber --loss-width 1000");
    EXPECT_EQ(number_behind(wide, "distance RMS", 1),
              number_behind(run_well(clean_), "distance RMS", 1));
    EXPECT_NE(wide.find("loss huber with width 1000 standard deviations"), std::string::npos);
}

TEST_F(Calibrate, SaysInWordsThatTheResidualsAreNotAsStated) {
    EXPECT_EQ(run_well(clean_).find("the residuals are"), std::string::npos);
    spoil({"4", "11", "27"});
    const std::string text = run(bad_).out;
    for (const char* const words :
         {"times what sigma and model error say\n", "\nwith --loss cauchy: 0."}) {
        EXPECT_NE(text.find(words), std::string::npos) << words << text;
    }
    EXPECT_EQ(run_well(bad_ + "--loss cauchy").find("the residuals are"), std::string::npos);
    write_text("wide.yaml", design_with("model_error_mm: 0.1", "model_error_mm: 1"));
    EXPECT_NE(run_well("calibrate wide.yaml -m s.csv").find("error of 0."), std::string::npos);
}

TEST_F(Calibrate, WarnsOfAJointWithTheWrongSign) {
    write_text("sign.yaml", design_with("Rx -q4 [dq4]", "Rx q4 [dq4]"));
    const Outcome outcome = run("calibrate sign.yaml -m s.csv --folds 0");
    EXPECT_EQ(outcome.code, 3);  // half a turn
    EXPECT_NE(outcome.err.find("posewise: warning: far above the expected size: "),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("dq4 ("), std::string::npos) << outcome.err;
}

TEST_F(Calibrate, RecommendsAParameterSet) {
    const std::string text = run_well(clean_ + "--model-selection --out e.json");
    const Json selection = Json::parse(text_of("e.json")).at("model_selection");
    EXPECT_EQ(selection.at("recommended"), "+ other geometric");
    EXPECT_EQ(selection.at("folds"), 30);
    ASSERT_EQ(selection.at("sets").size(), 4U);
    EXPECT_EQ(selection.at("sets").at(1).at("parameters"), (Json{"dq2", "dq3", "dq4", "dq5"}));
    EXPECT_EQ(number_behind(text, "+ joint offsets"), 19);
    // The whole set's figures are those of the calibration.
    EXPECT_EQ(number_behind(text, "+ other geometric", 1), number_behind(text, "distance RMS", 2));
    EXPECT_EQ(number_behind(text, "+ other geometric", 2), number_behind(text, "distance RMS", 4));
    EXPECT_NE(text.find("recommended, best"), std::string::npos) << text;
}

TEST_F(Calibrate, PredictsPosesThatNeedNotBeMeasured) {
    const std::string header = "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";
    write_text("q.csv", header + "a,10,20,-30,40,50,60\n\"b,c\",-20,5,10,80,-60,10\n");
    const std::string predict = "--folds 0 --predict q.csv --predict-out p.csv -o e.json";
    const std::string text = run_well(clean_ + predict);
    const double total = number_behind(text, "expected at the 2 poses to predict:");
    std::istringstream lines(text_of("p.csv"));
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "config,parameters_mm,left_over_mm,noise_mm,total_mm,p95_mm");
    double squares = 0;
    for (const std::string id : {"a", "\"b,c\""}) {
        std::getline(lines, line);
        ASSERT_EQ(line.rfind(id + ',', 0), 0U) << line;
        std::istringstream cells(line.substr(id.size() + 1));
        std::vector<double> mm;
        for (std::string cell; std::getline(cells, cell, ',');) mm.push_back(std::stod(cell));
        ASSERT_EQ(mm.size(), 5U);
        EXPECT_NEAR(std::hypot(mm[0], mm[1], mm[2]), mm[3], 2e-6);
        EXPECT_GT(mm[4], mm[3]);
        squares += mm[3] * mm[3];
    }
    EXPECT_FALSE(std::getline(lines, line));
    EXPECT_NEAR(std::sqrt(squares / 2), total, 1e-4 * total);
    const Json predicted = Json::parse(text_of("e.json")).at("accuracy").at("predicted");
    EXPECT_EQ(predicted.at("configuration_count"), 2);
    EXPECT_NEAR(predicted.at("total_mm"), total, 1e-4 * total);

    write_text("q.csv", header + "a,10,20,-30,40,50,60\nfar,-20,5,10,80,-60,2000\n");
    const Outcome beyond = run(clean_ + predict);
    EXPECT_EQ(beyond.code, 0);
    EXPECT_EQ(beyond.err.rfind("posewise: warning: q.csv: 1 of 2 configurations is beyond the "
                               "campaign's joint limits, the first is 'far': q6 is 2000 deg",
                               0),
              0U)
        << beyond.err;
    write_text("q.csv", "config,q1_deg,q2_deg\na,10,20\n");
    expect_input_error(clean_ + predict,
                       "the header must have config,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n");
    write_text("q.csv", "");
    expect_input_error(clean_ + predict, "must begin with a header like config,q1_rad,...\n");
    expect_input_error(clean_ + "--predict q.csv --predict-out q.csv", "must be another file");
    EXPECT_EQ(run(clean_ + "--predict-out p.csv").code, 2);
}

TEST_F(Calibrate, PredictsEachRowOfAProgramThatComesBackToItsPoses) {
    const std::string a = ",10,20,-30,40,50,60\n";
    write_text("q.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\nhome" + a +
                            "weld,-20,5,10,80,-60,10\nhome" + a + "end" + a);
    run_well(clean_ + "--folds 0 --predict q.csv --predict-out p.csv");
    std::istringstream lines(text_of("p.csv"));
    std::vector<std::string> rows;
    for (std::string line; std::getline(lines, line);) rows.push_back(line);
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_EQ(rows[1], rows[3]);
    EXPECT_EQ(rows[1].substr(4), rows[4].substr(3));
    EXPECT_NE(rows[1].substr(4), rows[2].substr(4));
    // Of a file of samples a pose is a configuration, as everywhere.
    EXPECT_NE(run_well(clean_ + "--folds 0 --predict s.csv").find("at the 30 poses to predict"),
              std::string::npos);
}

TEST_F(Calibrate, RecordsWhichSizesWereLearned) {
    const std::string calibrate = clean_ + "--folds 0 --prior -o e.json ";
    run_well(calibrate + "--sizes stated");
    EXPECT_FALSE(Json::parse(text_of("e.json")).contains("learned_sizes"));
    run_well(calibrate);
    const Json sizes = Json::parse(text_of("e.json")).at("learned_sizes");
    EXPECT_EQ(sizes.size(), 2U);
    EXPECT_EQ(sizes.at("length_m").at("stated"), 1e-3);
    EXPECT_NE(sizes.at("length_m").at("learned"), 1e-3);
    EXPECT_GT(sizes.at("angle_rad").at("learned"), 0);
    write_text("q.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\na,1,2,3,4,5,6\n");
    run_well("correct " + fanuc_design + " e.json --poses q.csv");
}

TEST_F(Calibrate, FindsOnlyTheErrorsThatAreAskedFor) {
    run_well(clean_ + "--folds 0 --free dq2,class:lengths --csv o.csv -o f.json");
    const Json robot = Json::parse(text_of("f.json")).at("robot");
    EXPECT_TRUE(robot.contains("dq2") && robot.contains("Tx1") && robot.contains("Tz2"));
    EXPECT_FALSE(robot.contains("dq3") || robot.contains("Rx1"));
    const std::string csv = text_of("o.csv");
    EXPECT_EQ(csv.find("joint,offset,deviation,unit\nq2,"), 0U) << csv;
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 2);
    const Outcome unknown = run(clean_ + "--free dq22");
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.err.find("--free: 'dq22' is no error of the robot; did you mean 'dq2'"),
              std::string::npos)
        << unknown.err;
}

TEST_F(Calibrate, WritesTheOffsetsOfThePendantsJoints) {
    write_text("pendant.yaml",
               read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml") +
                   "controller: {maker: fanuc, j23_factor: 1, pulses_per_deg: [1e6, 1e6, 1e6, 1e6, "
                   "1e6, 1e6]}\n");
    run_well("calibrate pendant.yaml -m s.csv --folds 0 --csv o.csv -o f.json");
    run_well("export pendant.yaml f.json --offsets again.csv");
    EXPECT_EQ(text_of("again.csv"), text_of("o.csv"));
    const Json robot = Json::parse(text_of("f.json")).at("robot");
    const double q2 = robot.at("dq2").at("value_rad");
    // Joint 3 turns against its element.
    const double q3 = robot.at("dq3").at("value_rad");
    std::istringstream rows(text_of("o.csv"));
    std::string row;
    std::getline(rows, row);
    EXPECT_EQ(row, "joint,offset,deviation,unit,pulses");
    std::getline(rows, row);
    EXPECT_TRUE(row.starts_with("J2,")) << row;  // where the base is found, J1 is not
    std::getline(rows, row);
    ASSERT_TRUE(row.starts_with("J3,")) << row;
    EXPECT_NEAR(std::stod(row.substr(3)), (-q3 - q2) * 180 / std::numbers::pi, 1e-8);
    const double pulses = std::stod(row.substr(row.rfind(',') + 1));
    EXPECT_NEAR(pulses, 1e6 * (-q3 - q2) * 180 / std::numbers::pi, 0.5);
}

TEST_F(Calibrate, HasOnlyTheErrorsThatItsCampaignLists) {
    std::string text = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    text.replace(text.find("robot:\n"), 7, "robot:\n  errors: [class:offsets, Tx3]\n");
    write_text("list.yaml", text);
    EXPECT_EQ(run("calibrate list.yaml -m s.csv --folds 0 --force -o l.json").code, 0);
    const Json robot = Json::parse(text_of("l.json")).at("robot");
    EXPECT_EQ(robot.size(), 7U);
    EXPECT_TRUE(robot.contains("Tx3") && robot.contains("dq6"));
    text.replace(text.find("[class:offsets, Tx3]"), 20, "none");
    write_text("none.yaml", text);
    EXPECT_EQ(run("calibrate none.yaml -m s.csv --folds 0 --force -o n.json").code, 0);
    EXPECT_TRUE(Json::parse(text_of("n.json")).at("robot").empty());
    text.replace(text.find("errors: none"), 12, "errors: [class:gains]");
    write_text("bad.yaml", text);
    expect_input_error(
        "calibrate bad.yaml -m s.csv",
        "'class:gains' is no error of the robot; must be one of its errors, "
        "class:angles, class:gravity, class:harmonics, class:lengths or class:offsets");
    text.replace(text.find("[class:gains]"), 13, "[Tx3, offsets]");
    write_text("bad.yaml", text);
    expect_input_error("calibrate bad.yaml -m s.csv",
                       "'offsets' is no error of the robot; did you mean 'class:offsets'?");
}

TEST_F(Calibrate, ComparesSetsEvenIfTheWholeCannotBeIdentified) {
    const Outcome outcome =
        run("calibrate " + seed_design + " -m s.csv --model-selection --folds 5 -o e.json");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("Tx2"), std::string::npos);
    EXPECT_FALSE(has_file("e.json"));
    EXPECT_NE(outcome.out.find("\n+ lengths: these 30 configurations cannot tell apart"),
              std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("recommended, best"), std::string::npos);
}

}  // namespace
}  // namespace posewise::testing
