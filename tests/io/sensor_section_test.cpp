#include <gtest/gtest.h>

#include <array>
#include <numbers>

#include "campaign_text.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::expect_messages;
using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;

const std::string head = testing::two_joint_arm +
                         "base: {position_mm: [10, 20, 30], rpy_deg: [0, 0, 90], known: [z, rx]}\n";

const std::string poses =
    "sensor:\n"
    "  kind: poses\n"
    "  sigma_mm: 0.05\n"
    "  sigma_orientation_mrad: 0.2\n"
    "  tool: {position_mm: [0, 0, 120], rpy_deg: [0, 0, 180]}\n"
    "model_error_orientation_mrad: 0.3\n";

const std::string distances =
    "sensor:\n"
    "  kind: distances\n"
    "  sigma_mm: 0.02\n"
    "  anchors: {position_mm: [[1000, 2000, 0], [-500, 800, 300]]}\n"
    "  targets: {position_mm: [[0, 0, 50]], known: [x, y]}\n";

const std::string planes =
    "sensor:\n"
    "  kind: planes\n"
    "  sigma_mm: 0.01\n"
    "  planes: [{normal: [0, 0, 2], offset_mm: 300}, {normal: [1, 0, 0], offset_mm: 900}]\n"
    "  targets: {position_mm: [[0, 0, 150]], known: true}\n";

CampaignFile with_sensor(const std::string& sensor) {
    return parse_campaign(head + sensor, "c.yaml");
}

Measurements read_csv(const std::string& sensor, const std::string& text) {
    const TemporaryFolder folder;
    return read_measurements_csv(folder.write("m.csv", text), with_sensor(sensor));
}

TEST(ReadSensor, KnowsHowLargeTheBallsAtTargetsAre) {
    const std::string points =
        "sensor: {kind: points, sigma_mm: 0.1, targets: {position_mm: [[0, 0, 50]]}}\n";
    EXPECT_EQ(with_sensor(points).sensor->target_radius(), 0.01905);
    const auto stated = [&](const std::string& radius) {
        return replaced(points, "50]]", "50]], radius_mm: " + radius);
    };
    EXPECT_EQ(with_sensor(stated("6.35")).sensor->target_radius(), 0.00635);
    EXPECT_EQ(with_sensor(stated("0")).sensor->target_radius(), 0);
    EXPECT_EQ(with_sensor(distances).sensor->target_radius(), 0.01905);
    EXPECT_FALSE(with_sensor(poses).sensor->target_radius());
    EXPECT_FALSE(with_sensor(planes).sensor->target_radius())
        << "a tip that is to touch is no body";
    EXPECT_NE(input_error_of([&] { with_sensor(stated("-1")); }).find("radius_mm is '-1'"),
              std::string::npos);
    EXPECT_NE(input_error_of([&] { with_sensor(stated("2000")); }).find("radius_mm is '2000'"),
              std::string::npos);
}

TEST(ReadSensor, TakesPosesWithTheirTool) {
    const Campaign campaign = with_sensor(poses);
    const auto& sensor = dynamic_cast<const PoseSensor&>(*campaign.sensor);
    EXPECT_DOUBLE_EQ(sensor.sigma_orientation(), 2e-4);
    EXPECT_DOUBLE_EQ(campaign.model_error_orientation, 3e-4);
    ASSERT_EQ(campaign.nominal.sensor.size(), 6);
    EXPECT_DOUBLE_EQ(campaign.nominal.sensor[2], 0.12);
    EXPECT_NEAR(campaign.nominal.sensor[5], std::numbers::pi, 1e-15);
    EXPECT_TRUE(campaign.has_nominal_targets);
    const std::string fixed = replaced(poses, "180]}", "180], known: true}");
    EXPECT_EQ(with_sensor(fixed).nominal.sensor.size(), 0);
}

