#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "program.hpp"

/// A calibration that harms is refused, by every command, and what is only doubted is repeated.
namespace posewise::testing {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;

class Refusal : public Program {
  protected:
    /// The file without comments, its rows changed.
    void rewrite(const std::string& from, const std::string& to,
                 const std::function<void(Cells&)>& change) const {
        std::istringstream lines(text_of(from));
        std::string text;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] == '#') continue;
            Cells cells;
            std::istringstream row(line);
            for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
            if (cells[0] != "config") change(cells);
            for (std::size_t k = 0; k < cells.size(); ++k) text += (k > 0 ? "," : "") + cells[k];
            text += '\n';
        }
        write_text(to, text);
    }
    static void add(std::string& cell, double value) {
        cell = std::to_string(std::stod(cell) + value);
    }
    /// Simulated measurements of this design, 24 configurations of two samples.
    void simulate(const std::string& campaign) const {
        run_well("simulate " + campaign +
                 " --truth 11 --seed 21 --poses 24 --repeats 2 --out s.csv");
    }
    /// The IRB 120 with known places of its targets, errors as `robot` says.
    void write_irb(const std::string& robot) const {
        std::string text = read_text(source_folder() + "/designs/abb_irb120/planning.yaml");
        text.replace(text.find("{count: 3}"), 10,
                     "{position_mm: [[60, 40, 90], [-50, 60, 80], [20, -70, 100]]}");
        text.replace(text.find("robot:\n"), 7, "robot:\n" + robot);
        write_text("i.yaml",
                   text + "base: {position_mm: [2500, 300, -400], rpy_deg: [0, 0, 120]}\n");
    }
};

TEST_F(Refusal, OfOneConfigurationThatIsWrongIsCuredByLeavingItOut) {
    simulate(fanuc_design);
    rewrite("s.csv", "bad.csv", [](Cells& cells) {
        if (cells[0] == "5") add(cells[4], 0.0872664626);
    });
    for (const std::string folds : {"", " --folds 0"}) {
        const Outcome outcome =
            run("calibrate " + fanuc_design + " -m bad.csv -o bad.json" + folds);
        EXPECT_EQ(outcome.code, 3);
        EXPECT_FALSE(has_file("bad.json"));
        EXPECT_NE(
            outcome.err.find("this is no calibration: without configuration '5' it leaves 0."),
            std::string::npos)
            << outcome.err;
        EXPECT_NE(outcome.err.find("with --exclude 5: 0."), std::string::npos) << outcome.err;
    }
    run_well("calibrate " + fanuc_design + " -m bad.csv --exclude 5 -o good.json");
    // What is forced says so to all that builds on it.
    run("calibrate " + fanuc_design + " -m bad.csv --force --folds 0 -o bad.json");
    Json estimate = Json::parse(text_of("bad.json"));
    EXPECT_EQ(estimate.at("cures").at("found").at(0).at("option"), "--exclude 5");
    // Its faults are said once, whatever it was warned of.
    estimate["warnings"] = {"this is no calibration: it says so here, too"};
    write_text("bad.json", estimate.dump());
    expect_input_error("export " + fanuc_design + " bad.json --dh d.yaml",
                       "bad.json: is no calibration to use: without configuration '5'");
}

TEST_F(Refusal, OfAnotherZeroOfAJoint) {
    write_irb("");
    simulate("i.yaml");
    rewrite("s.csv", "z.csv", [](Cells& cells) { add(cells[3], 1.5707963); });
    const Outcome outcome = run("calibrate i.yaml -m z.csv --folds 0 -o z.json");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_NE(outcome.err.find("dq2 is -15"), std::string::npos) << outcome.err;
    EXPECT_FALSE(has_file("z.json"));
}

TEST_F(Refusal, IsNotPutOffByLearnedSizes) {
    write_irb("");
    simulate("i.yaml");
    rewrite("s.csv", "z.csv", [](Cells& cells) { add(cells[3], 1.5707963); });
    const Outcome outcome = run("calibrate i.yaml -m z.csv --folds 0 --sizes learned -o z.json");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_NE(outcome.err.find("times the size expected of it"), std::string::npos) << outcome.err;
    EXPECT_FALSE(has_file("z.json"));
}

