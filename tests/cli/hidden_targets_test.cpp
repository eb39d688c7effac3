#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.hpp"

/// From a plan whose poses hide targets to measurements without them and their calibration.
namespace posewise::testing {
namespace {

const std::string cell = "'" + source_folder() + "/designs/cell_demo/campaign.yaml'";

class HiddenTargets : public Program {
  protected:
    /// c.csv: configurations that show two targets in turns, and all three now and then.
    void write_configurations() const {
        run_well("simulate " + cell + " --poses 16 --seed 2 -o drawn.csv");
        std::istringstream lines(text_of("drawn.csv"));
        std::string text;
        std::size_t count = 0;
        for (std::string line; std::getline(lines, line);) {
            const std::string visible[] = {"1 2", "2 3", "1 2 3", "3 1"};
            if (line[0] == '#') continue;
            text += line + ',' + (text.empty() ? "visible_targets" : visible[count++ % 4]) + '\n';
        }
        write_text("c.csv", text);
    }
    /// m.csv: measured at c.csv.
    void simulate() const {
        write_configurations();
        run_well("simulate " + cell + " --configurations c.csv --repeats 2 -o m.csv");
    }
    nlohmann::json json_of(const std::string& name) const {
        return nlohmann::json::parse(text_of(name));
    }
    /// m.csv, the last three cells of each row empty.
    std::string without_target_3() const {
        std::istringstream lines(text_of("m.csv"));
        std::string text;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] >= '0' && line[0] <= '9') {
                for (int k = 0; k < 3; ++k) line.erase(line.rfind(','));
                line += ",,,";
            }
            text += line + '\n';
        }
        return text;
    }
};

TEST_F(HiddenTargets, ArePlannedSimulatedAndCalibrated) {
    run_well("plan " + cell +
             " -k 12 --criterion d --pool 600 --starts 1 --workspace-poses 20 -o p.json "
             "--csv p.csv");
    const auto plan = json_of("p.json");
    std::size_t visible = 0;
    for (const auto& pose : plan.at("poses")) visible += pose.at("visible_targets").size();
    ASSERT_LT(visible, 36u);  // else there is nothing to test
    const std::string truth =
        run_well("simulate " + cell + " --configurations p.csv --truth 7 --seed 5 -o m.csv");
    const std::string text = run_well("calibrate " + cell + " -m m.csv -o e.json");
    EXPECT_NE(text.find(std::to_string(36 - visible) + " of 36 points are missing"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("held out: 12 folds, 0 of them not identifiable"), std::string::npos);
    const auto estimate = json_of("e.json");
    EXPECT_EQ(estimate.at("accuracy").at("fit").at("point_count"), visible);
    EXPECT_EQ(estimate.at("accuracy").at("held_out").at("samples").at("point_count"), visible);
    EXPECT_EQ(estimate.at("degrees_of_freedom"), 3 * visible - 33);

    // The deviations are those the plan predicted, and the true errors within five of them.
    const double factor = std::sqrt(estimate.at("variance_factor").get<double>());
    EXPECT_NEAR(factor, 1, 0.4);
    const auto& predicted = plan.at("predicted").at("standard_deviation");
    for (const auto& [name, parameter] : estimate.at("robot").items()) {
        const std::string unit = parameter.contains("value_rad") ? "_rad" : "_m";
        const double sigma = parameter.at("sigma" + unit).get<double>() / factor;
        const double expected = predicted.at(name + unit);
        EXPECT_NEAR(sigma, expected, 0.03 * expected) << name;
        EXPECT_NEAR(parameter.at("value" + unit), 1e-3 * number_behind(truth, name + ' '),
                    5 * sigma)
            << name;
    }
}

TEST_F(HiddenTargets, AreLeftOutBySelectionAndItsVerification) {
    simulate();
    for (const std::string candidates : {"-m m.csv", "--candidates c.csv"}) {
        run_well("select " + cell + ' ' + candidates + " -k 10 --starts 2 -o s.json");
        EXPECT_NE(run_well("verify s.json").find("as stated"), std::string::npos);
    }
    run_well("select " + cell + " --random 200 --augment m.csv -k 2 --starts 2 -o s.json");
    run_well("indices " + cell + " -m m.csv");
    run_well("study " + cell + " -m m.csv --random 2 --poses 12 --starts 2");
    // A pose that shows less is worth less.
    const auto value = [&] {
        return number_behind(
            run_well("select " + cell + " --candidates c.csv -k 12 --starts 2 -o s.json"),
            "value:");
    };
    const double with_hidden = value();
    write_text("c.csv", text_of("drawn.csv"));
    EXPECT_GT(value(), with_hidden + 1);
}

TEST_F(HiddenTargets, ThatAreNeverSeenAreNamed) {
    simulate();
    write_text("two.csv", without_target_3());
    for (const std::string command : {"calibrate ", "indices ", "study ", "select -k 9 "}) {
        expect_input_error(command + cell + " -m two.csv",
                           "two.csv: target 3 is seen in no sample of these 16 configurations");
    }
    // The other two can still judge a robot that was calibrated with three.
    run_well("calibrate " + cell + " -m m.csv --folds 0 --validate two.csv");
}

TEST_F(HiddenTargets, BadCellsAreOneLineWithTheirPlace) {
    simulate();
    std::string bad = without_target_3();
    write_text("bad.csv", bad.replace(bad.rfind(",,,"), 3, ",,1,"));
    expect_input_error("calibrate " + cell + " -m bad.csv -o e.json",
                       "p3_x is empty, but not all cells of target 3 are");
    bad = text_of("c.csv");
    write_text("bad.csv", bad.replace(bad.rfind(','), std::string::npos, ",4\n"));
    expect_input_error("simulate " + cell + " --configurations bad.csv -o e.csv", "bad.csv:17:");
    expect_input_error("simulate " + cell + " --configurations c.csv -o c.csv",
                       "must be another file");
    expect_input_error("simulate " + cell + " --configurations absent.csv -o e.csv", "absent.csv");
    EXPECT_EQ(run("simulate " + cell + " -k 4 --configurations c.csv -o e.csv").code, 2);
}

}  // namespace
}  // namespace posewise::testing
