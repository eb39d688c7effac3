#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "io/format/atomic_file.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"
#include "support/temporary_folder.hpp"
#include "support/urdf_text.hpp"

// What a campaign says of its controller's joints.

namespace posewise::io {
namespace {

using namespace testing;

/// Six joints; the controller's section is line 7.
const std::string robot_text = R"(name: arm
robot:
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, q3: {limits_deg: [-90, 90]}, q4: {limits_deg: [-90, 90]}, q5: {limits_deg: [-90, 90]}, q6: {limits_deg: [-90, 90]}}
  elements: [Rz q1, Tx 300 mm, Ry q2, Tz 1 m, Ry -q3, Tx 1 m, Rx -q4, Ry -q5, Rx -q6]
sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}

)";

ControllerJoints controller_of(const std::string& section) {
    return parse_campaign(robot_text + "controller: " + section + '\n', "arm.yaml").controller;
}

std::string controller_error(const std::string& section) {
    const TemporaryFolder folder;
    const std::string path = folder.write("arm.yaml", robot_text + "controller: " + section + '\n');
    return input_error_of([&] { read_campaign(path); });
}

VectorXd some_joints() { return VectorXd::LinSpaced(6, 10, 60) * degree; }

TEST(ControllerSection, IsTheRobotsOwnWhereItIsMissing) {
    const CampaignFile file = parse_campaign(robot_text, "arm.yaml");
    EXPECT_TRUE(file.controller.is_identity());
    EXPECT_EQ(file.controller.names()[3], "q4");
    EXPECT_EQ(file.controller.pulses_per_unit().size(), 0);
}

TEST(ControllerSection, ReadsSomeJointsByNumber) {
    const ControllerJoints joints = controller_of("{joints: {J3: q3 - q2, J6: -q6 + 90 deg}}");
    const VectorXd c = joints.to_controller(some_joints()) / degree;
    EXPECT_EQ(joints.names()[0], "J1");
    EXPECT_NEAR(c[0], 10, 1e-12);
    EXPECT_NEAR(c[2], 10, 1e-12);
    EXPECT_NEAR(c[5], 30, 1e-12);
}

TEST(ControllerSection, ReadsAllJointsByNameOrInAList) {
    const ControllerJoints named =
        controller_of("{joints: {a: -q1, b: q2, c: q3 + 0.5*q2, d: 100 mrad + q4, e: q5, f: q6}}");
    EXPECT_EQ(named.names()[5], "f");
    VectorXd expected(6);
    expected << -10, 20, 40, 40 + 0.1 / degree, 50, 60;
    EXPECT_LT((named.to_controller(some_joints()) / degree - expected).norm(), 1e-10);
    const ControllerJoints listed =
        controller_of("{joints: [-q1, q2, q3 + 0.5*q2, q4 + 100 mrad, q5, q6]}");
    EXPECT_EQ(listed.names()[5], "J6");
    EXPECT_LT((listed.from_model() - named.from_model()).norm(), 1e-15);
    EXPECT_LT((listed.offset() - named.offset()).norm(), 1e-15);
}

TEST(ControllerSection, KnowsFanuc) {
    const ControllerJoints joints = controller_of("{maker: fanuc, j23_factor: 1}");
    EXPECT_NEAR(joints.to_controller(some_joints())[2], 10 * degree, 1e-12);
    EXPECT_NEAR(controller_of("{maker: fanuc, j23_factor: -1}").to_controller(some_joints())[2],
                50 * degree, 1e-12);
}

TEST(ControllerSection, ReadsPulses) {
    const ControllerJoints joints = controller_of("{pulses_per_deg: [1341.38, 1, 2, 3, 4, 5]}");
    EXPECT_NEAR(joints.pulses_per_unit()[0] * degree, 1341.38, 1e-9);
    EXPECT_EQ(joints.names()[0], "q1");
}

