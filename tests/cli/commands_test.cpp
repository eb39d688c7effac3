#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "program.hpp"

/// Each command on the design of the FANUC and measurements simulated with it.
namespace posewise::testing {
namespace {

class Commands : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design +
                 " --truth 7 --seed 3 --poses 16 --repeats 3 -o s.csv");
    }
    const std::string input_ = fanuc_design + " -m s.csv ";
};

TEST_F(Commands, InspectShowsAnIrreducibleSet) {
    const std::string text = run_well("inspect " + fanuc_design);
    EXPECT_NE(text.find("stated set: rank 33 of 33"), std::string::npos) << text;
    EXPECT_NE(text.find("4*6 + 2*0 + 3*3 = 33"), std::string::npos);
    EXPECT_NE(text.find("spans them all"), std::string::npos);
    EXPECT_EQ(number_behind(text, "least number of poses:"), 5);
}

TEST_F(Commands, InspectShowsThatTheSeedReportsSetIsRankDeficient) {
    const std::string text = run_well("inspect " + seed_design);
    EXPECT_NE(text.find("rank 32 of 33"), std::string::npos) << text;
    EXPECT_NE(text.find("spans only 32 of these 33"), std::string::npos);
    EXPECT_NE(text.find("1 mm Tx2 = 0.9302 mrad dq2 - 0.9302 mrad dq3"), std::string::npos);
}

TEST_F(Commands, SimulateIsReproducibleFromItsComment) {
    const std::string first = text_of("s.csv");
    EXPECT_EQ(first.rfind("# ", 0), 0u);
    EXPECT_NE(first.find("--truth 7 --seed 3 --poses 16 --repeats 3"), std::string::npos);
    run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 16 --repeats 3 -o t.csv");
    EXPECT_EQ(text_of("t.csv"), first);
    run_well("simulate " + fanuc_design + " --truth 7 --seed 4 --poses 16 --repeats 3 -o t.csv");
    EXPECT_NE(text_of("t.csv"), first);
}

TEST_F(Commands, IndicesCountWhatThePriorTells) {
    std::string campaign = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    campaign.insert(campaign.find("  elements:"), "  errors: full\n");
    write_text("full.yaml", campaign);
    const std::string text = run_well("indices full.yaml -m s.csv");
    EXPECT_NE(text.find("with the prior"), std::string::npos);
    EXPECT_NE(text.find("\nwhitened, scaled: rows divided by the noise"), std::string::npos);
    EXPECT_NE(text.find(", and what the prior tells: what posewise selects by\nplain: of the "),
              std::string::npos);
    std::istringstream line(text.substr(text.find("\nv ")));
    std::string name, with_prior, plain;
    line >> name >> with_prior >> plain;
    EXPECT_GT(std::stod(with_prior), 0);
    EXPECT_EQ(plain, "-inf");
}

TEST_F(Commands, IndicesAgreeWithEachOther) {
    const std::string text = run_well("indices " + input_);
    for (const std::size_t column : {0u, 1u}) {
        const auto value = [&](const std::string& name) {
            return number_behind(text, name, column);
        };
        EXPECT_NEAR(value("o4"), value("o2") * value("o3"), 1e-5 * value("o4"));
        EXPECT_NEAR(value("condition"), 1 / value("o2"), 1e-4 * value("condition"));
        EXPECT_NEAR(value("e"), value("o3") * value("o3"), 1e-4 * value("e"));
        EXPECT_LE(value("o5"), value("o3"));
        // The mean of trace(B M^-1 B^T) over the poses that make M is parameters / poses.
        EXPECT_NEAR(value("v"), 16.0 / 33.0, 1e-5);
    }
    EXPECT_NE(text.find("% of the expected size: "), std::string::npos);
}

TEST_F(Commands, SelectWritesAPlanThatCalibrateTakes) {
    const std::string text = run_well("select " + input_ + "-k 8 --criterion d");
    ASSERT_TRUE(has_file("s.plan.json"));
    const auto plan = nlohmann::json::parse(text_of("s.plan.json"));
    EXPECT_EQ(plan.at("poses").size(), 8u);
    EXPECT_GE(number_behind(text, "bound:"), number_behind(text, "value:"));
    EXPECT_LE(number_behind(text, "efficiency:"), 1);
    EXPECT_GT(number_behind(text, "efficiency:"), 0.5);
    const std::string calibrated = run_well("calibrate " + input_ + "--plan s.plan.json --folds 0");
    EXPECT_NE(calibrated.find("8 configurations, 24 samples"), std::string::npos);
    EXPECT_NE(calibrated.find("not in plan"), std::string::npos);
}