TEST(ReadSensor, TakesWhatACameraRecordsAndWhereItSits) {
    const auto record = [](const std::string& keys) {
        const Campaign campaign =
            with_sensor(replaced(poses, "kind: poses", "kind: poses\n  " + keys));
        return dynamic_cast<const PoseSensor&>(*campaign.sensor).record();
    };
    EXPECT_TRUE(record("camera: flange").is_inverse);
    EXPECT_TRUE(record("camera: flange").is_made_at_body);
    EXPECT_FALSE(record("camera: flange\n  measured: camera_in_board").is_inverse);
    EXPECT_TRUE(record("camera: flange\n  measured: camera_in_board").is_made_at_body);
    EXPECT_FALSE(record("camera: fixed").is_inverse);
    EXPECT_FALSE(record("camera: fixed").is_made_at_body);
    EXPECT_TRUE(record("camera: fixed\n  measured: camera_in_board").is_inverse);
    EXPECT_NE(
        input_error_of([&] { record("camera: hand"); }).find("'hand'; must be flange or fixed"),
        std::string::npos);
    EXPECT_NE(input_error_of([&] { record("measured: board_in_camera"); }).find("needs camera"),
              std::string::npos);
}

TEST(CameraPoses, AreReadAndWrittenAsTheyWereRecorded) {
    const Campaign body = with_sensor(poses);
    const Campaign camera =
        with_sensor(replaced(poses, "kind: poses", "kind: poses\n  camera: flange"));
    const Measurements observed = simulate(body, {.pose_count = 5}).measurements;
    const TemporaryFolder folder;
    const auto written = folder.path("seen.csv");
    write_measurements_csv(written, camera, observed);
    const Measurements again = read_measurements_csv(written, camera);
    EXPECT_LT((again.observations - observed.observations).norm(), 1e-13);
    RowMatrixXd recorded = read_measurements_csv(written, body).observations;
    EXPECT_GT((recorded - observed.observations).norm(), 0.1);
    invert_poses(recorded);
    EXPECT_EQ(recorded, again.observations);
}

TEST(ReadSensor, TakesWhatIsKnownOfTheBase) {
    const Campaign campaign = with_sensor(poses);
    EXPECT_EQ(base_parameter_count(campaign), 4);
    const auto names = parameter_names(campaign);
    EXPECT_EQ(std::vector<std::string>(names.begin(), names.begin() + 4),
              (std::vector<std::string>{"base.x", "base.y", "base.ry", "base.rz"}));
}

TEST(ReadSensor, TakesDistancesAndPartlyKnownTargets) {
    const Campaign campaign = with_sensor(distances);
    EXPECT_EQ(campaign.sensor->observation_names(), (std::vector<std::string>{"p1_a1", "p1_a2"}));
    EXPECT_EQ(campaign.sensor->unknown_names().front(), "target1.z");
    VectorXd expected(7);
    expected << 0.05, 1, 2, 0, -0.5, 0.8, 0.3;
    EXPECT_TRUE(campaign.nominal.sensor.isApprox(expected, 1e-15));
    const std::string fixed = replaced(distances, "300]]}", "300]], known: true}");
    EXPECT_EQ(with_sensor(fixed).nominal.sensor.size(), 1);
}