TEST_F(Refusal, NamesTwoRowsThatAreExchangedWhereNothingFitsBesideThem) {
    simulate(fanuc_design);
    const std::string all = text_of("s.csv");
    const auto joints_of = [&](const std::string& id) {
        const auto begin = all.find('\n' + id + ",0,") + id.size() + 4;
        std::size_t end = begin;
        for (int k = 0; k < 6; ++k) end = all.find(',', end) + 1;
        return all.substr(begin, end - begin);
    };
    const std::map<std::string, std::string> other{{"9", joints_of("14")}, {"14", joints_of("9")}};
    rewrite("s.csv", "x.csv", [&](Cells& cells) {
        if (!other.contains(cells[0])) return;
        std::istringstream joints(other.at(cells[0]));
        for (std::size_t k = 2; k < 8; ++k) std::getline(joints, cells[k], ',');
    });
    const Outcome outcome = run("calibrate " + fanuc_design + " -m x.csv --folds 0");
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_NE(outcome.err.find("9 and 14 fit with each other's joint values: rows exchanged?"),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find("with --exclude 9,14: 0."), std::string::npos) << outcome.err;
    EXPECT_EQ(run("calibrate " + fanuc_design + " -m x.csv --folds 0 --exclude 9,14").code, 0);
}

TEST_F(Refusal, OfCorrectionsThatBringFewHome) {
    simulate(fanuc_design);
    run_well("calibrate " + fanuc_design + " -m s.csv --folds 0 -o e.json");
    Json estimate = Json::parse(text_of("e.json"));
    estimate.at("robot").at("dq3").at("value_rad") = 0.045;
    write_text("off.json", estimate.dump());
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "a,10,20,30,40,50,60\nb,-80,-20,0,-40,-70,0\n");
    const std::string correct =
        "correct " + fanuc_design + " off.json --poses p.csv -o c.csv --largest-change-deg ";
    const Outcome outcome = run(correct + "0.2");
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_FALSE(has_file("c.csv"));
    EXPECT_EQ(outcome.err,
              "posewise: p.csv: 2 of 2 configurations are not brought home, the first is 'a': over "
              "half of their error is left; nothing was written, --force corrects them all the "
              "same\n");
    EXPECT_EQ(run(correct + "0.2 --force").code, 0);
    EXPECT_TRUE(has_file("c.csv"));
    run_well(correct + "12");
}

TEST_F(Refusal, IsThatOfStudiesAndChoicesToo) {
    write_irb("  errors: geometric\n");
    simulate("i.yaml");
    rewrite("s.csv", "zero.csv", [](Cells& cells) {
        if (cells[0] != "6" || cells[1] != "0") return;
        cells[8] = cells[9] = cells[10] = "0";
    });
    for (const std::string& command :
         {std::string("study i.yaml -m zero.csv -k 10 --random 3 --splits 2 --starts 1"),
          std::string("select i.yaml -m zero.csv -k 12 --proof 0 -o p.json")}) {
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.code, 3) << outcome.err;
        EXPECT_EQ(outcome.out, "");
        EXPECT_NE(outcome.err.find("posewise: zero.csv: this is no calibration: "),
                  std::string::npos)
            << outcome.err;
        EXPECT_NE(outcome.err.find("'6:0' most"), std::string::npos) << outcome.err;
        EXPECT_FALSE(has_file("p.json"));
    }
    run_well("study i.yaml -m zero.csv --exclude 6:0 -k 10 --random 3 --splits 2 --starts 1");
}

TEST_F(Refusal, WarningsOfAnEstimateAreRepeatedByAllThatReadsIt) {
    simulate(fanuc_design);
    run_well("calibrate " + fanuc_design + " -m s.csv --folds 0 -o e.json");
    Json estimate = Json::parse(text_of("e.json"));
    estimate["warnings"] = {"s.csv: a cable was loose"};
    write_text("w.json", estimate.dump());
    write_text("p.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,0,0,0,0,30,0\n");
    for (const std::string& command :
         {"export " + fanuc_design + " w.json --dh d.yaml",
          "correct " + fanuc_design + " w.json --poses p.csv",
          "plan " + fanuc_design +
              " --from w.json -k 12 --pool 100 --starts 1 --workspace-poses 5 -o p.json",
          "calibrate " + fanuc_design + " -m s.csv --folds 0 --from w.json"}) {
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(outcome.err,
                  "posewise: warning: w.json: was warned of when it was made: s.csv: a cable was "
                  "loose\n");
    }
}

TEST_F(Refusal, IsNotOfNoiseThatIsStated) {
    write_irb("  errors: stated\n");
    std::string text = text_of("i.yaml");
    text.replace(text.find("sigma_mm: 0.004"), 15, "sigma_mm: 1.3");
    write_text("i.yaml", text);
    run_well("simulate i.yaml --poses 25 --out n.csv");
    const Outcome outcome = run("calibrate i.yaml -m n.csv");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err.find("another robot"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace posewise::testing