TEST_F(Commands, CalibrateRefusesAPlanOfAnotherCampaign) {
    run_well("select " + input_ + "-k 8");
    run_well("simulate " + fanuc_design + " --seed 99 --poses 60 -o other.csv");
    const Outcome refused = run("calibrate " + fanuc_design + " -m other.csv --plan s.plan.json");
    EXPECT_EQ(refused.code, 1);
    EXPECT_NE(refused.err.find("the plan must be of this robot and campaign"), std::string::npos);
}

TEST_F(Commands, CalibrateFindsTheTruthAndWritesIt) {
    const std::string text = run_well("calibrate " + input_ + "--out e.json");
    EXPECT_NE(text.find("converged"), std::string::npos);
    EXPECT_GT(number_behind(text, "distance RMS", 0), 1);    // nominal
    EXPECT_LT(number_behind(text, "distance RMS", 1), 0.3);  // calibrated
    EXPECT_LT(number_behind(text, "distance RMS", 3), 0.5);  // held out
    EXPECT_NEAR(number_behind(text, "noise floor from repeats:"), 0.052, 0.006);
    EXPECT_TRUE(nlohmann::json::parse(text_of("e.json")).is_object());
}

TEST_F(Commands, CalibrateJudgesOnAnotherFile) {
    run_well("simulate " + fanuc_design + " --truth 7 --seed 9 --poses 20 -o v.csv");
    const std::string text = run_well("calibrate " + input_ + "--validate v.csv --folds 4");
    EXPECT_LT(number_behind(text, "distance RMS", 5), 0.5);  // the last column
    EXPECT_NE(text.find("held out: 4 folds"), std::string::npos);
}

TEST_F(Commands, TwoStepSaysThatItDidNotConverge) {
    const Outcome outcome = run("calibrate " + input_ + "--method two-step --max-iterations 3");
    const std::string& text = outcome.out;
    EXPECT_EQ(outcome.code, 3);
    EXPECT_NE(text.find("two-step: iteration limit after 3 iterations; this is not the optimum"),
              std::string::npos)
        << text;
}