TEST(ReadSensor, TakesSockets) {
    const std::string sockets =
        "sensor:\n"
        "  kind: sockets\n"
        "  sigma_mm: 0.1\n"
        "  targets: {position_mm: [[0, 0, 100]]}\n"
        "  sockets:\n"
        "    - {name: left, position_mm: [500, 100, 20]}\n"
        "    - {name: right, from: left, distance_mm: 50}\n";
    const std::string without_base = head.substr(0, head.find("base:"));
    const Campaign campaign = parse_campaign(without_base + sockets, "c.yaml");
    const auto& sensor = dynamic_cast<const SocketSensor&>(*campaign.sensor);
    EXPECT_EQ(sensor.contact_names(), (std::vector<std::string>{"left", "right"}));
    EXPECT_EQ(base_parameter_count(campaign), 0);
    EXPECT_NEAR(
        (sensor.socket_position(0, campaign.nominal.sensor) - Vector3d(0.5, 0.1, 0.02)).norm(), 0,
        1e-15);
    EXPECT_NEAR(
        (sensor.socket_position(1, campaign.nominal.sensor) - Vector3d(0.5, 0.1, 0.02)).norm(),
        0.05, 1e-15);
    EXPECT_FALSE(campaign.has_nominal_targets);  // where right is nobody said
    const auto message = [&](const std::string& part, const std::string& by) {
        return input_error_of(
            [&] { parse_campaign(without_base + replaced(sockets, part, by), "c.yaml"); });
    };
    EXPECT_NE(input_error_of([&] { with_sensor(sockets); }).find("must be left out"),
              std::string::npos);
    for (const auto& [part, by, said] : std::vector<std::array<std::string, 3>>{
             {"from: left", "from: right", "must be a socket listed before this one"},
             {"name: right", "name: left", "must be its own"},
             {"name: right", "name: the right", "must be one word"},
             {", distance_mm: 50", "", "must have both from and distance_mm"},
             {"[[0, 0, 100]]", "[[0, 0, 100], [0, 9, 0]]", "must be one, the ball"},
             {"from: left, distance_mm: 50", "position_mm: [500, 100, 20.5]",
              "is at the place of socket 'left', 0.5 mm apart; must be at a place of its own"},
             {"distance_mm: 50", "distance_mm: 400, position_mm: [400, 100, 20]",
              "sensor.sockets[2] is stated 400 mm from 'left', and by position_mm 100 mm; must "
              "agree within 100 mm"},
             {"kind: sockets", "kind: sockets\n  known_sockets: true", "needs position_mm"}}) {
        EXPECT_NE(message(part, by).find(said), std::string::npos) << message(part, by);
    }
    const auto distance = [](const std::string& mm) {
        return "distance_mm: " + mm + ", position_mm: [400, 100, 20]";
    };
    EXPECT_EQ(message("distance_mm: 50", distance("190")), "no error");  // roughly there
    const std::string known =
        replaced(replaced(sockets, "kind: sockets", "kind: sockets\n  known_sockets: true"),
                 "distance_mm: 50", distance("100.9"));
    EXPECT_EQ(input_error_of([&] { with_sensor(known); }), "no error");
    EXPECT_NE(input_error_of([&] {
                  with_sensor(replaced(known, "100.9", "102"));
              }).find("must agree within 1 mm"),
              std::string::npos);
    EXPECT_EQ(input_error_of([&] { parse_campaign(without_base + known, "c.yaml"); }),
              "c.yaml:8:3: sensor has known_sockets: true, whose places are in the frame of base; "
              "base must be stated, if only roughly");
}

TEST(ReadSensor, TakesPlanes) {
    const Campaign campaign = with_sensor(planes);
    EXPECT_EQ(campaign.sensor->unknown_names(),
              (std::vector<std::string>{"plane1.tilt1", "plane1.tilt2", "plane1.offset",
                                        "plane2.tilt1", "plane2.tilt2", "plane2.offset"}));
    EXPECT_DOUBLE_EQ(campaign.nominal.sensor[2], 0.3);
    const std::string fixed = replaced(planes, "  targets", "  known_planes: true\n  targets");
    EXPECT_EQ(with_sensor(fixed).nominal.sensor.size(), 0);
}

TEST(ReadSensor, TakesWhatIsKnownOfEachPlane) {
    const auto names = [](const std::string& first, const std::string& second, bool all = false) {
        std::string text = replaced(planes, "offset_mm: 300", "offset_mm: 300" + first);
        text = replaced(text, "offset_mm: 900", "offset_mm: 900" + second);
        return with_sensor(all ? replaced(text, "  targets", "  known_planes: true\n  targets")
                               : text)
            .sensor->unknown_names();
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names(", known: [normal]", ", known: [offset]"),
              (Names{"plane1.offset", "plane2.tilt1", "plane2.tilt2"}));
    EXPECT_EQ(names(", known: true", ", known: [offset, normal]"), Names{});
    // The key of all is what holds of those that say nothing.
    EXPECT_EQ(names(", known: [normal]", "", true), Names{"plane1.offset"});
    EXPECT_EQ(names("", ", known: []", true),
              (Names{"plane2.tilt1", "plane2.tilt2", "plane2.offset"}));
    const Campaign campaign =
        with_sensor(replaced(planes, "offset_mm: 900", "offset_mm: 900, known: [normal]"));
    EXPECT_EQ(campaign.nominal.sensor.size(), 4);
    EXPECT_DOUBLE_EQ(campaign.nominal.sensor[3], 0.9);
}

