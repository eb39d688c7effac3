#include <filesystem>

#include "program.hpp"

/// Inputs of others that went wrong in silence, beside the real campaigns; skipped where they are
/// not.
namespace posewise::testing {
namespace {

/// A command on such files, its exit code, and what it says: on standard error, which is empty
/// where nothing is, and in what it prints.
struct Case {
    std::string name;
    std::string command;
    int code;
    std::string said;
    std::string printed;
};

std::ostream& operator<<(std::ostream& out, const Case& one) { return out << one.name; }

class CaseFiles : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        const std::filesystem::path folder = real_data() + "/../cases";
        if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no cases at " << folder;
        for (const char* part : {"field", "cell"}) {
            for (const auto& file : std::filesystem::directory_iterator(folder / part)) {
                std::filesystem::copy(file.path(), folder_ / file.path().filename());
            }
        }
    }
};

class Cases : public CaseFiles, public ::testing::WithParamInterface<Case> {};

TEST_P(Cases, AreToldWhatTheyAre) {
    const Case& one = GetParam();
    const Outcome outcome = run(one.command);
    EXPECT_EQ(outcome.code, one.code) << outcome.err;
    if (one.said.empty()) {
        EXPECT_EQ(outcome.err, "");
    } else {
        EXPECT_NE(outcome.err.find(one.said), std::string::npos) << outcome.err;
    }
    EXPECT_NE(outcome.out.find(one.printed), std::string::npos) << outcome.out;
}

/// The coupling that CoupledJoint names, stated: the pendant's j3 is the model's j3 + j2.
TEST_F(CaseFiles, CoupledJointIsCalibratedOnceItIsStated) {
    write_text("coupled.yaml",
               text_of("arm6.yaml") +
                   "controller: {joints: {j1: j1, j2: j2, j3: j3 + j2, j4: j4, j5: j5, j6: j6}}\n"
                   "measurements: {columns: controller}\n");
    const Outcome outcome = run("calibrate coupled.yaml -m j3_against_ground.csv");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NEAR(number_behind(outcome.out, "distance RMS"), 1.97, 0.005) << outcome.out;
}

INSTANTIATE_TEST_SUITE_P(
    Field, Cases,
    ::testing::Values(
        Case{"TouchedCube", "inspect cube.yaml", 0, "", "33 of its 48 parameters are identifiable"},
        Case{"TouchedCubeHasNoLength", "calibrate cube.yaml -m cube.csv", 0,
             "warning: no length is stated", "33 parameters"},
        Case{"Rail", "calibrate rail.yaml -m rail_scale.csv --validate rail_scale_test.csv", 0, "",
             "calibrated 0.037"},
        Case{"RailThatIsRight", "calibrate rail.yaml -m rail_good.csv", 0, "", "distance RMS"},
        Case{"Arm", "calibrate arm6.yaml -m good.csv --validate test.csv", 0, "",
             "calibrated 0.0259"},
        Case{"TrackerMoved", "calibrate arm6.yaml -m tracker_moved_2mm_at_21.csv", 0,
             "moved between configurations 20 and 21, by [1.2, -1.6, 0.0] mm in the instrument's "
             "frame; with --exclude 21-40: 0.104 instead of 1.11 mm held out",
             ""},
        Case{"WithoutThoseAfter",
             "calibrate arm6.yaml -m tracker_moved_2mm_at_21.csv --exclude 21-40 --validate "
             "test.csv",
             0, "", "calibrated 0.056"},
        Case{"CoupledJoint", "calibrate arm6.yaml -m j3_against_ground.csv", 3,
             "they fit clearly better with j3 - j2 in place of j3 (1.97 instead of 666 mm RMS)",
             ""},
        Case{"CoupledJointAsInspected", "inspect arm6.yaml -m j3_against_ground.csv", 0, "",
             "j3 - j2 in place of j3                     1.9710"},
        Case{"Scara", "plan scara.yaml --poses 8", 1, "known: [z]", ""},
        Case{"Mimic", "inspect mimic.yaml", 0, "", "37 of its 50 parameters are identifiable"},
        Case{"EulerAngles", "calibrate arm6_poses.yaml -m euler_as_rotation_vector.csv", 3,
             "name the columns roll, pitch, yaw", ""},
        Case{"NanCells", "calibrate arm6.yaml -m nan_cells.csv", 0, "", "points are missing"},
        Case{"Feet", "calibrate arm6.yaml -m feet.csv", 3, "with points in feet", ""},
        Case{"LeftHanded", "calibrate arm6.yaml -m left_handed.csv", 3,
             "with the instrument's frame left-handed, or as well with j1, j4, j6 reversed", ""},
        Case{"ForeignNamespace", "inspect namespaced_limit.urdf --base base --tip tool", 0, "", ""},
        Case{"MimicOfAJointOutside", "inspect mimic_of_a_joint_outside.urdf --base base --tip tool",
             1, "joint 'follow' mimics 'drive', which is no joint between", ""}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace posewise::testing