TEST(ControllerSection, ReadsMeasurementsOfThePendant) {
    const TemporaryFolder folder;
    const std::string controller =
        "controller: {joints: {A1: -q1, A2: q2 - 90 deg, A3: q3 + q2, A4: q4, A5: q5, A6: q6}}\n";
    const std::string rows =
        "a,10,-70,50,40,50,60,1,2,3,4,5,6,7,8,9\nb,11,-71,51,41,51,61,1,2,3,4,5,6,7,8,8\n";
    const std::string targets =
        ",p1_x_mm,p1_y_mm,p1_z_mm,p2_x_mm,p2_y_mm,p2_z_mm,p3_x_mm,p3_y_mm,"
        "p3_z_mm\n";
    const std::string path =
        folder.write("m.csv", "config,A1_deg,A2_deg,A3_deg,A4_deg,A5_deg,A6_deg" + targets + rows);
    const CampaignFile file =
        parse_campaign(robot_text + controller + "measurements: {columns: controller}\n", "a.yaml");
    const Measurements read = read_measurements(path, file);
    VectorXd q(6);
    q << -10, 20, 30, 40, 50, 60;
    EXPECT_LT((read.configurations.row(0).transpose() / degree - q).norm(), 1e-10);
    // They are written as they are read.
    write_measurements(folder.path("back.csv"), file, read);
    EXPECT_NE(detail::read_file(folder.path("back.csv")).find("config,sample,A1_rad,A2_rad,"),
              std::string::npos);
    const Measurements again = read_measurements(folder.path("back.csv"), file);
    EXPECT_LT((again.configurations - read.configurations).cwiseAbs().maxCoeff(), 1e-12);
    // Neither is taken for the other.
    const CampaignFile plain = parse_campaign(robot_text + controller, "a.yaml");
    EXPECT_NE(input_error_of([&] { read_measurements(path, plain); })
                  .find("m.csv:1:8: column 'A1_deg' is a joint of the controller; state "
                        "`measurements: {columns: controller}`"),
              std::string::npos);
    write_measurements(folder.path("model.csv"), plain, read);
    EXPECT_NE(input_error_of([&] { read_measurements(folder.path("model.csv"), file); })
                  .find("model.csv:1:15: column 'q1_rad' is a joint of the model, but "
                        "`measurements: {columns: controller}` in the campaign says that joints "
                        "are the controller's, which are called A1, A2,"),
              std::string::npos);
    EXPECT_NE(
        input_error_of([&] {
            parse_campaign(robot_text + "measurements: {columns: pendant}\n", "a.yaml");
        }).find("a.yaml:7:25: measurements.columns is 'pendant'; must be controller or model"),
        std::string::npos);
}

/// The same of a robot from a URDF and from a Denavit-Hartenberg table: joints by their names
/// there.
TEST(ControllerSection, IsOfAnyRobotThatACampaignStates) {
    const TemporaryFolder folder;
    folder.write("arm.urdf", urdf_text({{"revolute", "", "0 0 1"},
                                        {"revolute", R"(xyz="0.3 0 0.4")", "0 1 0"},
                                        {"prismatic", R"(xyz="0 0 0.5")", "1 0 0"}}));
    const std::string sensor = "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n";
    const std::string urdf =
        "name: urdf\nrobot: {urdf: arm.urdf, base_link: link0, tip_link: link3}\n" + sensor;
    const std::string table =
        "name: dh\nrobot:\n  dh:\n    convention: standard\n    rows:\n"
        "    - {joint: q1, a_mm: 300, alpha_deg: 90, d_mm: 400, theta_deg: 0, limits_deg: [-90, "
        "90]}\n"
        "    - {joint: q2, a_mm: 500, alpha_deg: 0, d_mm: 0, theta_deg: 0, limits_deg: [-90, "
        "90]}\n"
        "    - {joint: q3, kind: prismatic, a_mm: 0, alpha_deg: 0, d_mm: 0, theta_deg: 0, "
        "limits_mm: [0, 900]}\n" +
        sensor;
    const std::string controller =
        "controller: {joints: {J1: -q1, J2: q2 - q1 + 90 deg, z: q3 + 100 mm}}\n"
        "measurements: {columns: controller}\n"
        "cell: {joint_sums: {J2: {limits_deg: [-10, 100]}, z: {limits_mm: [150, 600]}}}\n";
    for (const std::string& robot : {urdf, table}) {
        const CampaignFile file = read_campaign(folder.write("arm.yaml", robot + controller));
        EXPECT_EQ(file.controller.names(), (std::vector<std::string>{"J1", "J2", "z"}));
        const Vector3d q(10 * degree, 30 * degree, 0.25);
        const Vector3d expected(-10 * degree, 110 * degree, 0.35);
        EXPECT_LT((file.controller.to_controller(q) - expected).norm(), 1e-14) << file.name;
        EXPECT_LT((file.controller.to_model(expected) - q).norm(), 1e-14) << file.name;
        EXPECT_EQ(file.controller.motion(2), Motion::Translation);
        ASSERT_EQ(file.cell.joint_sums.size(), 2U);
        EXPECT_NEAR(file.cell.joint_sums[0].limits.upper, 10 * degree, 1e-14);
        EXPECT_NEAR(file.cell.joint_sums[1].limits.lower, 0.05, 1e-14);
        const Measurements read = read_measurements(
            folder.write("m.csv",
                         "config,J1_deg,J2_deg,z_mm,p1_x_mm,p1_y_mm,p1_z_mm,p2_x_mm,p2_y_mm,"
                         "p2_z_mm,p3_x_mm,p3_y_mm,p3_z_mm\na,-10,110,350,1,2,3,4,5,6,7,8,9\n"),
            file);
        EXPECT_LT((read.configurations.row(0).transpose() - q).norm(), 1e-14) << file.name;
    }
    EXPECT_NE(input_error_of([&] {
                  read_campaign(folder.write(
                      "arm.yaml", urdf + "controller: {joints: {J1: q1, J2: q2 - q3, z: q3}}\n"));
              }).find("q3"),
              std::string::npos);
}

