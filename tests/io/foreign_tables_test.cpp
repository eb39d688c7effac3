#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "../../src/io/format/atomic_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/places.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

/// Measurements as other calibration programs write them. The files are computed from the
/// definition of DH rows by tests/golden/foreign_tables.py.
namespace posewise::io {
namespace {

using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;

const std::string campaign = R"(
name: arm
robot:
  dh:
    convention: standard
    rows:
      - {joint: q1, limits_deg: [-180, 180], theta_deg: 0, d_mm: 127.3, a_mm: 0, alpha_deg: 90}
      - {joint: q2, limits_deg: [-180, 180], theta_deg: 0, d_mm: 0, a_mm: -612, alpha_deg: 0}
      - {joint: q3, limits_deg: [-180, 180], theta_deg: 0, d_mm: 0, a_mm: -572.3, alpha_deg: 0}
      - {joint: q4, limits_deg: [-180, 180], theta_deg: 0, d_mm: 163.941, a_mm: 0, alpha_deg: 90}
      - {joint: q5, limits_deg: [-180, 180], theta_deg: 0, d_mm: 115.7, a_mm: 0, alpha_deg: -90}
      - {joint: q6, limits_deg: [-180, 180], theta_deg: 0, d_mm: 92.2, a_mm: 0, alpha_deg: 0}
base: {position_mm: [1500, -200, 300], rpy_deg: [0, 3, 40]}
sensor: SENSOR
)";
const std::string poses = R"({kind: poses, sigma_mm: 0.05, sigma_orientation_mrad: 0.2,
  tool: {position_mm: [10, 20, 120], rpy_deg: [0, 0, 30]}})";
const std::string points = R"({kind: points, sigma_mm: 0.05,
  targets: {position_mm: [[10, 20, 120], [-60, 5, 110], [25, -70, 130]]}})";

CampaignFile campaign_with(const std::string& sensor, const std::string& more = "") {
    const TemporaryFolder folder;
    return read_campaign(folder.write("c.yaml", replaced(campaign, "SENSOR", sensor) + more));
}

std::string golden(const std::string& name) {
    return detail::read_file(source_folder() + "/tests/golden/measurements/" + name);
}

MeasurementsFile read_text(const std::string& text, const CampaignFile& file,
                           const std::string& name = "m.csv") {
    const TemporaryFolder folder;
    return read_measurements(folder.write(name, text), file);
}

/// The readings are those of the campaign's robot, to the file's digits.
void expect_nominal(const MeasurementsFile& measured, const CampaignFile& file) {
    for (Index i = 0; i < measured.configurations.rows(); ++i) {
        const VectorXd expected = file.sensor->predict(
            world_from_flange(file, file.nominal, measured.configurations.row(i).transpose()),
            file.nominal.sensor);
        for (const Index target : targets_seen(measured.is_seen.row(i))) {
            const Index width = file.sensor->row_count() / file.sensor->target_count();
            EXPECT_LT((measured.observation(i, target).transpose() -
                       expected.segment(width * target, width))
                          .lpNorm<Eigen::Infinity>(),
                      2e-6)
                << i;
        }
    }
}

TEST(ForeignTables, OfRoboDkWithPosesAreRead) {
    const CampaignFile file = campaign_with(poses);
    const MeasurementsFile in_rad = read_text(golden("robodk_poses.csv"), file);
    EXPECT_EQ(in_rad.ids, (std::vector<std::string>{"1", "2", "4", "5", "6", "7"}));
    EXPECT_EQ(
        in_rad.joined,
        "its angles are taken in rad, Rx Ry Rz, as fits the robot; row 3 is not measured, and "
        "left out");
    EXPECT_DOUBLE_EQ(in_rad.configurations(0, 0), to_radians(-31.145));
    expect_nominal(in_rad, file);
    const MeasurementsFile in_deg = read_text(golden("robodk_degrees.csv"), file);
    EXPECT_EQ(in_deg.joined, "its angles are taken in deg, Rz Ry Rx, as fits the robot");
    EXPECT_EQ(in_deg.configuration_count(), 6);
    expect_nominal(in_deg, file);
}

