#include "program.hpp"

/// calibrate --method global: a campaign file whose lengths and angles are far off.
namespace posewise::testing {
namespace {

class Global : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design + " --poses 24 --truth 5 -o m.csv");
    }
};

TEST_F(Global, FindsTheRobotFromABadCampaignFile) {
    std::string design = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const auto replace = [&](const std::string& part, const std::string& by) {
        ASSERT_NE(design.find(part), std::string::npos) << part;
        design.replace(design.find(part), part.size(), by);
    };
    replace("Tx 312 mm", "Tx 400 mm");
    replace("Tz 1075 mm", "Tz 800 mm");
    replace("Tx 1280 mm", "Tx 1600 mm");
    replace("Ry q2 [dq2]", "Ry q2 + 18 deg [dq2]");
    replace("Ry -q3 [dq3]", "Ry -q3 - 19 deg [dq3]");
    replace("Ry -q5 [dq5]", "Ry -q5 + 17 deg [dq5]");
    write_text("bad.yaml", design);
    const std::string right = run_well("calibrate " + fanuc_design + " -m m.csv");
    const Outcome found = run("calibrate bad.yaml -m m.csv --method global -o e.json");
    EXPECT_EQ(found.code, 0) << found.err;
    EXPECT_NE(found.out.find(" of them ended at the best\n"), std::string::npos) << found.out;
    EXPECT_NE(found.out.find("global: converged"), std::string::npos) << found.out;
    EXPECT_GT(number_behind(found.out, "distance RMS"), 50);
    for (const std::size_t column : {1U, 3U}) {  // calibrated, held out
        EXPECT_NEAR(number_behind(found.out, "distance RMS", column),
                    number_behind(right, "distance RMS", column), 1e-3);
    }
    EXPECT_NEAR(number_behind(found.out, "Tx3"), number_behind(right, "Tx3") - 320, 0.01);
    EXPECT_EQ(run("calibrate bad.yaml -m m.csv --method global", "OMP_NUM_THREADS=1").out,
              found.out);
}

TEST_F(Global, RefusesAPriorOfSmallErrors) {
    expect_input_error("calibrate " + fanuc_design + " -m m.csv --method global --prior",
                       "must be without them (prior: false)");
    EXPECT_EQ(run("calibrate " + fanuc_design + " -m m.csv --method global --starts 0").code, 2);
    EXPECT_EQ(run("calibrate " + fanuc_design + " -m m.csv --method global --loss huber").code, 2);
}

}  // namespace
}  // namespace posewise::testing
