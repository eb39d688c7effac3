#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <sstream>

#include "program.hpp"

/// Commands that go on from an earlier estimate, --from.
namespace posewise::testing {
namespace {

using Json = nlohmann::ordered_json;

/// With as many digits as it takes.
std::string number(double value) { return Json(value).dump(); }

/// As a list in YAML, times `unit`.
std::string list(const std::vector<double>& values, double unit) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "[" : ", ") + number(unit * value);
    return text + ']';
}

/// "312 mm + 0.5 mm": the amount of an element with the error that was found.
std::string add_error(const std::string& amount, const Json& error) {
    const bool is_length = error.contains("value_m");
    const double value = is_length ? 1e3 * error["value_m"].get<double>()
                                   : error["value_rad"].get<double>() * 180 / std::numbers::pi;
    const std::string size = number(std::abs(value)) + (is_length ? " mm" : " deg");
    const std::string sign = value < 0 ? "-" : "";
    if (amount == "0") return sign + size;
    return amount + (value < 0 ? " - " : " + ") + size;
}

/// The campaign with base, targets and errors copied by hand from an estimate: errors go into the
/// nominal amounts, if asked.
std::string copy_by_hand(const std::string& campaign, const Json& estimate, bool copies_errors) {
    std::istringstream lines(campaign);
    std::string text;
    for (std::string line; std::getline(lines, line);) {
        const auto bracket = line.find('[');
        if (copies_errors && line.starts_with("    - ") && bracket != std::string::npos) {
            const std::string name = line.substr(bracket + 1, line.find(']') - bracket - 1);
            const std::string amount = line.substr(9, bracket - 10);
            line =
                line.substr(0, 9) + add_error(amount, estimate["robot"][name]) + " [" + name + ']';
        } else if (line.starts_with("  targets:")) {
            line = "  targets: {position_mm: [";
            for (const Json& target : estimate["targets"]) {
                line += list(target["position_m"], 1e3) + ", ";
            }
            line += "]}";
        } else if (line.starts_with("base:")) {
            line = "base: {position_mm: " + list(estimate["base"]["position_m"], 1e3) +
                   ", rpy_deg: " + list(estimate["base"]["rpy_deg"], 1) + '}';
        }
        text += line + '\n';
    }
    return text;
}

/// Less the lines that name files or estimates, the bound that is searched only, and the answer
/// about errors left out, which an estimate has learned. Joints of a plan to a tenth of a degree:
/// they are where a flat optimum was found.
std::string without_names(const std::string& text) {
    static const std::regex hundredths(R"((\.\d)\d\b)");
    static const std::regex pose(R"(p\d+ .*)");
    std::istringstream lines(text);
    std::string kept;
    bool is_left_out = false;
    for (std::string line; std::getline(lines, line);) {
        is_left_out = line.starts_with("Errors left out") || (is_left_out && line.starts_with(' '));
        if (is_left_out) continue;
        if (std::regex_match(line, pose)) line = std::regex_replace(line, hundredths, "$1");
        if (line.starts_with("from:") || line.starts_with("plan:")) continue;
        if (line.starts_with("searched:")) continue;
        if (line.starts_with("            the poses that it is from do not count")) continue;
        kept += line + '\n';
    }
    return kept;
}

class From : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        campaign_ = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
        write_text("c.yaml", campaign_);
        run_well("simulate c.yaml --truth 7 --seed 3 --poses 30 --repeats 3 -o s.csv");
        run_well("calibrate c.yaml -m s.csv --folds 0 -o e.json");
        estimate_ = Json::parse(text_of("e.json"));
        write_text("hand.yaml", copy_by_hand(campaign_, estimate_, true));
    }

    void expect_same(const std::string& command, const std::string& options,
                     const std::string& beside = "") const {
        const Outcome outcome = run(command + " hand.yaml " + options + beside);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        const std::string& by_hand = outcome.out;
        const std::string from = run_well(command + " c.yaml --from e.json " + options);
        EXPECT_EQ(without_names(from), without_names(by_hand)) << command;
        EXPECT_NE(from.find("from:       e.json: base, targets, errors and model error"),
                  std::string::npos)
            << from;
    }

    std::string campaign_;
    Json estimate_;
};