TEST(ForeignTables, OfRoboDkWithPointsAreRead) {
    const CampaignFile known = campaign_with(points);
    const MeasurementsFile all = read_text(golden("robodk_points.csv"), known);
    EXPECT_EQ(all.configuration_count(), 18);
    EXPECT_TRUE(all.is_seen(0, 1) && all.is_seen(6, 0) && all.is_seen(12, 2));
    EXPECT_EQ(all.joined, "");
    expect_nominal(all, known);
    // Targets that are not known are the tools in their order.
    const CampaignFile unknown =
        campaign_with("{kind: points, sigma_mm: 0.05, targets: {count: 3}}");
    EXPECT_TRUE(read_text(golden("robodk_points.csv"), unknown).is_seen(0, 0));
    // Of a table of poses the positions.
    const CampaignFile one =
        campaign_with("{kind: points, sigma_mm: 0.05, targets: {position_mm: [[10, 20, 120]]}}");
    expect_nominal(read_text(golden("robodk_poses.csv"), one), one);
}

TEST(ForeignTables, OfPyboticsAreRead) {
    const CampaignFile file = campaign_with(poses);
    const MeasurementsFile frames = read_text(golden("pybotics.csv"), file);
    EXPECT_EQ(frames.configuration_count(), 6);
    expect_nominal(frames, file);
    const CampaignFile one =
        campaign_with("{kind: points, sigma_mm: 0.05, targets: {position_mm: [[10, 20, 120]]}}");
    expect_nominal(read_text(golden("pybotics.csv"), one), one);
}

TEST(ForeignTables, OfRobotCalibrationAreRead) {
    const CampaignFile file = campaign_with(points);
    const MeasurementsFile echoed =
        read_text(golden("calibration_data.yaml"), file, "calibration_data.yaml");
    EXPECT_EQ(echoed.configuration_count(), 6);
    EXPECT_FALSE(echoed.is_seen(3, 1));
    EXPECT_EQ(echoed.joined,
              "the observation 'camera' is taken, in the frame 'camera_optical_frame'");
    expect_nominal(echoed, file);
    const MeasurementsFile json =
        read_text(golden("calibration_data.json"), file, "calibration_data.json");
    EXPECT_TRUE(json.is_seen.all());
    EXPECT_EQ(json.configurations, echoed.configurations);
    expect_nominal(json, file);
}