/// Each example of the manual of robot programs is read, with the FANUC cell's robot.
TEST(ControllerSection, TakesTheExamplesOfTheManual) {
    const std::string manual =
        detail::read_file(source_folder() + "/designs/programs.md", std::size_t{1} << 20);
    const std::string cell_path = source_folder() + "/designs/cell_demo/campaign.yaml";
    const std::string cell = detail::read_file(cell_path, std::size_t{1} << 20);
    const std::string begin = "```yaml\n";
    int count = 0;
    for (std::size_t at = manual.find(begin); at != std::string::npos;
         at = manual.find(begin, at + 1)) {
        const std::size_t first = at + begin.size();
        const std::string example = manual.substr(first, manual.find("```", first) - first);
        std::string text = cell;
        if (example.starts_with("cell: ")) {  // one section in a file
            text = text.substr(0, text.find("\ncell:"));
        }
        const CampaignFile file = parse_campaign(text + '\n' + example, cell_path);
        EXPECT_FALSE(file.controller.is_identity() && file.controller.names()[0] == "q1" &&
                     file.cell.joint_sums.empty())
            << example;
        ++count;
    }
    EXPECT_EQ(count, 6);
}

TEST(ControllerSection, NamesJointsThatACellLimits) {
    const auto sum_of = [](const std::string& sections) {
        const CampaignFile file = parse_campaign(robot_text + sections, "arm.yaml");
        EXPECT_EQ(file.cell.joint_sums.size(), 1U);
        return file.cell.joint_sums.front();
    };
    const std::string controller = "controller: {joints: {J3: q3 - q2, J5: 90 deg - q5}}\n";
    const auto limited = [&](const std::string& what) {
        return sum_of(controller + "cell: {margin_deg: 2, joint_sums: {" + what +
                      ": {limits_deg: [-30, 40]}}}\n");
    };
    for (const auto& [name, sum] :
         {std::pair{"J3", "q3 - q2"}, {"J5", "90 deg - q5"}, {"J4", "q4"}}) {
        const JointSum by_name = limited(name);
        const JointSum as_sum = limited(sum);
        EXPECT_EQ(by_name.name, name);
        EXPECT_EQ(by_name.coefficients, as_sum.coefficients) << name;
        EXPECT_NEAR(by_name.limits.lower, as_sum.limits.lower, 1e-15) << name;
        EXPECT_NEAR(by_name.limits.upper, as_sum.limits.upper, 1e-15) << name;
    }
    // Joint 5 of the controller at 50 deg is the model's at 40 deg.
    const std::string home = controller +
                             "cell: {joint_sums: {J5: {limits_deg: [-30, 40]}}, home_deg: [0, 0, "
                             "0, 0, 40, 0]}\n";
    EXPECT_NE(input_error_of([&] {
                  parse_campaign(robot_text + home, "arm.yaml");
              }).find("is beyond joint_sums: J5 is 50 deg, must be from -30 to 40 deg"),
              std::string::npos);
    // Never a joint of the other kind in place of one that is misspelt.
    const auto refused = [&](const std::string& what, const std::string& where,
                             const std::string& words) {
        const std::string error = input_error_of([&] { limited(what); });
        EXPECT_NE(error.find("arm.yaml:8:" + where + ": " + words), std::string::npos) << error;
    };
    refused("j3", "36", "'j3' is no joint of the robot or of its controller; did you mean 'J3'?");
    refused("Q3", "36", "'Q3' is no joint of the robot or of its controller; did you mean 'q3'?");
    refused("J9", "36", "'J9' is no joint of the robot or of its controller; must be J1, J2, ");
    refused("q1 + J2", "41",
            "'J2' is a joint of the controller; must stand alone, or the sum must be of the "
            "robot's joints: q1, ");
    refused("J3: {limits_mm: [1, 2]}, J4", "52",
            "cell.joint_sums.J3.limits_mm is in 'mm', but 'J3' turns");
    refused("J3: {limits_deg: [1, 2]}, J4", "53",
            "cell.joint_sums.J3.limits_deg is not wider than twice cell.margin");
    // What is q3, the robot's or the controller's?
    EXPECT_NE(input_error_of([&] {
                  parse_campaign(robot_text +
                                     "controller: {joints: {q1: q1, q2: q2, q3: q3 - q2, q4: q4, "
                                     "q5: q5, q6: q6}}\n"
                                     "cell: {joint_sums: {q3: {limits_deg: [-30, 40]}}}\n",
                                 "arm.yaml");
              }).find("arm.yaml:8:21: 'q3' names a joint of the robot and one of the controller"),
              std::string::npos);
}

