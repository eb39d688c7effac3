#include "program.hpp"

/// Real robots calibrated on one campaign and judged on another, through the program; the figures
/// are those of independent fits. The data are not ours to ship.
namespace posewise::testing {
namespace {

const std::string meca =
    "  joints: {q1: {limits_deg: [-175, 175]}, q2: {limits_deg: [-70, 90]},"
    " q3: {limits_deg: [-135, 70]}, q4: {limits_deg: [-170, 170]},"
    " q5: {limits_deg: [-115, 115]}, q6: {limits_deg: [-400, 400]}}\n"
    "  elements: [Rz q1, Tz 135 mm, Ry q2, Tz 135 mm, Ry q3, Tz 38 mm, Tx 120 mm, Rx q4,"
    " Ry q5, Rx q6]\n"
    "sensor: {kind: points, sigma_mm: 0.005, targets: {count: 1}}\n";

const std::string motoman =
    "  joints: {q1: {limits_deg: [-170, 170]}, q2: {limits_deg: [-90, 155]},"
    " q3: {limits_deg: [-175, 190]}, q4: {limits_deg: [-150, 150]},"
    " q5: {limits_deg: [-45, 180]}, q6: {limits_deg: [-200, 200]}}\n"
    "  elements: [Rz q1, Tz 1415.9 mm, Tx 150 mm, Rx -90 deg, Rz q2 - 90 deg, Tx 614 mm,"
    " Rx 180 deg, Rz q3, Tx 200 mm, Rx -90 deg, Rz q4, Tz -640 mm, Rx 90 deg, Rz q5 - 90 deg,"
    " Tx 30 mm, Rx 90 deg, Rz q6, Tz 200 mm]\n"
    "sensor: {kind: points, sigma_mm: 0.03, targets: {count: 1}}\n";

const std::string iiwa =
    "  joints: {q1: {limits_deg: [-170, 170]}, q2: {limits_deg: [-120, 120]},"
    " q3: {limits_deg: [-170, 170]}, q4: {limits_deg: [-120, 120]},"
    " q5: {limits_deg: [-170, 170]}, q6: {limits_deg: [-120, 120]},"
    " q7: {limits_deg: [-175, 175]}}\n"
    "  elements: [Rz q1, Tz 340 mm, Rx -90 deg, Rz q2, Rx 90 deg, Rz q3 + 180 deg, Tz 400 mm,"
    " Rx -90 deg, Rz q4, Rx 90 deg, Rz q5 + 180 deg, Tz 400 mm, Rx -90 deg, Rz q6, Rx 90 deg,"
    " Rz q7, Tz 126 mm]\n"
    "sensor: {kind: poses, sigma_mm: 0.05, sigma_orientation_mrad: 0.2}\n";

const std::string measured_compliance =
    "\n  compliance: {torques_Nm: {q1: 200, q2: 200, q3: 100, q4: 100, q5: 50, q6: 20, q7: 10}}";

class OtherCampaigns : public Program {
  protected:
    /// RMS (mm) of `other` by a robot with these errors, calibrated on `campaign`.
    double judged_on(const std::string& other, const std::string& campaign,
                     const std::string& errors, const std::string& robot,
                     const std::string& options = "--refit base,targets") const {
        const std::string data = real_data() + "/";
        write_text("c.yaml", "name: c\nrobot:\n  errors: " + errors + "\n" + robot);
        const Outcome outcome = run("calibrate c.yaml --no-prior --folds 0 -m " + data + campaign +
                                    " --validate " + data + other + ' ' + options);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return number_behind(outcome.out, "distance RMS", 3);
    }

    void SetUp() override {
        Program::SetUp();
        if (!std::filesystem::exists(real_data() + "/meca500")) {
            GTEST_SKIP() << "no real campaigns at POSEWISE_REAL_DATA = " << real_data();
        }
    }
};

TEST_F(OtherCampaigns, OfAMeca500AreFittedAsMeasuredInTheSameFrames) {
    EXPECT_NEAR(judged_on("meca500/small.csv", "meca500/large.csv", "geometric", meca, ""), 0.0562,
                0.00005);
}

TEST_F(OtherCampaigns, OfAMotomanAreWorseByGeometryAloneThanNominal) {
    const std::string grid = "motoman_ma1400/grid.csv";
    const std::string all = "motoman_ma1400/measurements.csv";
    EXPECT_NEAR(judged_on(grid, all, "stated", motoman), 0.246, 0.0005);
    EXPECT_NEAR(judged_on(grid, all, "geometric", motoman), 0.333, 0.0005);
    EXPECT_NEAR(judged_on(grid, all, "geometric\n  gravity: true", motoman), 0.165, 0.0006);
}

TEST_F(OtherCampaigns, OfAnIiwaUnderLoadsAreFittedByMeasuredTorques) {
    const std::string all = "kuka_iiwa7/measurements.csv";
    const std::string compliant = "geometric" + measured_compliance;
    EXPECT_NEAR(judged_on("kuka_iiwa7/payload_0kg.csv", all, "geometric", iiwa), 1.43, 0.006);
    EXPECT_NEAR(judged_on("kuka_iiwa7/payload_2.5kg.csv", all, "geometric", iiwa), 1.82, 0.006);
    EXPECT_LE(judged_on("kuka_iiwa7/payload_0kg.csv", all, compliant, iiwa), 0.645);
    EXPECT_LE(judged_on("kuka_iiwa7/payload_2.5kg.csv", all, compliant, iiwa), 0.835);
}

}  // namespace
}  // namespace posewise::testing