TEST_F(From, IsWhatACampaignCopiedByHandIs) {
    expect_same("select", "--random 200 -k 9 --starts 3 --threads 1 -o p.json");
    expect_same("select", "--random 200 -k 9 --relax --digits 6");
    expect_same("plan", "-k 9 --pool 100 --starts 1 --workspace-poses 50 --threads 1 -o p.json");
    expect_same("indices", "-m s.csv");
    EXPECT_NE(run_well("indices c.yaml -m s.csv"), run_well("indices hand.yaml -m s.csv"));
    // A robot that is calibrated with these already is hardly made better by them.
    expect_same("study", "-m s.csv -k 9 --random 6 --splits 2 --threads 1", " --force");
}

TEST_F(From, InspectTakesBaseAndTargets) {
    write_text("hand.yaml", copy_by_hand(campaign_, estimate_, false));
    Json found = Json::parse(run_well("inspect c.yaml --from e.json --json"));
    Json by_hand = Json::parse(run_well("inspect hand.yaml --json"));
    const auto take_residual = [](Json& inspection) {  // what the file's mm and degrees round
        const double residual = inspection["least_kept_residual"].get<double>();
        inspection.erase("least_kept_residual");
        return residual;
    };
    EXPECT_NEAR(take_residual(found), take_residual(by_hand), 1e-12);
    EXPECT_EQ(found, by_hand);
    EXPECT_NE(run_well("inspect c.yaml --json"), run_well("inspect hand.yaml --json"));
    // The robot as it was found misses by its noise, the nominal one by its errors.
    const auto missed = [&](const std::string& options) {
        return Json::parse(run_well("inspect c.yaml -m s.csv --json" +
                                    options))["joint_directions"][0]["distance_rms_mm"]
            .get<double>();
    };
    EXPECT_LT(missed(" --from e.json"), 0.2);
    EXPECT_GT(missed(""), 1);
}

TEST_F(From, PlansForReRegistration) {
    const std::string out = run_well(
        "plan c.yaml --from e.json --only base,targets -k 5 --pool 300 --threads 1 -o p.json");
    EXPECT_NE(out.find("; to be identified: base, targets\n"), std::string::npos) << out;
    const Json plan = Json::parse(text_of("p.json"));
    EXPECT_EQ(plan["predicted"]["standard_deviation"].size(), 15U);
    EXPECT_EQ(plan["problem"]["estimate"]["only"], Json({"base", "targets"}));
    run_well("verify p.json");
    // Errors that are known widen nothing: five poses tell more than all errors' twenty-four.
    EXPECT_LT(plan["predicted"]["position_error_rms_m"].get<double>(), 2e-4);

    run_well("select c.yaml --from e.json --only base -m s.csv -k 3 -c d -o b.json");
    EXPECT_EQ(Json::parse(text_of("b.json"))["assumes"]["expected_error"].size(), 6U);
    run_well("verify b.json");
    expect_input_error("plan c.yaml --from e.json --only base,dq9 -k 5 -o q.json",
                       "'dq9' is no error of this robot");

    // The file that the plan was made from is found by its path, or where it is now.
    std::filesystem::rename(folder_ / "e.json", folder_ / "moved.json");
    expect_input_error("verify p.json", "e.json");
    run_well("verify p.json --from moved.json");
    Json other = estimate_;
    other["robot"]["dq3"]["value_rad"] = 0.05;
    write_text("moved.json", other.dump());
    const Outcome outcome = run("verify p.json --from moved.json");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("not as stated"), std::string::npos) << outcome.err;
}

TEST_F(From, AsPriorCountsWhatWasKnown) {
    const auto rms = [&](const std::string& options) {
        run_well("plan c.yaml -k 6 --pool 200 --starts 1 --workspace-poses 50 -o p.json " +
                 options);
        run_well("verify p.json");
        return Json::parse(text_of("p.json"))["predicted"]["position_error_rms_m"].get<double>();
    };
    const double anew = rms("--from e.json --prior");
    const double after = rms("--from e.json --as-prior");
    const double drifted = rms("--from e.json --as-prior --drift-offset-mrad 5 --drift-mm 1");
    EXPECT_LT(after, 0.5 * anew);
    EXPECT_GT(drifted, 1.2 * after);
    EXPECT_GT(rms("--from e.json --as-prior --moved base,targets"), after);
    EXPECT_EQ(run("plan c.yaml -k 6 --from e.json --as-prior --no-prior").code, 2);
    EXPECT_EQ(run("plan c.yaml -k 6 --as-prior").code, 2);
    EXPECT_EQ(run("study c.yaml -m s.csv --from e.json --models stated,full").code, 2);

    const Outcome twice = run("indices c.yaml -m s.csv --from e.json --as-prior");
    EXPECT_EQ(twice.code, 0);
    EXPECT_EQ(
        twice.err,
        "posewise: warning: e.json: was made from the measurements in s.csv; as a prior beside "
        "them it counts them twice\n");
    run_well("simulate c.yaml --truth 7 --seed 4 --poses 8 -o t.csv");
    const std::string known = run_well("indices c.yaml -m t.csv --from e.json --as-prior");
    EXPECT_GT(number_behind(known, "o3 "),
              number_behind(run_well("indices c.yaml -m t.csv"), "o3 "));
}