TEST(ControllerSection, SaysWhatIsWrongWhere) {
    const std::pair<const char*, const char*> slips[] = {
        {"{maker: kuka}", "arm.yaml:7:21: controller.maker is 'kuka'; must be fanuc"},
        {"{maker: fanuc}", "arm.yaml:7:13: controller has no key j23_factor"},
        {"{maker: fanuc, j23_factor: 2}",
         "arm.yaml:7:40: controller.j23_factor is '2'; must be -1"},
        {"{j23_factor: 1}", "arm.yaml:7:26: controller.j23_factor is stated without maker: fanuc"},
        {"{maker: fanuc, j23_factor: 1, joints: {J1: q1}}", "is stated beside controller.maker"},
        {"{joints: {J7: q1}}", "arm.yaml:7:23: 'J7' is no joint of the controller"},
        {"{joints: {J3: q3 - q7}}", "arm.yaml:7:32: 'q7' is no joint of the robot"},
        {"{joints: {J3: q3 + 5}}", "arm.yaml:7:32: a number without unit"},
        {"{joints: {J3: q3 + 5 mm}}", "the joint turns, its amount cannot be in 'mm'"},
        {"{joints: {J3: 5 deg}}", "'5 deg' has no joint"},
        {"{joints: {J3: q3 q2}}", "'q' is not expected here"},
        {"{joints: {J3: q2}}",
         "arm.yaml:7:22: controller.joints cannot be: the controller's joints do not tell"},
        {"{joints: [q1, q2]}", "arm.yaml:7:22: controller.joints lists 2 joints; must list 6"},
        {"{joints: q1}", "must be a list of sums"},
        {"{pulses_per_deg: [1, 2]}", "controller.pulses_per_deg"},
        {"{pulses_per_deg: [1, 2, 3, 4, 5, 0]}", "has 0 for joint 6"},
        {"{pulses_per_deg: [1, 2, 3, 4, 5, .nan]}", "controller.pulses_per_deg"},
        {"{pulses_per_mm: [1, 2, 3, 4, 5, 6]}", "unknown key 'pulses_per_mm'"},
        {"{factor: 1}", "unknown key 'factor' in controller; must be joints, maker"},
    };
    for (const auto& [section, words] : slips) {
        const std::string message = controller_error(section);
        EXPECT_NE(message.find(words), std::string::npos) << section << "\n" << message;
        EXPECT_EQ(message.rfind("arm.yaml:7:", 0), 0U) << section << "\n" << message;
    }
}

}  // namespace
}  // namespace posewise::io
