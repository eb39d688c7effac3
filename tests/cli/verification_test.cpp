#include <nlohmann/json.hpp>

#include "program.hpp"

/// Poses to judge a calibration on: planned, measured and judged, as a user does it.
namespace posewise::testing {
namespace {

const std::string quick = " --pool 500 --starts 1 --workspace-poses 50 ";

class VerificationPoses : public Program {
  protected:
    nlohmann::json json_of(const std::string& name) const {
        return nlohmann::json::parse(text_of(name));
    }
    /// p.json and p.csv of 14 poses and 6 more to verify, measured in m.csv.
    void plan_and_measure() const {
        run_well("plan " + fanuc_design + " -k 14 --verification 6" + quick +
                 "-o p.json --csv p.csv");
        run_well("simulate " + fanuc_design + " --configurations p.csv --truth 3 -o m.csv");
    }
};

TEST_F(VerificationPoses, AreMarkedInThePlanAndItsCsv) {
    const std::string text = run_well("plan " + fanuc_design + " -k 14 --verification 6" + quick +
                                      "-o p.json --csv p.csv");
    EXPECT_NE(text.find("\nverify:      6 poses drawn to judge the calibration on, "),
              std::string::npos)
        << text;
    const auto plan = json_of("p.json");
    EXPECT_EQ(plan.at("poses").size(), 14U);
    EXPECT_EQ(plan.at("verification").size(), 6U);
    EXPECT_EQ(plan.at("problem").at("verification_count"), 6);
    std::istringstream csv(text_of("p.csv"));
    std::string line;
    std::getline(csv, line);
    EXPECT_TRUE(line.ends_with(",visible_targets,purpose,way")) << line;
    int verify = 0;
    for (int row = 0; std::getline(csv, line); ++row) {
        EXPECT_EQ(line.front(), row < 14 ? 'p' : 'v') << line;
        EXPECT_TRUE(line.ends_with(row < 14 ? ",calibrate,straight" : ",verify,straight")) << line;
        verify += row < 14 ? 0 : 1;
    }
    EXPECT_EQ(verify, 6);
    run_well("verify p.json");
}

TEST_F(VerificationPoses, AreNeverCalibratedWithAndJudgedByThemselves) {
    plan_and_measure();
    const std::string text = run_well("calibrate " + fanuc_design +
                                      " -m m.csv --plan p.json --limit-mm 5 --folds 0 -o e.json");
    EXPECT_NE(text.find(": 14 configurations, "), std::string::npos) << text;
    EXPECT_NE(text.find("\nverification, "), std::string::npos) << text;
    EXPECT_NE(text.find(", limit 5 mm: pass; "), std::string::npos) << text;
    EXPECT_EQ(text.find("not in plan"), std::string::npos) << text;
    const auto accuracy = json_of("e.json").at("accuracy");
    EXPECT_EQ(accuracy.at("limit_mm"), 5);
    EXPECT_EQ(accuracy.at("verification").at("point_count"), 6 * 3);
    std::size_t count = 0;
    for (const auto& group : accuracy.at("judged")) {
        EXPECT_EQ(group.at("poses"), "verification");
        EXPECT_EQ(group.at("limit"), "pass");
        EXPECT_LT(group.at("lower_mm"), group.at("rms_mm"));
        EXPECT_GT(group.at("upper_mm"), group.at("rms_mm"));
        count += group.at("configuration_count").get<std::size_t>();
    }
    EXPECT_EQ(count, 6U);
}

TEST_F(VerificationPoses, OneThatWasMisreadIsNamedAndPosesOfThePlanMayBeMissing) {
    plan_and_measure();
    std::string measured = text_of("m.csv");
    const auto begin = measured.find("\nv1,");
    const auto end = measured.find('\n', begin + 1);
    std::string row = measured.substr(begin, end - begin);
    row.replace(row.rfind(','), std::string::npos, ",0");
    write_text("zero.csv", measured.substr(0, begin) + row + measured.substr(end));
    const std::string calibrate = "calibrate " + fanuc_design + " --plan p.json --folds 0 -m ";
    const Outcome misread = run(calibrate + "zero.csv -o z.json");
    EXPECT_EQ(misread.code, 0) << misread.err;
    EXPECT_NE(misread.err.find("poses to verify: most of what they are missed by is of 'v1': "),
              std::string::npos)
        << misread.err;
    const std::string& text = misread.out;
    EXPECT_NE(text.find("beyond chance (up to"), std::string::npos) << text;
    EXPECT_NE(text.find("most of it is of 'v1', the others have 0."), std::string::npos) << text;
    EXPECT_EQ(json_of("z.json").at("accuracy").at("judged").at(0).at("worst"), "v1");

    const auto lost = measured.find("\np3,");
    measured.erase(lost, measured.find('\n', lost + 1) - lost);
    write_text("lost.csv", measured);
    const Outcome outcome = run(calibrate + "lost.csv");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err,
              "posewise: warning: p.json: 1 of 14 poses are not among the measured ones: 'p3'\n");
    EXPECT_NE(outcome.out.find(": 13 configurations, "), std::string::npos) << outcome.out;
    EXPECT_NE(run_well(calibrate + "m.csv --exclude p2-p3").find(": 12 configurations, "),
              std::string::npos);
}

TEST_F(VerificationPoses, OfAnotherFileThatWereCalibratedWithAreNotJudged) {
    plan_and_measure();
    run_well("simulate " + fanuc_design +
             " --configurations p.csv --truth 3 --seed 8 -o again.csv");
    const std::string text = run_well("calibrate " + fanuc_design +
                                      " -m m.csv --validate again.csv --limit-mm 5 --folds 0");
    EXPECT_NE(text.find("\nvalidation, 20 poses calibrated with: RMS "), std::string::npos) << text;
    EXPECT_NE(text.find(", limit 5 mm: not judged; "), std::string::npos) << text;
    EXPECT_EQ(text.find("within chance"), std::string::npos) << text;
}

TEST_F(VerificationPoses, AreNeededForALimit) {
    plan_and_measure();
    expect_input_error("calibrate " + fanuc_design + " -m m.csv --limit-mm 0.2",
                       "m.csv: --limit-mm needs poses that are not calibrated with: --validate, or "
                       "--plan with");
    expect_input_error(
        "plan " + fanuc_design + quick + "--plan p.json --drop v2 -o r.json",
        "--drop v2: is a pose to verify, which need not be replaced; leave it out of what is");
}

TEST_F(VerificationPoses, AreFewerWithAWarningWhereThePoolHasNoMore) {
    const Outcome outcome =
        run("plan " + fanuc_design +
            " -k 14 --verification 60 --pool 50 --starts 1 --workspace-poses 50 -o p.json");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.err.find("warning: --verification is 60, only "), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find(" poses are feasible and far enough from all others; raise --pool"),
              std::string::npos)
        << outcome.err;
}

}  // namespace
}  // namespace posewise::testing
