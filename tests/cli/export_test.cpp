#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "program.hpp"

/// What export warns of and refuses; urdf_test, irb120_test and ur10_test have what it writes.
namespace posewise::testing {
namespace {

class Export : public Program {
  protected:
    void calibrate(const std::string& campaign) const {
        write_text("c.yaml", campaign);
        run_well("simulate c.yaml -k 30 -o m.csv");
        run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    }

    const std::string base_ = "base: {position_mm: [2000, 0, 0], rpy_deg: [0, 0, 90]}\n";
};

/// Axes 0.11 rad and 2 m apart: their common normal is 18 m away.
TEST_F(Export, WarnsOfFarOffsetsAndLeavesNothingWhereOneFormIsRefused) {
    calibrate(R"(name: skew
robot:
  errors: geometric
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, q3: {limits_deg: [-90, 90]}}
  elements: [Rz q1, Ty 2000 mm, Rx 0.11 rad, Rz q2, Tx 500 mm, Ry q3, Tz 300 mm]
sensor:
  kind: points
  sigma_mm: 0.01
  targets: {position_mm: [[100, 0, 0], [0, 100, 0], [0, 0, 100]]}
)" + base_);
    const Outcome outcome = run("export c.yaml e.json --dh d.yaml");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err.rfind("posewise: warning: d.yaml: row 1 has an offset of 17.97 m;", 0),
              0U)
        << outcome.err;
    std::filesystem::remove(folder_ / "d.yaml");
    expect_input_error("export c.yaml e.json --dh d.yaml --ur-kinematics k.yaml",
                       "c.yaml: frames of a UR are those of six joints that turn");
    expect_input_error("export c.yaml e.json --dh /dev/null", "cannot be read back");
}

TEST_F(Export, HasTheOrientationOfAToolOfMeasuredPoses) {
    calibrate("name: arm\nrobot:\n" + six_joints + measured_poses);
    const std::string text = run_well("export c.yaml e.json --dh d.yaml");
    EXPECT_NE(text.find(", and the tool in the flange frame: position "), std::string::npos)
        << text;
    const auto json = nlohmann::json::parse(run_well("export c.yaml e.json --dh d.yaml --json"));
    const auto& tool = json.at("tool");
    EXPECT_EQ(tool.at("position_m"), json.at("targets_m").at(0));
    const std::vector<double> rpy = tool.at("rpy_deg");
    const std::vector<double> quaternion = tool.at("quaternion_wxyz");
    const std::vector<double> stated{10, 0, 90};
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(rpy[k], stated[k], 2);
    EXPECT_NEAR(quaternion[0], std::sqrt(0.5), 0.02);
    EXPECT_NEAR(quaternion[3], std::sqrt(0.5), 0.02);
}

TEST_F(Export, LeavesOutAURsHalfTurnFromBaseLinkAndRefusesAnother) {
    std::string design = read_text(source_folder() + "/designs/ur10/campaign.yaml") + base_;
    design.insert(design.find("  sigma_mm"),
                  "  tool: {position_mm: [0, 0, 50], rpy_deg: [0, 0, 0]}\n");
    const auto turned = [&](const std::string& turn) {
        std::string text = design;
        return text.insert(text.find("    - Rz q1"), "    - Rz " + turn + " deg\n");
    };
    calibrate(turned("180"));
    const std::string text = run_well("export c.yaml e.json --ur-kinematics k.yaml");
    EXPECT_NE(text.find("the half turn from base_link to base_link_inertia is not in it"),
              std::string::npos)
        << text;
    const std::string kinematics = read_text(folder_ / "k.yaml");
    EXPECT_LT(std::abs(number_behind(kinematics, "yaw:")), 0.1) << kinematics;
    calibrate(turned("170"));
    expect_input_error("export c.yaml e.json --ur-kinematics k.yaml",
                       "kinematics of a UR begin at base_link_inertia");
}

TEST_F(Export, WritesAModelForMuJoCo) {
    calibrate(R"(name: A & B
robot:
  errors: geometric
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, q3: {limits_mm: [0, 400]}}
  elements: [Rz q1, Tx 300 mm, Ry -q2, Tx 500 mm, Rx 0.3 rad, Tz q3, Ry 0.5*q2]
sensor: {kind: points, sigma_mm: 0.01, targets: {position_mm: [[100, 0, 0], [0, 100, 0], [0, 0, 100]]}}
)" + base_);
    const std::string text = run_well("export c.yaml e.json --mujoco arm.xml");
    EXPECT_NE(text.find("A & B: the calibrated robot as a model for MuJoCo is in arm.xml\n"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("arm.xml read back: the flange is within "), std::string::npos) << text;
    const std::string model = text_of("arm.xml");
    EXPECT_EQ(model.rfind("<mujoco model=\"A &amp; B, calibrated\">\n", 0), 0U) << model;
    for (const char* const part :
         {"<compiler angle=\"radian\"", "<joint name=\"q3\" type=\"slide\" axis=\"0 0 1\" ",
          "limited=\"true\" range=\"0 0.4\"", "<joint name=\"q2\" type=\"hinge\" axis=\"0 -1 0\" ",
          "<joint joint1=\"q2.2\" joint2=\"q2\" polycoef=\"0 0.5 0 0 0\"",
          "<site name=\"target3\""}) {
        EXPECT_NE(model.find(part), std::string::npos) << part << '\n' << model;
    }
    calibrate(R"(name: half
robot:
  errors: geometric
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, q3: {limits_deg: [-90, 90]}}
  elements: [Rz 0.5*q1, Tx 300 mm, Ry q2, Tx 500 mm, Ry q3, Tz 300 mm]
sensor: {kind: points, sigma_mm: 0.01, targets: {position_mm: [[100, 0, 0], [0, 100, 0], [0, 0, 100]]}}
)" + base_);
    expect_input_error("export c.yaml e.json --mujoco other.xml",
                       "other.xml: joint 'q1' drives nothing by a factor of 1");
}