TEST(ReadSensor, TellsWhatIsWrongAndWhere) {
    const auto error = [](const std::string& sensor) {
        return input_error_of([&] { with_sensor(sensor); });
    };
    const std::string rule = "; must point away from the face, its length from 1e-09 to 1e+09";
    expect_messages(
        poses,
        {{"kind: poses", "kind: pose", "9:9: sensor.kind is 'pose'; did you mean 'poses'?"},
         {"  kind: poses\n", "", "[...]"},
         {"  sigma_orientation_mrad: 0.2\n", "", "[...]sigma_orientation[...]"}},
        error, "c.yaml:");
    expect_messages(distances,
                    {{"[x, y]", "[x, w]", "[...]'w'[...]"},
                     {"[x, y]", "[x, x]", "12:51: sensor.targets.known[2] is 'x' again; keep one"},
                     {"[[1000, 2000, 0], [-500, 800, 300]]", "[]",
                      "11:26: sensor.anchors.position_mm is empty; must list at least one anchor"}},
                    error, "c.yaml:");
    expect_messages(
        planes,
        {{"[0, 0, 2]", "[0, 0, 0]", "11:21: sensor.planes[1].normal is of length 0" + rule},
         {"[0, 0, 2]", "[0, 0, 1e200]",
          "11:21: sensor.planes[1].normal is of length 1e+200" + rule},
         {"offset_mm: 300", "offset_mm: 1e9",
          "11:43: sensor.planes[1].offset_mm is '1e9'; must be within 1 km of the origin"},
         {"offset_mm: 300", "offset: 300",
          "11:32: unknown key 'offset' in sensor.planes[1]; did you mean 'offset_mm'?"},
         {"offset_mm: 300", "offset_mm: 300, known: [distance]",
          "11:56: sensor.planes[1].known[1] is 'distance'; must be normal or offset"},
         {"offset_mm: 300", "offset_mm: 300, known: [normal, normal]",
          "11:64: sensor.planes[1].known[2] is 'normal' again; keep one"},
         {"offset_mm: 300", "offset_mm: 300, known: normal",
          "11:55: sensor.planes[1].known is 'normal'; must be true or false, or a list of normal, "
          "offset"},
         {"[[0, 0, 150]], known: true", "[]", "[...]at least one target[...]"}},
        error, "c.yaml:");
}

TEST(ReadMeasurementsCsv, TakesOrientationsInEveryForm) {
    const double half = std::sqrt(0.5);
    const auto columns = [&](const std::string& header, const std::string& cells) {
        return read_csv(poses, "config,q1_deg,q2_deg,x_mm,y_mm,z_mm," + header +
                                   "\na,10,20,1,2,3," + cells + "\n")
            .observations;
    };
    RowMatrixXd expected(1, 6);
    expected << 1e-3, 2e-3, 3e-3, 0, 0, std::numbers::pi / 2;
    const std::string root = std::to_string(half);
    EXPECT_TRUE(columns("rx_deg,ry_deg,rz_deg", "0,0,90").isApprox(expected, 1e-14));
    EXPECT_TRUE(columns("roll_deg,pitch_deg,yaw_deg", "0,0,90").isApprox(expected, 1e-14));
    EXPECT_TRUE(columns("qw,qx,qy,qz", root + ",0,0," + root).isApprox(expected, 1e-14));
    EXPECT_TRUE(columns("qw,qx,qy,qz", '-' + root + ",0,0,-" + root).isApprox(expected, 1e-14));
}