TEST(ForeignTables, HoldTheControllersJointsWhereThatIsStated) {
    const CampaignFile file = campaign_with(
        poses,
        "controller: {joints: {J1: q1, J2: -q2, J3: q3 - q2, J4: q4, J5: q5, J6: q6}}\n"
        "measurements: {columns: controller}\n");
    const CampaignFile plain = campaign_with(poses);
    std::string text = "J1,J2,J3,J4,J5,J6,X,Y,Z,W,P,R,TX,TY,TZ,TW,TP,TR\n";
    const MeasurementsFile model = read_text(golden("robodk_poses.csv"), plain);
    std::string rows = golden("robodk_poses.csv");
    std::size_t at = rows.find('\n') + 1;
    for (Index i = 0; at < rows.size(); ++i) {
        const std::string row = rows.substr(at, rows.find('\n', at) - at);
        at += row.size() + 1;
        std::vector<double> q(6);
        std::size_t begin = 0;
        for (double& one : q) {
            one = std::stod(row.substr(begin));
            begin = row.find(',', begin) + 1;
        }
        text += fmt::format("{},{},{},{},{},{},{}\n", q[0], -q[1], q[2] - q[1], q[3], q[4], q[5],
                            row.substr(begin));
    }
    const MeasurementsFile measured = read_text(text, file);
    EXPECT_LT((measured.configurations - model.configurations).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NE(input_error_of([&] { read_text(text, plain); }).find("another robot's"),
              std::string::npos);
}

TEST(ForeignTables, SayWhichObservationIsInQuestion) {
    const std::string text = golden("calibration_data.yaml");
    std::string two = text;
    for (std::size_t at = 0; (at = two.find("sensor_name: arm", at)) != std::string::npos;) {
        two.replace(at, 16, "sensor_name: head");
    }
    two.replace(two.find("x: 0.01\n"), 8, "x: 0.02\n");
    const auto error_of = [&](const CampaignFile& file) {
        return input_error_of([&] { read_text(two, file, "m.yaml"); });
    };
    EXPECT_NE(error_of(campaign_with(points))
                  .find("has observations by 'camera' and 'head'; must say which is measured with, "
                        "such as `measurements: {observation: camera}` in the campaign"),
              std::string::npos);
    const CampaignFile stated = campaign_with(points, "measurements: {observation: camera}\n");
    expect_nominal(read_text(two, stated, "m.yaml"), stated);
    EXPECT_NE(
        error_of(campaign_with(points, "measurements: {observation: eye}\n"))
            .find("has no observation 'eye', which the campaign states; has 'camera', 'head'"),
        std::string::npos);
}

TEST(BadForeignTables, EachIsNamedInOneLine) {
    const CampaignFile frames = campaign_with(poses);
    const CampaignFile targets = campaign_with(points);
    const auto expect = [](const std::string& text, const CampaignFile& file,
                           const std::string& pattern, const std::string& name = "m.csv") {
        const std::string message = input_error_of([&] { read_text(text, file, name); });
        EXPECT_TRUE(testing::is_like(message, pattern)) << message;
    };
    const std::string robodk = golden("robodk_poses.csv");
    expect(
        golden("robodk_points.csv"), frames,
        "m.csv: is a table of RoboDK with points only (12 columns), but the sensor of kind poses "
        "needs orientations (18 columns)");
    expect(robodk, targets,
           "m.csv: is a table of RoboDK with 1 tool; must have as many as the sensor has targets, "
           "3");
    expect(replaced(golden("robodk_points.csv"), "-60.000000,5", "-50,5"), targets,
           "m.csv: is a table of RoboDK with 4 tools; [...]");
    expect(replaced(robodk, "-90.748000", "x"), frames, "[...]");
    expect(replaced(robodk, "1099.089173", "nan"), frames,
           "m.csv:3:66: 'nan' is not finite; must be a finite number with a decimal point");
    expect(replaced(robodk, "1099.089173", "1e99"), frames,
           "m.csv:3:66: '1e99' is out of any cell; [...]");
    expect(replaced(robodk, "-11.181000", "1e99"), frames,
           "m.csv:3:1: '1e99' is no joint value in degrees");
    expect(replaced(robodk, "1099.089173,", ""), frames,
           "m.csv:3:[...]: row has 17 fields; must have 18 as the first");
    expect(replaced(robodk, "-31.145000", "10"),
           campaign_with("{kind: planes, sigma_mm: 0.05, "
                         "planes: [{normal: [0, 0, 1], "
                         "offset_mm: 300}], targets: {count: 1}}"),
           "m.csv: is a table of RoboDK, which is read where a sensor of kind points or poses "
           "measures [...]");
    expect(replaced(robodk, "-11.181000", "-11.181000,1"), frames,
           "m.csv:3:[...]: row has 19 fields; must have 18 as the first");
    expect(replaced(robodk, "1297.812778,", ""), frames,
           "m.csv:2:1: row has 17 fields behind a header with J1 to J6; a table of RoboDK must "
           "have 12 (points) or 18 (poses)");
    expect(robodk.substr(robodk.find('\n') + 1), frames,
           "m.csv:1:1: 18 numbers without a header; a table of RoboDK must begin with one, [...]");
    expect(replaced(robodk, "120.000000,-0.000000,0.000000,0.523599\n-30", "121,0,0,0\n-30"),
           frames, "m.csv:3:[...]: has another tool in its last columns than 2, [...]");
    std::string metres = robodk.substr(0, robodk.find('\n') + 1);
    for (int k = 0; k < 4; ++k)
        metres += fmt::format("{},9,8,7,6,5,1.2,0.5,0.1,0,0,0,0,0,0.1,0,0,0\n", k);
    expect(metres, frames,
           "m.csv: is a table of RoboDK with all it measured within 1.3 mm of the origin; is it "
           "in m? Must be in mm");
    std::string straight = robodk.substr(0, robodk.find('\n') + 1);
    for (int k = 0; k < 4; ++k)
        straight += fmt::format("{},0,0,0,0,0,1001,2,{},0,0,0,1,2,3,0,0,0\n", 0.1 * k, k);
    expect(straight, frames,
           "m.csv: its poses fit angles in [...] about as well as in [...]; must turn the "
           "tool more, or be a table with the column config");
    expect(robodk.substr(0, robodk.find('\n', 200)), frames,
           "m.csv: has fewer than three poses; they do not tell its angles");
    // Another robot: its joints in another order.
    std::string others = robodk.substr(0, robodk.find('\n') + 1);
    std::istringstream rows(robodk.substr(others.size()));
    for (std::string row; std::getline(rows, row);) {
        const std::size_t first = row.find(',');
        const std::size_t second = row.find(',', first + 1);
        others += row.substr(first + 1, second - first) + row.substr(0, first) +
                  row.substr(second) + '\n';
    }
    expect(others, frames, "m.csv: its angles are neither those of Rx Ry Rz nor of [...]");

    const std::string pybotics = golden("pybotics.csv");
    expect(replaced(pybotics, "-0.646896", "0.646896"), frames,
           "m.csv:3:[...]: the last 16 numbers are no pose; [...]");
    expect(replaced(pybotics, "0.000000,1.000000\n", "0.000000,2.000000\n"), frames,
           "m.csv:2:[...]: the last 16 numbers are no pose; [...]");

    const std::string ros = golden("calibration_data.yaml");
    const auto expect_ros = [&](const std::string& text, const std::string& pattern) {
        expect(text, targets, pattern, "m.yaml");
    };
    const std::size_t second = ros.find("---") + 4;
    const auto in_second = [&](const std::string& old, const std::string& now) {
        return ros.substr(0, second) + replaced(ros.substr(second), old, now);
    };
    expect(ros, frames, "m.yaml: holds messages CalibrationData of points, [...]", "m.yaml");
    expect_ros(replaced(ros, "q6", "q7"), "m.yaml:2:3: joint_states has no joint 'q6', [...]");
    expect_ros(replaced(ros, "[0.01, ", "["),
               "m.yaml:6:[...]: joint_states.position has 6 numbers for 7 names; [...]");
    expect_ros(replaced(ros, "[0.01, ", "[0.01, x, "), "m.yaml:6:[...]");
    expect_ros(in_second("observations:", "observation:"),
               "m.yaml:91:1: the file has no key 'observations', which a message CalibrationData "
               "has");
    expect_ros(in_second("frame_id: camera_optical_frame", "frame_id: moved"),
               "m.yaml:[...]is in "
               "the frame 'camera_optical_frame'; must be in 'moved' as the features before");
    expect_ros(in_second("sensor_name: camera", "sensor_name: arm"),
               "m.yaml:[...]sensor_name is 'arm' twice in one message");
    expect_ros(replaced(ros, "x: 0.01", "x: 1e99"), "m.yaml:[...]is out of any cell; must be in m");
    expect_ros(ros.substr(0, second), "m.yaml: has no observation whose features move [...]");
    expect_ros(ros.substr(0, 300), "m.yaml:[...]");
    expect_ros("joint_states: [", "m.yaml:[...]is not YAML[...]");
    expect_ros("joint_states: {name: [], position: []}\nobservations: []\n",
               "m.yaml:1:15: joint_states has no joint 'q1', which the campaign's robot has");
}

}  // namespace
}  // namespace posewise::io
