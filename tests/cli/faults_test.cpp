#include <nlohmann/json.hpp>

#include "program.hpp"

/// Estimates that must not reach a robot: not written, and refused where they are read.
namespace posewise::testing {
namespace {

class Faults : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design +
                 " --truth 7 --seed 3 --poses 30 --repeats 3 -o s.csv");
    }

    const std::string calibrate_ = "calibrate " + fanuc_design + " -m s.csv --folds 0 ";
};

TEST_F(Faults, AreNotWrittenAndLeaveTheLastEstimate) {
    run_well(calibrate_ + "-o e.json");
    const std::string good = text_of("e.json");
    const Outcome outcome = run(calibrate_ + "--max-iterations 1 -o e.json");
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(outcome.err,
              "posewise: s.csv: this is no calibration: it did not converge (iteration limit); "
              "nothing was written, --force takes it all the same\n");
    EXPECT_NE(outcome.out.find("Accuracy"), std::string::npos) << outcome.out;
    EXPECT_EQ(text_of("e.json"), good);
}

TEST_F(Faults, ThatAreForcedAreMarkedAndRefusedWithoutForce) {
    const Outcome forced = run(calibrate_ + "--max-iterations 1 --force -o e.json");
    EXPECT_EQ(forced.code, 0);
    EXPECT_EQ(forced.err,
              "posewise: warning: this is no calibration: it did not converge (iteration limit)\n");
    EXPECT_TRUE(nlohmann::json::parse(text_of("e.json")).contains("faults"));
    const std::string words =
        "e.json: is no calibration to use: it did not converge (iteration limit); --force takes";
    write_text("p.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,0,0,0,0,30,0\n");
    const std::string do_export = "export " + fanuc_design + " e.json --dh d.yaml";
    const std::string do_correct = "correct " + fanuc_design + " e.json --poses p.csv -o c.csv";
    for (const std::string& command : {do_export, do_correct}) {
        expect_input_error(command, words);
        const Outcome outcome = run(command + " --force");
        EXPECT_EQ(outcome.code, 0);
        EXPECT_EQ(outcome.err.rfind("posewise: warning: e.json: is no calibration", 0), 0U)
            << outcome.err;
    }
    EXPECT_TRUE(has_file("d.yaml") && has_file("c.csv"));
}

TEST_F(Faults, ThatTheFileStatesCount) {
    run_well(calibrate_ + "-o e.json");
    nlohmann::ordered_json document = nlohmann::ordered_json::parse(text_of("e.json"));
    document["faults"] = {"a cable was loose"};
    write_text("bad.json", document.dump());
    write_text("p.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,0,0,0,0,30,0\n");
    const std::string do_export = "export " + fanuc_design + " bad.json --dh d.yaml";
    const std::string words = "bad.json: is no calibration to use: a cable was loose";
    expect_input_error(do_export, words + "; --force takes it all the same");
    expect_input_error("correct " + fanuc_design + " bad.json --poses p.csv -o c.csv", words);
    expect_input_error("plan " + fanuc_design + " --from bad.json -k 12", words);
    const Outcome forced = run(do_export + " --force");
    EXPECT_EQ(forced.code, 0);
    EXPECT_EQ(forced.err, "posewise: warning: " + words + '\n');
    document["faults"] = "a cable was loose";
    write_text("bad.json", document.dump());
    expect_input_error("correct " + fanuc_design + " bad.json --poses p.csv -o c.csv",
                       "bad.json: faults: is of type string; must be a list");
    document["faults"] = nlohmann::ordered_json::array();
    write_text("good.json", document.dump());
    run_well("correct " + fanuc_design + " good.json --poses p.csv -o c.csv");
}

TEST_F(Faults, AreValuesThatNoRobotHas) {
    run_well(calibrate_ + "-o e.json");
    nlohmann::ordered_json document = nlohmann::ordered_json::parse(text_of("e.json"));
    const auto refuses = [&](const std::string& words) {
        write_text("bad.json", document.dump());
        expect_input_error("export " + fanuc_design + " bad.json --dh d.yaml", words);
    };
    document["robot"]["dq2"]["value_rad"] = 1.5;
    refuses(
        "bad.json: is no calibration to use: dq2 is 1500 mrad, 1.5e+03 times the size expected");
    document["robot"]["dq2"]["value_rad"] = 0.001;
    document["variance_factor"] = 1e7;
    refuses("its residuals are 3.2e+03 times what sigma and model error say");
}

TEST_F(Faults, AnEstimateOfAnotherRobotIsNamedByWhatDiffers) {
    run_well(calibrate_ + "-o e.json");
    std::string text = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const auto at = text.find("Tz 1075 mm");
    ASSERT_NE(at, std::string::npos);
    write_text("other.yaml", text.replace(at, 10, "Tz 1000 mm"));
    for (const std::string command : {"export other.yaml e.json --dh d.yaml"}) {
        expect_input_error(command, R"("amount_m":1.075)");
        expect_input_error(command, "the estimate is of another robot");
    }
}