TEST_F(Commands, StudyWritesTableCsvAndPlot) {
    const std::string text =
        run_well("study " + input_ + "--criteria d,a --random 10 --poses 6:7,10 --csv r.csv");
    EXPECT_NE(text.find("poses"), std::string::npos);
    EXPECT_LT(number_behind(text, "10 "), 0.5);
    const std::string csv = text_of("r.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3 * 12);
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot here";
    run_well("study " + input_ + "--random 5 --poses 8,10 --plot 'a plot.svg'");
    EXPECT_NE(text_of("a plot.svg").find("<svg"), std::string::npos);
    EXPECT_FALSE(has_file("a plot.svg.gnuplot"));
}

TEST_F(Commands, StudyComparesErrorModelsOnTheSameSubsets) {
    const std::string options = "--splits 2 --random 4 --poses 6 --csv ";
    const std::string text =
        run_well("study " + input_ + "--models stated,full " + options + "both.csv");
    EXPECT_NE(text.find("d/random stated"), std::string::npos) << text;
    run_well("study " + input_ + options + "stated.csv");
    std::string campaign = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    campaign.insert(campaign.find("  elements:"), "  errors: full\n");
    write_text("full.yaml", campaign);
    run_well("study full.yaml -m s.csv " + options + "full.csv");
    std::string expected;
    for (const std::string model : {"stated", "full"}) {
        std::istringstream lines(text_of(model + ".csv"));
        std::string line;
        std::getline(lines, line);
        if (expected.empty()) expected = "model," + line + '\n';
        while (std::getline(lines, line)) expected += model + ',' + line + '\n';
    }
    EXPECT_EQ(text_of("both.csv"), expected);

    write_text("none.yaml", "name: none\nrobot:\n" + six_joints +
                                "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n");
    expect_input_error("study none.yaml -m s.csv --models geometric,stated " + options + "no.csv",
                       "none.yaml: has no errors to fit as stated, none is named in brackets");
    const Outcome twice = run("study " + input_ + "--models full,geometric,full");
    EXPECT_EQ(twice.code, 2);
    EXPECT_NE(twice.err.find("--models: names 'full' twice; keep one"), std::string::npos)
        << twice.err;
}

TEST_F(Commands, StudyPlansOnlyWhatIsFarEnoughApart) {
    const std::string study = "study " + input_ + "--random 0 --poses 6 --csv r.csv ";
    run_well(study);
    const std::string free = text_of("r.csv");
    run_well(study + "--least-distance-deg 200");
    EXPECT_NE(text_of("r.csv"), free);
    expect_input_error(study + "--least-distance-deg 2000",
                       "only 1 pose was found that exclusions, groups and distances "
                       "(--least-distance-deg, ");
}

TEST_F(Commands, StudyWithoutGnuplotLeavesTheScript) {
    const Outcome outcome =
        run("study " + input_ + "--random 5 --poses 8 --plot p.svg", "PATH=/nowhere");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("gnuplot './p.svg.gnuplot'"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.out.find("poses"), std::string::npos);
    EXPECT_TRUE(has_file("p.svg.gnuplot"));
    EXPECT_FALSE(has_file("p.svg"));
}

TEST_F(Commands, AreTheSameForOneThreadAndTwo) {
    for (const std::string& arguments :
         {"select " + input_ + "-k 7 -o plan.json", "calibrate " + input_ + "-o estimate.json",
          "indices " + input_, "study " + input_ + "--random 6 --poses 6,9 --csv study.csv"}) {
        const std::string one = run_well(arguments, "OMP_NUM_THREADS=1");
        std::string files_one;
        std::string files_two;
        const auto names = {"plan.json", "estimate.json", "study.csv"};
        for (const auto* name : names) files_one += text_of(name);
        const std::string two = run_well(arguments, "OMP_NUM_THREADS=2");
        for (const auto* name : names) files_two += text_of(name);
        EXPECT_EQ(one, two);
        EXPECT_EQ(files_one, files_two);
    }
}

TEST_F(Commands, PrintOnlyResultsToAPipe) {
    const Outcome piped = run("study " + input_ + "--random 3 --poses 8", "", "| cat");
    EXPECT_EQ(piped.err, "");
    EXPECT_EQ(piped.out, run_well("study " + input_ + "--random 3 --poses 8"));
    const Outcome shown = run("study " + input_ + "--random 3 --poses 8 --progress");
    EXPECT_NE(shown.err.find("100 %"), std::string::npos);
    EXPECT_EQ(shown.out, piped.out);
    const std::string inspected = "inspect " + input_;
    const Outcome tried = run(inspected + "--progress");
    EXPECT_NE(tried.err.find("trying readings 100 %"), std::string::npos) << tried.err;
    EXPECT_EQ(tried.out, run_well(inspected));
}

TEST_F(Commands, RefuseWhatCannotBeDone) {
    expect_input_error("select " + input_ + "-k 17", "17");
    expect_input_error("select " + input_ + "-k 8 -o absent/plan.json", "absent/plan.json");
    expect_input_error("select " + input_ + "-k 8 -o s.csv", "must be another file");
    expect_input_error("calibrate " + input_ + "--folds 17", "--folds");
    expect_input_error("calibrate " + input_ + "--folds 1", "--folds");
    expect_input_error("calibrate " + input_ + "--plan absent.csv", "absent.csv");
    expect_input_error("calibrate " + seed_design + " -m s.csv -o e.json", "Tx2");
    expect_input_error("study " + input_ + "--poses 17", "17");
    expect_input_error("study " + input_ + "--plot p.pdf", ".svg or .png");
    expect_input_error("indices " + input_ + "--plan absent.json", "absent.json");
    run_well("simulate " + fanuc_design + " -k 4 -o few.csv");
    expect_input_error("calibrate " + fanuc_design + " -m few.csv -o e.json", "");
    expect_input_error("study " + fanuc_design + " -m few.csv --csv r.csv", "");
    // The same seed: the first 16 of 30 are those of s.csv.
    run_well("simulate " + fanuc_design + " --truth 7 --seed 3 -k 30 -o more.csv");
    run_well("select " + fanuc_design + " -m more.csv -k 20 --starts 1 -o more.json");
    const Outcome outcome = run("calibrate " + input_ + "--plan more.json --folds 0");
    EXPECT_NE(outcome.err.find("of 20 poses are not among the measured ones: '1"),
              std::string::npos)
        << outcome.err;
}

TEST_F(Commands, RefuseBrokenMeasurementsWithOneLine) {
    const std::string good = text_of("s.csv");
    const auto broken = [&](const std::string& text) {
        write_text("broken.csv", text);
        expect_input_error("calibrate " + fanuc_design + " -m broken.csv -o e.json", "broken.csv");
    };
    broken("");
    broken(good.substr(0, good.size() - 30));
    broken(good + "16,0,nan\n");
    std::string renamed = good;
    renamed.replace(renamed.find("q2_rad"), 6, "q9_rad");
    broken(renamed);
}

}  // namespace
}  // namespace posewise::testing