TEST_F(Export, WritesAMapOfWhatDependsOnTheConfiguration) {
    calibrate(R"(name: arm
robot:
  joints: {q1: {limits_deg: [-150, 150]}, q2: {limits_deg: [-80, 80]}, q3: {limits_deg: [-120, 120]}}
  elements: [Rz q1, Tz 300 mm, Ry q2, Tz 400 mm, Ry q3, Tx 350 mm]
sensor: {kind: points, sigma_mm: 0.01, targets: {position_mm: [[0, 30, 50], [40, 0, -20], [0, -40, 10]]}}
)" + base_);
    const std::string text = run_well("export c.yaml e.json --map m.c");
    EXPECT_GT(number_behind(text, "as the geometry has them"), 1e-3) << text;
    EXPECT_LT(number_behind(text, "with the map"), 1e-3) << text;
    EXPECT_NE(text_of("m.c").find("void posewise_joints_to_send("), std::string::npos);
    const auto document = nlohmann::json::parse(
        run_well("export c.yaml e.json --map m.csv --dh d.yaml --geometry estimate --json"));
    EXPECT_GT(document.at("map").at("geometry_alone").at("largest_mm"),
              document.at("map").at("geometry_alone").at("p95_mm"));
    EXPECT_LT(document.at("map").at("with_map").at("largest_mm"), 1e-2);
    expect_input_error("export c.yaml e.json --map m.txt", "m.txt: must end in .c");
    const Outcome nearest = run("export c.yaml e.json --map m2.c --dh d.yaml");
    EXPECT_EQ(nearest.code, 2);
    EXPECT_NE(nearest.err.find("add --geometry estimate"), std::string::npos) << nearest.err;
}

class ExportOfACamera : public Export {
  protected:
    void calibrate_camera(const std::string& camera) const {
        write_text("poses.csv", R"(config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg
p1,0,-90,90,0,20,0
p2,20,-100,95,10,-15,30
p3,-25,-80,70,-10,25,-40
p4,10,-95,100,20,10,80
p5,-10,-85,85,-25,-20,-80
p6,30,-90,80,15,30,10
p7,-30,-100,100,-15,5,120
p8,5,-80,95,25,-30,60
)");
        write_text("eye.yaml", R"(name: eye
robot:
  errors: none
  joints: {q1: {limits_deg: [-170, 170]}, q2: {limits_deg: [-170, 170]}, q3: {limits_deg: [-170, 170]},
    q4: {limits_deg: [-170, 170]}, q5: {limits_deg: [-170, 170]}, q6: {limits_deg: [-170, 170]}}
  elements: [Rz q1, Tz 300 mm, Ry q2, Tz 400 mm, Ry q3, Tx 300 mm, Rx q4, Ry q5, Rx q6, Tx 80 mm, Ry 90 deg]
sensor:
  kind: poses
  camera: )" + camera + R"(
  sigma_mm: 0.1
  sigma_orientation_mrad: 0.3
  tool: {position_mm: [10, 20, 60], rpy_deg: [5, 0, 90]}
base: {position_mm: [100, 200, 1500], rpy_deg: [170, 10, 80]}
)");
        run_well("simulate eye.yaml --configurations poses.csv -o m.csv");
        run_well("calibrate eye.yaml -m m.csv --folds 0 -o e.json");
    }
};

TEST_F(ExportOfACamera, WritesFramesForOpenCvAndForAUrdf) {
    for (const bool is_on_flange : {true, false}) {
        calibrate_camera(is_on_flange ? "flange" : "fixed");
        const auto document =
            nlohmann::json::parse(run_well("export eye.yaml e.json --camera camera.yaml --json"));
        const std::string yaml = text_of("camera.yaml");
        EXPECT_EQ(yaml.rfind("%YAML:1.0\n---\n", 0), 0U) << yaml;
        EXPECT_NE(yaml.find(is_on_flange ? "flange_from_camera" : "base_from_camera"),
                  std::string::npos);
        EXPECT_EQ(document.at("camera").at("on"), is_on_flange ? "flange" : "base");
        // The camera is the tool, or what sees the base.
        const auto& place = document.at("camera").at("place").at("position_m");
        const auto& board = document.at("camera").at("board").at("position_m");
        EXPECT_EQ(document.at("tool").at("position_m"), is_on_flange ? place : board);
        const std::string text = run_well("export eye.yaml e.json --camera camera.urdf");
        EXPECT_NE(text.find("static_transform_publisher --x "), std::string::npos) << text;
        const std::string urdf = text_of("camera.urdf");
        const std::string parent = is_on_flange ? "tool0" : "base_link";
        EXPECT_NE(urdf.find("<parent link=\"" + parent +
                            "\"/>\n    <child link=\"camera_optical_frame\"/>"),
                  std::string::npos)
            << urdf;
    }
}

TEST_F(ExportOfACamera, IsRefusedWithoutACameraOrAnEnding) {
    calibrate_camera("flange");
    expect_input_error("export eye.yaml e.json --camera camera.txt", "must end in .yaml");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "camera.txt"));
    calibrate(R"(name: points
robot:
  errors: none
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, q3: {limits_deg: [-90, 90]}}
  elements: [Rz q1, Tx 300 mm, Ry q2, Tx 500 mm, Ry q3, Tz 300 mm]
sensor: {kind: points, sigma_mm: 0.01, targets: {position_mm: [[100, 0, 0]]}}
)" + base_);
    expect_input_error("export c.yaml e.json --camera camera.yaml", "has no camera");
}

}  // namespace
}  // namespace posewise::testing