TEST_F(From, SaysWhatIsCountedTwiceOrNoValidation) {
    const auto warning_of = [&](const std::string& arguments) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return outcome.err;
    };
    const std::string twice =
        "posewise: warning: e.json: was made from the measurements in s.csv; as a prior beside "
        "them it counts them twice\n";
    const std::string as_prior = " --from e.json --as-prior ";
    const std::string calibrate = "calibrate c.yaml --folds 0 -m ";
    EXPECT_EQ(warning_of(calibrate + "s.csv --exclude 3,7:2" + as_prior), twice);
    EXPECT_EQ(warning_of("select c.yaml --random 50 -k 9 --starts 1 -o p.json --augment s.csv" +
                         as_prior),
              twice);
    EXPECT_EQ(warning_of("plan c.yaml -k 9 --pool 50 --starts 1 --workspace-poses 20 -o p.json "
                         "--augment s.csv" +
                         as_prior),
              twice);
    run_well(calibrate + "s.csv --exclude 3 -o less.json");
    EXPECT_NE(warning_of(calibrate + "s.csv --from less.json --as-prior"), "");
    run_well("simulate c.yaml --truth 7 --seed 4 --poses 8 -o t.csv");
    EXPECT_EQ(warning_of(calibrate + "t.csv" + as_prior), "");

    EXPECT_EQ(
        warning_of(calibrate + "s.csv --validate s.csv"),
        "posewise: warning: s.csv: it is calibrated from these very measurements; to validate "
        "takes others\n");
    EXPECT_NE(warning_of(calibrate + "s.csv --exclude 3 --validate s.csv"), "");
    EXPECT_EQ(warning_of(calibrate + "t.csv --validate s.csv" + as_prior),
              "posewise: warning: s.csv: e.json was made from these very measurements; to validate "
              "takes others\n");
    EXPECT_EQ(warning_of(calibrate + "t.csv --validate s.csv --from e.json"), "");
    EXPECT_EQ(warning_of(calibrate + "s.csv --validate t.csv"), "");
}

TEST_F(From, SaysWhatWasMovedSince) {
    std::string moved = campaign_;
    moved.replace(moved.find("-557.6"), 6, "-457.6");
    write_text("moved.yaml", moved);
    run_well("simulate moved.yaml --truth 7 --seed 4 --poses 8 -o t.csv");
    const std::string calibrate = "calibrate c.yaml -m t.csv --folds 0 --from e.json --as-prior";
    const Outcome outcome = run(calibrate + " --force --json");
    EXPECT_EQ(outcome.err.rfind("posewise: warning: t.csv: measured with another set-up than the "
                                "earlier estimate, base 100 mm from where that found it: --moved "
                                "base identifies it anew\n",
                                0),
              0U)
        << outcome.err;
    const Json since = Json::parse(outcome.out)["accuracy"]["moved_since_earlier"];
    EXPECT_EQ(since["parts"], Json({"base"}));
    EXPECT_NEAR(since["base_mm"].get<double>(), 100, 1);
    EXPECT_EQ(run(calibrate + " --moved base").code, 0);
}

