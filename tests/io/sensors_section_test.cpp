#include <gtest/gtest.h>

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

const std::string two_trackers =
    testing::two_joint_arm +
    "base: {position_mm: [10, 20, 30], rpy_deg: [0, 0, 90]}\n"
    "sensors:\n"
    "  - {kind: points, sigma_mm: 0.05, targets: {position_mm: [[0, 0, 50]]}}\n"
    "  - kind: points\n"
    "    sigma_mm: 0.1\n"
    "    targets: {position_mm: [[20, 0, 50]], known: [x]}\n"
    "    frame: {position_mm: [3000, 100, 0], rpy_deg: [0, 0, 90]}\n";

const CombinedSensor& sensors_of(const CampaignFile& file) {
    return dynamic_cast<const CombinedSensor&>(*file.sensor);
}

TEST(ReadSensors, PlacesFurtherFramesInTheFirstOnes) {
    const CampaignFile file = parse_campaign(two_trackers, "c.yaml");
    const CombinedSensor& sensors = sensors_of(file);
    EXPECT_EQ(sensors.part_count(), 2);
    const std::vector<std::string> names{"target1.x",         "target1.y",         "target1.z",
                                         "sensor2.target1.y", "sensor2.target1.z", "sensor2.x",
                                         "sensor2.y",         "sensor2.z",         "sensor2.rx",
                                         "sensor2.ry",        "sensor2.rz"};
    EXPECT_EQ(sensors.unknown_names(), names);
    EXPECT_EQ(sensors.observation_names()[3], "s2_p1_x");
    const Isometry3d frame = sensors.frame(1, file.nominal.sensor);
    EXPECT_TRUE(frame.translation().isApprox(Vector3d(3, 0.1, 0)));
    EXPECT_TRUE(frame.linear().col(0).isApprox(Vector3d::UnitY()));
    EXPECT_TRUE(file.has_nominal_targets);
    // What is at p in the first one's frame the second one sees at R^T (p - t).
    const VectorXd seen = sensors.predict(Isometry3d::Identity(), file.nominal.sensor);
    EXPECT_TRUE(seen.tail<3>().isApprox(Vector3d(-0.1, 2.98, 0.05), 1e-12));
}

TEST(ReadSensors, KnowsAFrameThatIsStatedSo) {
    const std::string known = replaced(two_trackers, "[0, 0, 90]}\n", "[0, 0, 90]}\n");
    const std::string exact = known.substr(0, known.rfind('}')) + ", known: true}\n";
    EXPECT_EQ(sensors_of(parse_campaign(exact, "c.yaml")).unknown_names().size(), 5U);
    const std::string frame = "frame: {position_mm: [3000, 100, 0], rpy_deg: [0, 0, 90]}";
    const std::string same = replaced(two_trackers, frame, "frame: first");
    EXPECT_EQ(sensors_of(parse_campaign(same, "c.yaml")).unknown_names().size(), 5U);
    const CampaignFile open =
        parse_campaign(replaced(two_trackers, "    " + frame + "\n", ""), "c.yaml");
    EXPECT_EQ(sensors_of(open).unknown_names().size(), 11U);
    EXPECT_FALSE(open.has_nominal_targets);
}

TEST(ReadSensors, SaysWhatIsWrong) {
    const auto error = [](const std::string& text) {
        return input_error_of([&] { parse_campaign(text, "c.yaml"); });
    };
    expect_messages(
        two_trackers,
        {{"  - kind: points\n", "  - kind: point\n",
          "[...]sensors[2].kind is 'point'; did you[...]"},
         {"frame: {position_mm: [3000, 100, 0], rpy_deg: [0, 0, 90]}", "frame: second",
          "[...]sensors[2].frame must be first (the same as the first sensor's) or a map[...]"},
         {"sigma_mm: 0.05,", "sigma_mm: 0.05, frame: first,",
          "[...]sensors[1].frame is of the first sensor, whose frame is the world[...]"}},
        error, "c.yaml:");
    const std::string alone = "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 1}}\n";
    EXPECT_NE(error(two_trackers + alone).find("sensors is stated beside 'sensor'"),
              std::string::npos);
    EXPECT_NE(error(testing::two_joint_arm + "sensors: []\n").find("lists 0 sensors; must be"),
              std::string::npos);
    EXPECT_NE(error(testing::two_joint_arm +
                    "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 1}, frame: first}\n")
                  .find("is of a further one of several sensors"),
              std::string::npos);
}

