#include "program.hpp"

/// The published campaign on the FANUC R-2000iC/165F, through the program; the figures are those of
/// independent fits. The data are not ours to ship.
namespace posewise::testing {
namespace {

class Fanuc : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        const std::string folder = real_data() + "/fanuc_r2000ic_165f";
        if (!std::filesystem::exists(folder + "/measurements.csv")) {
            GTEST_SKIP() << "no real campaign at POSEWISE_REAL_DATA = " << real_data();
        }
        csv_ = fanuc_design + " -m '" + folder + "/measurements.csv' ";
        mat_ = fanuc_design + " -m '" + folder + "/calibration_dataset.mat' ";
    }
    std::string csv_;
    std::string mat_;
};

TEST_F(Fanuc, CalibrationReachesTheKnownFigures) {
    for (const std::string& input : {csv_, mat_}) {
        const std::string text = run_well("calibrate " + input);
        EXPECT_NE(text.find("lm: converged"), std::string::npos);
        EXPECT_NEAR(number_behind(text, "distance RMS", 1), 0.1607, 1e-4);
        EXPECT_NEAR(number_behind(text, "distance max", 1), 0.3271, 2e-4);
        EXPECT_NEAR(number_behind(text, "distance RMS", 2), 0.1363, 1e-4);  // means
        EXPECT_NEAR(number_behind(text, "distance RMS", 4), 0.2342, 5e-4);  // held-out means
        EXPECT_NEAR(number_behind(text, "noise floor from repeats:"), 0.05185, 1e-5);
    }
}

TEST_F(Fanuc, GravityTermsReachTheKnownFigures) {
    const std::string design =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const std::string measured = csv_.substr(fanuc_design.size());
    std::string text = design;
    write_text("six.yaml", text.insert(text.find("  elements:"), "  gravity: true\n"));
    const std::string six = run_well("calibrate six.yaml" + measured);
    EXPECT_NEAR(number_behind(six, "distance RMS", 2), 0.0964, 0.0005);
    EXPECT_NEAR(number_behind(six, "distance RMS", 4), 0.173, 0.002);
    // The weights of arm and forearm on joint 2 alone, in the notation of elements.
    text = design;
    const std::string shoulder = "Ry q2 [dq2]";
    text.insert(text.find(shoulder) + shoulder.size(),
                " [arm*sin(q2)] [forearm*cos(q2 - q3 - 28.19 deg)]");
    write_text("two.yaml", text);
    const std::string two = run_well("calibrate two.yaml" + measured);
    EXPECT_NEAR(number_behind(two, "distance RMS", 1), 0.1316, 0.0005);
    EXPECT_NEAR(number_behind(two, "distance RMS", 2), 0.1003, 0.0003);
}

TEST_F(Fanuc, ModelSelectionTakesGravityTermsAndNoHarmonics) {
    std::string text = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    text.insert(text.find("  elements:"),
                "  gravity: true\n  harmonics: {orders: [1, 2], joints: [q4]}\n");
    write_text("all.yaml", text);
    const std::string report =
        run_well("calibrate all.yaml --model-selection" + csv_.substr(fanuc_design.size()));
    EXPECT_NEAR(number_behind(report, "+ joint offsets", 2), 0.560, 0.002);
    EXPECT_NEAR(number_behind(report, "+ other geometric", 2), 0.2342, 5e-4);
    EXPECT_NEAR(number_behind(report, "+ gravity terms", 2), 0.1731, 5e-4);
    EXPECT_NEAR(number_behind(report, "+ gravity terms", 3), 0.023, 0.001);
    const auto mark = report.find("recommended");
    EXPECT_EQ(report.rfind("\n+ ", mark), report.find("\n+ gravity terms"));
}

TEST_F(Fanuc, HasNoOutliers) {
    EXPECT_NE(run_well("calibrate " + csv_ + "--loss cauchy --folds 0").find(": 0 outliers"),
              std::string::npos);
}

TEST_F(Fanuc, TwoStepComesNearTheSameOptimumAndSaysSo) {
    const std::string text =
        run("calibrate " + csv_ + "--method two-step --max-iterations 200 --folds 0").out;
    EXPECT_LE(number_behind(text, "distance RMS", 2), 0.1378);
    EXPECT_GE(number_behind(text, "distance RMS", 2), 0.1362);
    EXPECT_NE(text.find("two-step: iteration limit after 200"), std::string::npos);
}

TEST_F(Fanuc, SixOptimalConfigurationsDoAsWellAsTwelveRandomOnes) {
    const std::string text = run_well("study " + csv_ + "--criteria d --random 200 --poses 6,12");
    EXPECT_NEAR(number_behind(text, "6 ", 0), 0.287, 0.01);
    EXPECT_GT(number_behind(text, "6 ", 2), 1.0);  // random median
    EXPECT_NEAR(number_behind(text, "12 ", 2), 0.283, 0.02);
    EXPECT_GT(number_behind(text, "6 ", 5), 0);  // many sixes have q1 = 45 deg throughout
}

}  // namespace
}  // namespace posewise::testing