/// ROS has metres where nothing is said.
TEST(ReadMeasurementsCsv, TakesPosesUnderTheNamesOfRos) {
    const auto rows = [&](const std::string& header, const std::string& cells) {
        return read_csv(poses, "config,q1_deg,q2_deg,qx,qy,qz,qw," + header + "\na,10,20,0,0,0,1," +
                                   cells + "\n")
            .observations;
    };
    const RowMatrixXd expected = rows("x_mm,y_mm,z_mm", "1,-2,3500");
    EXPECT_EQ(rows("tx,ty,tz", "0.001,-0.002,3.5"), expected);
    EXPECT_EQ(rows("tx_mm,ty_mm,tz_mm", "1,-2,3500"), expected);
    EXPECT_EQ(
        input_error_of([&] { rows("tx,ty,tz", "1,-2,3500"); }),
        "m.csv:2:22: '3500' is over 100 m, the unit of tz where none is stated; call it tz_mm "
        "if it is in mm");
    EXPECT_EQ(input_error_of([&] { rows("tx,ty,z_deg", "1,-2,3500"); }),
              "m.csv:1:40: column 'z_deg' has the wrong kind of unit; must be like z_mm");
    EXPECT_EQ(input_error_of([&] { rows("tx,ty,tz_rad", "1,-2,3500"); }),
              "m.csv:1:40: column 'tz_rad' has the wrong kind of unit; must be like tz_mm");
    EXPECT_EQ(input_error_of([&] { rows("tx,ty,x_mm", "1,-2,3500"); }),
              "m.csv:1:40: column 'x_mm' occurs twice; keep one");
}

TEST(ReadMeasurementsCsv, RefusesHalfAnOrientation) {
    const auto error = [](const std::string& text) {
        return input_error_of([&] { read_csv(poses, text); });
    };
    const std::string all = "qw,qx,qy,qz\na,10,20,1,2,3,1,0,0,0\n";
    expect_messages(
        "config,q1_deg,q2_deg,x_mm,y_mm,z_mm," + all,
        {{all, "qw,qx,qy,qz\na,10,20,1,2,3,1,0.1,0,0\n", "[...]the quaternion has length[...]"},
         {all, "qw,qx,qy\na,10,20,1,2,3,1,0,0\n", "[...]must come with all of them[...]"},
         {all, "qw,qx,qy,qz,rx_deg\na,10,20,1,2,3,1,0,0,0,0\n", "[...]no other orientation[...]"},
         {all, "roll,pitch,yaw\na,10,20,1,2,3,0,0,0\n", "[...]has no unit of angle[...]"},
         {all, "qw,qx,qy,qz\na,10,20,1,2,3,1,0,,0\n", "[...]qy is empty[...]"},
         {all, "rx_deg,ry_deg\na,10,20,1,2,3,1,0\n", "[...]missing column rz_rad[...]"}},
        error, "m.csv:");
}

TEST(ReadMeasurementsCsv, RefusesADistanceBelowZero) {
    const std::string text = "config,q1_deg,q2_deg,p1_a1_mm,p1_a2_mm\na,10,20,900,-5\n";
    EXPECT_EQ(input_error_of([&] { read_csv(distances, text); }),
              "m.csv:2:13: p1_a2 is '-5'; must be a distance above 0");
}

TEST(WriteMeasurementsCsv, KeepsEveryKindOfNumber) {
    for (const std::string& sensor : {poses, distances, planes}) {
        const CampaignFile file = with_sensor(sensor);
        const Campaign& campaign = file;
        const Simulation simulated = simulate(campaign, {.pose_count = 4, .repeats = 2});
        const TemporaryFolder folder;
        const std::string path = folder.path("m.csv");
        write_measurements_csv(path, campaign, simulated.measurements);
        const Measurements back = read_measurements_csv(path, campaign);
        EXPECT_TRUE(back.observations.isApprox(simulated.measurements.observations, 1e-15));
    }
}

}  // namespace
}  // namespace posewise::io
