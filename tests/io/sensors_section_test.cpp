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

}  // namespace
}  // namespace posewise::io
