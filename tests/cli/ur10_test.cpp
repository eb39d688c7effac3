#include "program.hpp"

/// The published campaign on the UR10, full poses, through the program; the figures are those of
/// independent fits. The data are not ours to ship.
namespace posewise::testing {
namespace {

class Ur10 : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        csv_ = real_data() + "/ur10_ipa/measurements.csv";
        if (!std::filesystem::exists(csv_)) {
            GTEST_SKIP() << "no real campaign at POSEWISE_REAL_DATA = " << real_data();
        }
    }

    const std::string design_ = read_text(source_folder() + "/designs/ur10/campaign.yaml");
    std::string csv_;
};

TEST_F(Ur10, CalibratesGeometricallyFromPositionsAndOrientations) {
    write_text("c.yaml", design_);
    const std::string report = run_well("calibrate c.yaml --folds 10 -m '" + csv_ + "'");
    EXPECT_NE(report.find(" 30 parameters"), std::string::npos);
    EXPECT_NEAR(number_behind(report, "distance RMS"), 1.085, 0.0005);
    EXPECT_NEAR(number_behind(report, "distance RMS", 1), 0.4453, 0.0001);
    EXPECT_NEAR(number_behind(report, "turn RMS/mrad", 1), 0.895, 0.0005);
    EXPECT_LE(number_behind(report, "distance RMS", 3), 0.447 * 1.02);
}

TEST_F(Ur10, IsThreeTimesAsAccurateWithJointMapsAndGravity) {
    write_text("c.yaml", read_text(source_folder() + "/designs/ur10/joint_maps.yaml"));
    const Outcome outcome = run("calibrate c.yaml --folds 4 -m '" + csv_ + "'");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    // Four of 1 042 configurations have half of the squares.
    EXPECT_NE(outcome.err.find("configurations 855, 854, 532, 1063 do not fit the others"),
              std::string::npos)
        << outcome.err;
    const std::string& report = outcome.out;
    EXPECT_LT(number_behind(report, "distance RMS", 1), 0.135);
    EXPECT_LT(number_behind(report, "distance RMS", 3), 0.147);  // with ten folds 0.1447
    EXPECT_NEAR(number_behind(report, "variance factor"), 0.87, 0.05);
}

TEST_F(Ur10, SaysThatTheOrderOfTheQuaternionIsWrong) {
    write_text("c.yaml", design_);
    std::string csv = read_text(csv_);
    const std::string right = "qw,qx,qy,qz";
    csv.replace(csv.find(right), right.size(), "qx,qy,qz,qw");
    write_text("m.csv", csv);
    const auto outcome = run("calibrate c.yaml --folds 0 -m m.csv");
    EXPECT_NE(outcome.err.find("with the number called qx as its real part ("), std::string::npos)
        << outcome.err;
}

/// Its axes 2, 3 and 4 are parallel to within 2 mrad: common normals are up to 1 km away.
TEST_F(Ur10, IsExportedWithLinksAsLongAsTheyAre) {
    write_text("c.yaml", design_);
    run_well("calibrate c.yaml --folds 0 -o e.json -m '" + csv_ + "'");
    const std::string text = run_well("export c.yaml e.json --dh d.yaml --ur-kinematics k.yaml");
    EXPECT_NE(text.find("rows 2, 3: RotZ(theta) TransX(a) RotX(alpha) RotY(beta) (Hayati)"),
              std::string::npos)
        << text;
    EXPECT_LT(number_behind(text, "k.yaml read back: the flange is within"), 1e-12);
    const std::string frames = text_of("k.yaml");
    EXPECT_NE(frames.find("  upper_arm:\n    x: 0.000"), std::string::npos) << frames;
    EXPECT_NE(frames.find("  forearm:\n    x: -0.6132"), std::string::npos) << frames;
    EXPECT_NE(text_of("d.yaml").find("joint: q3, a_mm: -572.1"), std::string::npos);
}

}  // namespace
}  // namespace posewise::testing