TEST(ReadSensors, ReadsATableWhereEitherSawNothing) {
    const TemporaryFolder folder;
    const CampaignFile file = parse_campaign(two_trackers, "c.yaml");
    const std::string header =
        "config,q1_deg,q2_deg,p1_x_mm,p1_y_mm,p1_z_mm,s2_p1_x_mm,s2_p1_y_mm,s2_p1_z_mm\n";
    const auto read = [&](const std::string& rows) {
        return read_measurements_csv(folder.write("m.csv", header + rows), file);
    };
    const Measurements measured = read("a,10,20,1,2,3,,,\nb,10,30,,,,4,5,6\nc,1,2,1,2,3,4,5,6\n");
    EXPECT_EQ(measured.is_seen.count(), 4);
    EXPECT_TRUE(measured.is_seen(0, 0) && measured.is_seen(1, 1) && !measured.is_seen(1, 0));
    EXPECT_EQ(measured.observations(1, 4), 0.005);
    const auto message = input_error_of([&] { read("a,10,20,1,2,3,,5,6\n"); });
    EXPECT_NE(message.find("s2_p1_x is empty"), std::string::npos) << message;
    write_measurements_csv(folder.path("back.csv"), file, measured);
    const Measurements back = read_measurements_csv(folder.path("back.csv"), file);
    EXPECT_TRUE((back.is_seen == measured.is_seen).all());
    EXPECT_TRUE(back.observations.isApprox(measured.observations, 1e-14));
}

const std::string two_boards =
    testing::two_joint_arm +
    "base: {position_mm: [10, 20, 30], rpy_deg: [0, 0, 90]}\n"
    "sensors:\n"
    "  - kind: camera\n"
    "    camera: flange\n"
    "    sigma_px: 0.3\n"
    "    intrinsics: {fx_px: 1200, fy_px: 1200, cx_px: 640, cy_px: 480, known: [cx, cy]}\n"
    "    board: {columns: 3, rows: 2, square_mm: 25}\n"
    "    place: {position_mm: [0, 0, 50], rpy_deg: [0, 0, 0]}\n"
    "  - kind: camera\n"
    "    same_camera: 1\n"
    "    board: {columns: 2, rows: 2, square_mm: 30, sigma_mm: 0.1, first_point: 0}\n"
    "    frame: {position_mm: [500, 0, 0], rpy_deg: [0, 0, 0]}\n";

TEST(ReadSensors, KnowsTheSameCameraOfAnotherBoard) {
    const CampaignFile file = parse_campaign(two_boards, "c.yaml");
    const CombinedSensor& sensors = sensors_of(file);
    const std::vector<std::string> names{
        "board.p0.x", "board.p0.y", "board.p0.z", "board.p1.x", "board.p1.y", "board.p1.z",
        "board.p2.x", "board.p2.y", "board.p2.z", "board.p3.x", "board.p3.y", "board.p3.z",
        "camera.x",   "camera.y",   "camera.z",   "camera.rx",  "camera.ry",  "camera.rz",
        "camera.fx",  "camera.fy",  "sensor2.x",  "sensor2.y",  "sensor2.z",  "sensor2.rx",
        "sensor2.ry", "sensor2.rz"};
    EXPECT_EQ(sensors.unknown_names(), names);
    EXPECT_EQ(sensors.targets().count(), 1);
    EXPECT_TRUE(file.has_nominal_targets);
    // Of a fixed camera the boards are at different places, and its frame is one.
    const std::string on_flange = "    frame: {position_mm: [500, 0, 0], rpy_deg: [0, 0, 0]}\n";
    const std::string fixed =
        replaced(replaced(two_boards, "camera: flange", "camera: fixed"), on_flange,
                 "    place: {position_mm: [0, 80, 50], rpy_deg: [90, 0, 0]}\n");
    const CampaignFile before = parse_campaign(fixed, "c.yaml");
    const auto& boards = sensors_of(before);
    EXPECT_EQ(boards.unknown_names().size(), names.size());
    EXPECT_EQ(boards.unknown_names().back(), "sensor2.board.rz");
    EXPECT_TRUE(boards.frame(1, before.nominal.sensor).isApprox(Isometry3d::Identity()));
    EXPECT_EQ(boards.targets().count(), 2);
    EXPECT_FALSE(parse_campaign(replaced(two_boards, on_flange, ""), "c.yaml").has_nominal_targets);
}

