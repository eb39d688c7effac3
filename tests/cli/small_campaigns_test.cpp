#include "program.hpp"

/// Robots of few joints, campaigns of few poses, and what is said of those that cannot be
/// calibrated.
namespace posewise::testing {
namespace {

const std::string two_joints = R"(name: two
robot:
  errors: geometric
  joints: {q1: {limits_deg: [-120, 120]}, q2: {limits_deg: [-120, 120]}}
  elements: [ELEMENTS]
base: {position_mm: [2500, -1000, 400], rpy_deg: [5, -10, 40]}
sensor:
  kind: points
  sigma_mm: 0.05
  targets: {position_mm: [[120, 30, 50]]KNOWN}
model_error_mm: 0.05
)";

const std::string six = "name: six\nrobot:\n" + six_joints +
                        "base: {position_mm: [1000, 200, 30], rpy_deg: [0, 0, 90]}\n";

const std::string one_target = six + R"(sensor:
  kind: points
  sigma_mm: 0.05
  targets: {position_mm: [[120, 30, 50]]}
)";

const std::string planes = six + R"(sensor:
  kind: planes
  sigma_mm: 0.01
  planes: [{normal: [0, 0, 1], offset_mm: 300}, {normal: [1, 0, 0], offset_mm: 900}, {normal: [0.1, 1, 0], offset_mm: 700}]
  targets: {position_mm: [[0, 0, 150]]}
)";

const std::string anchor = six + R"(sensor:
  kind: distances
  sigma_mm: 0.01
  anchors: {position_mm: [[2000, 500, 0]]}
  targets: {position_mm: [[0, 0, 150]]}
)";

std::string replaced(std::string text, const std::string& part, const std::string& by) {
    return text.replace(text.find(part), part.size(), by);
}

std::string two_joint_campaign(const std::string& elements, const std::string& known = "") {
    return replaced(replaced(two_joints, "ELEMENTS", elements), "KNOWN", known);
}

class SmallCampaign : public Program {
  protected:
    /// Writes c.yaml and simulates s.csv with it.
    void prepare(const std::string& campaign, int poses) const {
        write_text("c.yaml", campaign);
        run_well("simulate c.yaml --poses " + std::to_string(poses) + " -o s.csv");
    }
    /// Distance RMS after calibration, mm. Few errors may gain nothing that shows.
    double calibrated() const {
        const Outcome outcome = run("calibrate c.yaml -m s.csv");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return number_behind(outcome.out, "distance RMS", 1);
    }
};

TEST_F(SmallCampaign, OfTwoJointsIsCalibrated) {
    const std::string planar = "Rz q1, Tx 500 mm, Rz q2, Tx 400 mm";
    const std::string upright = "Rz q1, Tz 300 mm, Ry q2, Tx 400 mm";
    const double noise = 0.13;  // mm: of sensor and model, in three coordinates
    for (const std::string& campaign :
         {two_joint_campaign(upright), two_joint_campaign(planar, ", known: [z]"),
          two_joint_campaign("Rz q1, Ry q2")}) {
        prepare(campaign, 60);
        EXPECT_LT(calibrated(), noise) << campaign;
        prepare(replaced(campaign, "geometric", "full"), 60);
        EXPECT_LT(calibrated(), noise) << campaign;
    }
    prepare(two_joint_campaign(planar), 60);
    const std::string text = run_well("inspect c.yaml");
    EXPECT_NE(text.find("No number of poses tells target1.z; calibrate needs what is known stated: "
                        "base.known or sensor.targets.known\n"),
              std::string::npos)
        << text;
    expect_input_error("calibrate c.yaml -m s.csv",
                       "known: [z], keys base.known or sensor.targets.known");
}

TEST_F(SmallCampaign, IsCalibratedWithAsManyPosesAsInspectAndPlanPromise) {
    write_text("c.yaml", one_target);
    EXPECT_EQ(number_behind(run_well("inspect c.yaml"), "least number of poses:"), 5);
    const std::string plan = "plan c.yaml --pool 300 --workspace-poses 50 --poses ";
    expect_input_error(plan + "4",
                       "--poses is 4, must be at least 5: fewer are not enough to register base");
    expect_input_error("select c.yaml --random 50 -k 4",
                       "--poses is 4, must be at least 5: fewer are not enough to register base");
    const std::string others = run_well(plan + "8");
    EXPECT_NE(others.find("  4  chosen from the pool       -  "), std::string::npos) << others;
    run_well(plan + "5 --csv p.csv");
    run_well("simulate c.yaml --configurations p.csv -o s.csv");
    // So few poses may leave doubts.
    const Outcome outcome = run("calibrate c.yaml -m s.csv --folds 0");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(SmallCampaign, SaysWhichKeyStatesWhatNoPoseTells) {
    prepare(planes, 40);
    expect_input_error("calibrate c.yaml -m s.csv",
                       "known: base.known, sensor.targets.known or sensor.known_planes");
    write_text("c.yaml", replaced(planes, "position_mm: [[0, 0, 150]]", "count: 1"));
    expect_input_error("calibrate c.yaml -m s.csv", "keys base and sensor.targets.position_mm");
    prepare(anchor, 40);
    expect_input_error("calibrate c.yaml -m s.csv",
                       "known: base.known, sensor.targets.known or sensor.anchors.known");
}

TEST_F(SmallCampaign, IsInspectedWithAllErrorsThatAreCalibrated) {
    prepare(one_target, 30);
    const std::string text = run_well("inspect c.yaml");
    const std::string classes = text.substr(text.find("that are calibrated, by class"));
    const std::string found = run_well("calibrate c.yaml -m s.csv --folds 0");
    double sum = 0;
    for (const std::string name :
         {"lengths", "angles of axes", "joint offsets", "torque shapes", "harmonics"}) {
        const double count = number_behind(classes, name);
        EXPECT_EQ(count, number_behind(found, name)) << name;
        sum += count;
    }
    EXPECT_EQ(number_behind(classes, "calibrated:"), sum) << classes;
    EXPECT_NE(found.find(std::to_string(static_cast<int>(sum) + 9) + " parameters"),
              std::string::npos);
}

TEST_F(SmallCampaign, OfOnePoseIsCountedAsOne) {
    write_text("c.yaml", one_target);
    const std::string text = run_well("simulate c.yaml --poses 1 -o s.csv");
    EXPECT_EQ(text.find("1 configuration, 1 sample: s.csv\n"), 0U) << text;
    expect_input_error("calibrate c.yaml -m s.csv",
                       "this configuration with 1 point does not determine base and targets;");
}

}  // namespace
}  // namespace posewise::testing