TEST_F(From, CalibrateSaysWhatItGoesOnFrom) {
    run_well("simulate c.yaml --truth 7 --seed 4 --poses 8 -o t.csv");
    const std::string calibrate = "calibrate c.yaml -m t.csv --folds 0 --from e.json";
    EXPECT_NE(run_well(calibrate).find("from:       e.json: where it began\n"), std::string::npos);
    EXPECT_NE(run_well(calibrate + " --as-prior").find("; it is the prior, but for drift\n"),
              std::string::npos);
    const std::string only = run_well(calibrate + " --only base,targets -o o.json");
    EXPECT_NE(only.find("; to be identified: base, targets\n"), std::string::npos) << only;
    EXPECT_NE(only.find(", 15 of 33 parameters, the others held\n"), std::string::npos) << only;
    EXPECT_NE(only.find("Parameters identified (18 are held: "), std::string::npos) << only;
    const std::string table = only.substr(only.find("Parameters identified"),
                                          only.find("Strongest") - only.find("Parameters id"));
    EXPECT_NE(table.find("\nbase.x "), std::string::npos) << table;
    EXPECT_EQ(table.find("\ndq2 "), std::string::npos) << table;
    EXPECT_EQ(Json::parse(text_of("o.json"))["held"].size(), 18U);
    EXPECT_NE(run_well(calibrate + " --only base,targets --all-parameters").find("\ndq2 "),
              std::string::npos);
}

TEST_F(From, AsPriorTakesOnePose) {
    run_well("simulate c.yaml --truth 7 --seed 4 --poses 1 -o t.csv");
    run_well("calibrate c.yaml -m t.csv --from e.json --as-prior");
    run_well("indices c.yaml -m t.csv --from e.json --as-prior");
    run_well("select c.yaml --random 50 -k 3 --augment t.csv --from e.json --as-prior -o p.json");
}

TEST_F(From, WhatIsWrongNamesTheFileThatItIsIn) {
    run_well("simulate c.yaml --truth 7 --seed 4 --poses 1 -o one.csv");
    expect_input_error("calibrate c.yaml -m s.csv --validate one.csv --refit base,targets",
                       "posewise: one.csv: base and targets cannot be refitted: this "
                       "configuration with 3 points");
    expect_input_error("calibrate c.yaml -m s.csv --from e.json --only dq9",
                       "posewise: --only: 'dq9' is no error of this robot");
}

TEST_F(From, TakesTheSizesLearned) {
    run_well("calibrate c.yaml -m s.csv --prior --folds 0 -o l.json");
    const Json learned = Json::parse(text_of("l.json"));
    EXPECT_NE(learned["assumes"]["expected_error"]["Tx1_m"], 1e-3);
    run_well("select c.yaml --prior --from l.json --random 50 -k 9 --starts 2 -o p.json");
    const Json plan = Json::parse(text_of("p.json"));
    EXPECT_EQ(plan["assumes"]["expected_error"], learned["assumes"]["expected_error"]);
    EXPECT_EQ(plan["assumes"]["model_error_m"], learned["model_error_m"]);
    // And hands them on.
    run_well("calibrate c.yaml -m s.csv --prior --from l.json --folds 0 -o again.json");
    EXPECT_EQ(Json::parse(text_of("again.json"))["learned_sizes"], learned["learned_sizes"]);
}

TEST_F(From, RefusesAnotherRobotAndWhatIsNoCalibration) {
    std::string other = campaign_;
    other.replace(other.find("1075 mm"), 7, "1175 mm");
    write_text("other.yaml", other);
    ASSERT_EQ(
        run("calibrate c.yaml -m s.csv --folds 0 --max-iterations 1 --force -o bad.json").code, 0);
    for (const std::string command : {"select", "plan", "indices", "study", "inspect"}) {
        const bool measures = command == "indices" || command == "study";
        const std::string options = command == "select" ? " --random 50 -k 9 -o q.json"
                                    : command == "plan" ? " -k 9 --pool 50 -o q.json"
                                    : measures          ? " -m s.csv"
                                                        : "";
        expect_input_error(command + " other.yaml --from e.json" + options,
                           "the estimate is of another robot");
        expect_input_error(command + " c.yaml --from bad.json" + options,
                           "bad.json: is no calibration to use: it did not converge");
    }
    const Outcome forced = run("indices c.yaml -m s.csv --from bad.json --force");
    EXPECT_EQ(forced.code, 0);
    EXPECT_NE(forced.err.find("did not converge"), std::string::npos) << forced.err;
    EXPECT_EQ(run("inspect robot.urdf --from e.json").code, 1);
}