/// The FANUC campaign with a base at this x (mm) that is known, or is not.
std::string with_base(const std::string& x, bool is_known) {
    std::string text = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    text.erase(text.find("measurements:"));  // of MATLAB files
    const std::string turn = "0.35]}";
    if (is_known) text.replace(text.find(turn), turn.size(), "0.35], known: true}");
    return text.replace(text.find("-557.6"), 6, x);
}

TEST_F(Faults, OfABaseThatIsKnownElsewhere) {
    write_text("c.yaml", with_base("-557.6", true));
    write_text("other.yaml", with_base("-357.6", true));
    std::string turned = with_base("-557.6", true);
    write_text("turned.yaml", turned.replace(turned.find("0.35]"), 5, "0.45]"));
    run_well("simulate c.yaml --truth 7 --seed 3 --poses 20 -o m.csv");
    run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    run_well("calibrate c.yaml -m m.csv --folds 0 --from e.json");
    const std::string words =
        "posewise: e.json: the base is at (-557.6, -563.2, 561.4) mm, the campaign states one at "
        "(-357.6, -563.2, 561.4) mm as known; must be stated as when the estimate was made, unless "
        "--moved base says that it is another\n";
    expect_input_error("calibrate other.yaml -m m.csv --folds 0 --from e.json", words);
    expect_input_error("select other.yaml --random 50 -k 9 --from e.json", words);
    expect_input_error("plan other.yaml -k 9 --pool 50 --from e.json", words);
    expect_input_error("study other.yaml -m m.csv -k 9 --from e.json", words);
    expect_input_error("indices other.yaml -m m.csv --from e.json --only targets", words);
    expect_input_error("inspect other.yaml --from e.json", words);
    run_well("indices other.yaml -m m.csv --from e.json --moved base");
    expect_input_error("inspect turned.yaml --from e.json",
                       "mm, rpy (-0.28, 0.37, 0.35) deg, the campaign states one at");
    // Their base frame may be another one.
    write_text("p.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n1,0,0,0,0,30,0\n");
    run_well("correct other.yaml e.json --poses p.csv -o c.csv");
}

TEST_F(Faults, NoneIsABaseThatWasMovedAndIsKnownNow) {
    write_text("open.yaml", with_base("-557.6", false));
    write_text("known.yaml", with_base("-557.6", true));
    for (const std::string seed : {"3", "4"}) {
        run_well("simulate known.yaml --truth 7 --poses 20 -o m" + seed + ".csv --seed " + seed);
    }
    for (const std::string from : {"open", "known"}) {
        const std::string to = from == "open" ? "known" : "open";
        run_well("calibrate " + from + ".yaml -m m3.csv --folds 0 -o e.json");
        const std::string again = "calibrate " + to + ".yaml -m m4.csv --folds 0 --from e.json";
        const std::string words = "must be stated as when the estimate was made, unless '--moved'";
        expect_input_error(again, words);
        expect_input_error(again + " --as-prior --moved targets", words);
        run_well(again + " --moved base");
        run_well(again + " --moved base --as-prior");
        run_well(again + " --moved base,targets --as-prior");
        run_well(again + " --moved base --only base,targets");
        run_well("plan " + to +
                 ".yaml -k 5 --pool 50 --starts 1 --workspace-poses 20 --moved base --as-prior "
                 "--from e.json " +
                 "-o p.json");
        run_well("verify p.json");
        if (from == "open") run_well(again + " --moved base --only targets");
    }
}

TEST_F(Faults, OfAPriorNameItsFile) {
    run_well(calibrate_ + "-o e.json");
    nlohmann::ordered_json document = nlohmann::ordered_json::parse(text_of("e.json"));
    auto& rows = document["covariance"]["rows_si"];
    rows[2][0] = rows[2][1] = 0;  // base.z is as sure as can be
    for (std::size_t k = 2; k < rows.size(); ++k) rows[k][2] = 0;
    document["sigma"]["base.z_m"] = 0;
    write_text("sure.json", document.dump());
    const std::string plan = "plan " + fanuc_design + " -k 4 --pool 50 --as-prior --from sure.json";
    expect_input_error(plan, "sure.json: is no calibration to use");
    const std::string words =
        "posewise: sure.json: covariance.rows_si: is not positive definite, even with drift";
    for (const std::string& command :
         {plan, calibrate_ + "--as-prior --from sure.json",
          "study " + fanuc_design + " -m s.csv -k 9 --as-prior --from sure.json"}) {
        const Outcome outcome = run(command + " --force");
        EXPECT_EQ(outcome.code, 1) << command;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    }
}

}  // namespace
}  // namespace posewise::testing