TEST(ReadSensors, SaysWhatIsWrongOfTheSameCamera) {
    const auto error = [](const std::string& text) {
        return input_error_of([&] { parse_campaign(text, "c.yaml"); });
    };
    expect_messages(
        two_boards,
        {{"same_camera: 1", "same_camera: 2",
          "[...]sensors[2].same_camera is 2; must be from 1 to 1, the number of a sensor before "
          "this one"},
         {"same_camera: 1", "same_camera: -1",
          "[...]sensors[2].same_camera is '-1'; must be a whole number from 1 to 1, the number of "
          "a sensor before this one"},
         {"same_camera: 1", "same_camera: 1\n    sigma_px: 0.3",
          "[...]sensors[2].sigma_px is that of the same camera, stated before; must be left[...]"},
         {"same_camera: 1", "same_camera: 1\n    place: {position_mm: [0, 0, 0]}",
          "[...]sensors[2].place is that of the same camera, stated before; must be left[...]"},
         {"    sigma_px", "    same_camera: 1\n    sigma_px",
          "[...]sensors[1].same_camera is of the first sensor; must be left out"}},
        error, "c.yaml:");
    const std::string tracker = replaced(two_trackers, "kind: points\n    sigma_mm: 0.1",
                                         "kind: camera\n    same_camera: 1");
    EXPECT_NE(error(tracker).find("must be the number of a sensor of kind camera before this one"),
              std::string::npos);
}

TEST(ReadSensors, ReadsCornersOfTwoBoardsRowByRow) {
    const TemporaryFolder folder;
    const CampaignFile file = parse_campaign(two_boards, "c.yaml");
    const std::string header = "config,q1_deg,q2_deg,u_px,v_px,point,sensor\n";
    const auto read = [&](const std::string& rows) {
        return read_measurements_csv(folder.write("m.csv", header + rows), file);
    };
    const Measurements measured = read("a,10,20,1,2,6,1\na,10,20,3,4,0,2\nb,1,2,5,6,3,2\n");
    EXPECT_EQ(measured.is_seen.count(), 3);
    EXPECT_TRUE(measured.is_seen(0, 5) && measured.is_seen(0, 6) && measured.is_seen(1, 9));
    EXPECT_EQ(measured.observations(1, 19), 0.006);
    const auto message = [&](const std::string& rows) {
        return input_error_of([&] { read(rows); });
    };
    EXPECT_NE(message("a,10,20,1,2,4,2\n")
                  .find("is '4'; must be the number of a corner of the "
                        "board, 0 to 3"),
              std::string::npos);
    EXPECT_NE(message("a,10,20,1,2,1,3\n")
                  .find("sensor is '3'; must be the number of one of the "
                        "campaign's sensors, 1 to 2"),
              std::string::npos);
    EXPECT_NE(message("a,10,20,1,2,1,2\na,10,20,1,2,1,2\n").find("corner 1 of sensor 2 of conf"),
              std::string::npos);
    write_measurements_csv(folder.path("back.csv"), file, measured);
    const Measurements back = read_measurements_csv(folder.path("back.csv"), file);
    EXPECT_TRUE((back.is_seen == measured.is_seen).all());
    EXPECT_TRUE(back.observations.isApprox(measured.observations, 1e-14));
}

}  // namespace
}  // namespace posewise::io