TEST_F(From, SaysWhatItWasMadeFromAndWhatDiffersNow) {
    const Json& made_from = estimate_["made_from"];
    EXPECT_EQ(made_from["campaign_file"], "c.yaml");
    EXPECT_EQ(made_from["options"],
              Json::parse(R"({"--measurements": ["s.csv"], "--folds": ["0"]})"));
    EXPECT_TRUE(made_from["campaign_checksum"].get<std::string>().starts_with("fnv1a64:"));
    run_well("calibrate c.yaml -m s.csv --folds 0 --threads 1 -o again.json");
    EXPECT_EQ(text_of("again.json"), text_of("e.json"));
    run_well("simulate c.yaml --truth 7 --seed 4 --poses 30 --repeats 3 -o t.csv");
    run_well("calibrate c.yaml -m t.csv --folds 0 -o t.json");
    EXPECT_NE(Json::parse(text_of("t.json"))["made_from"]["measurements_checksum"],
              made_from["measurements_checksum"]);
    std::string noisier = campaign_;
    noisier.replace(noisier.find("0.052"), 5, "0.104");
    write_text("noisier.yaml", noisier);
    const Outcome outcome = run("inspect noisier.yaml --from e.json");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(
        outcome.err,
        "posewise: warning: e.json: the campaign file said otherwise when it was made: sigma_m "
        "was 5.2e-05, is 0.000104\n");
}

TEST_F(From, OtherTargetsAfterAMove) {
    std::string one = campaign_;
    const auto begin = one.find("  targets:");
    one.replace(begin, one.find('\n', begin) - begin, "  targets: {position_mm: [[300, 20, 80]]}");
    one.replace(one.find("-557.6"), 6, "1557.6");
    one.erase(one.find("measurements:"));  // of MATLAB files of three targets
    write_text("one.yaml", one);
    run_well("simulate one.yaml --truth 7 --seed 5 --poses 20 --repeats 2 -o one.csv");
    const std::string only = " --from e.json --only base,targets";
    expect_input_error("calibrate one.yaml -m one.csv -o o.json" + only, "parameters");
    const std::string out =
        run_well("calibrate one.yaml -m one.csv --folds 0 -o o.json --moved base,targets" + only);
    EXPECT_LT(number_behind(out, "distance RMS", 1), 0.3);
    EXPECT_GT(number_behind(out, "distance RMS", 0), 1);
    const Json found = Json::parse(text_of("o.json"));
    EXPECT_EQ(found["robot"]["dq2"]["value_rad"], estimate_["robot"]["dq2"]["value_rad"]);

    const std::string validate = "calibrate c.yaml -m s.csv --folds 0 --validate one.csv ";
    const std::string judged =
        run_well(validate + "--validate-campaign one.yaml --refit base,targets --json");
    EXPECT_NEAR(Json::parse(judged)["accuracy"]["validation"]["distance_rms_mm"].get<double>(),
                found["accuracy"]["fit"]["distance_rms_mm"].get<double>(), 1e-6);
    const std::string text =
        run_well(validate + "--validate-campaign one.yaml --refit base,targets");
    const std::string refitted = text.substr(text.find("Refitted to the validation"));
    EXPECT_NEAR(number_behind(refitted, "target1.x"), 300, 5);
    const double sigma = number_behind(refitted, "target1.x", 2);  // behind mm
    EXPECT_GT(sigma, 0.01);
    EXPECT_LT(sigma, 1);
    const Json there = Json::parse(judged)["refitted"];
    EXPECT_NEAR(1e3 * there["sigma"]["target1.x_m"].get<double>(), sigma, 1e-4);
    EXPECT_NEAR(1e3 * there["targets"]["target1"]["position_m"][0].get<double>(),
                number_behind(refitted, "target1.x"), 1e-4);
    EXPECT_TRUE(there["sigma"].contains("base.rx_rad")) << there;
    EXPECT_FALSE(there.contains("robot"));
    EXPECT_GT(refitted.find("target2.x"), refitted.find("Parameters")) << "it has one target";
    expect_input_error(validate + "--validate-campaign one.yaml --refit base",
                       "both base and targets");
    EXPECT_EQ(run(validate + "--validate-campaign one.yaml").code, 2);
    std::string other = one;
    other.replace(other.find("1075 mm"), 7, "1175 mm");
    write_text("other.yaml", other);
    expect_input_error(validate + "--validate-campaign other.yaml --refit base,targets",
                       "must state the same robot");
}

}  // namespace
}  // namespace posewise::testing
