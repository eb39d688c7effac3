#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/campaign_from.hpp"
#include "support/cells.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::campaign_from;
using testing::degree;
using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;

/// A campaign with a cell; the cell's line 1 is the file's line 12.
const std::string cell_text = R"(name: arm
robot:
  joints:
    q1: {limits_deg: [-90, 90]}
    q2: {limits_deg: [-120, 120]}
  elements: [Rz q1, Tx 1 m, Rz q2, Tx 800 mm]
sensor:
  kind: points
  sigma_mm: 0.05
  targets: {position_mm: [[100, 0, 0], [0, 200, -10]]}
base: {position_mm: [1000, 0, -500], rpy_deg: [0, 0, 90]}
cell:
  margin_deg: 5
  fixed: {q2: -10 deg}
  least_joint_distance_deg: 3
  target_boxes_mm: [{min: [0, -1000, -100], max: [2000, 1000, 100]}]
  safety_distance_mm: 15
  floor_z_mm: -700
  keep_out:
    - {name: post, capsule_mm: {from: [0, 1500, 0], to: [0, 1500, 900], radius: 50}}
    - {sphere_m: {center: [3, 0, 0], radius: 0.2}}
    - {box_mm: {min: [0, 0, 500], max: [100, 100, 600]}}
    - {half_space: {point_mm: [0, 2000, 0], normal: [0, -2, 0]}}
  links:
    - {after: base, from_mm: [0, 0, -500], to_mm: [0, 0, -100], radius_mm: 90}
    - {name: forearm, after: q2, from_mm: [0, 0, 0], to_mm: [800, 0, 0], radius_mm: 60}
  tracker: {range_m: [1, 9], azimuth_deg: [150, 210], elevation_deg: [-10, 40], line_of_sight: false}
  reflectors: {acceptance_half_angle_deg: 25, normals: [[2, 0, 0], [0, 0, 1]], at_least_visible: 1}
  home_deg: [0, -10]
  speed_deg_per_s: [90, 180]
)";

std::string error_with(const std::string& part, const std::string& by) {
    const std::string text = replaced(cell_text, part, by);
    EXPECT_FALSE(text.empty()) << part;
    return input_error_of([&] { campaign_from(text); });
}

/// The error must point at this line and column and have these words in it.
void expect_error(const std::string& part, const std::string& by, const std::string& place,
                  const std::string& words) {
    const std::string error = error_with(part, by);
    EXPECT_NE(error.find("campaign.yaml:" + place + ": "), std::string::npos) << error;
    EXPECT_NE(error.find(words), std::string::npos) << error;
}

TEST(ReadCell, TakesEveryPartInMetresAndRadians) {
    const Cell cell = campaign_from(cell_text).cell;
    EXPECT_DOUBLE_EQ(cell.limit_margin.angle, 5 * degree);
    EXPECT_DOUBLE_EQ(cell.fixed_joints.at(1), -10 * degree);
    EXPECT_DOUBLE_EQ(cell.least_joint_distance, 3 * degree);
    ASSERT_EQ(cell.target_boxes.size(), 1U);
    EXPECT_EQ(cell.target_boxes[0].upper, Vector3d(2, 1, 0.1));
    EXPECT_DOUBLE_EQ(cell.safety_distance, 0.015);
    ASSERT_EQ(cell.keep_outs.size(), 5U);
    EXPECT_EQ(cell.keep_outs[0].name, "floor");
    EXPECT_EQ(std::get<HalfSpace>(cell.keep_outs[0].solid).point.z(), -0.7);
    EXPECT_EQ(cell.keep_outs[1].name, "post");
    EXPECT_EQ(std::get<Capsule>(cell.keep_outs[1].solid).to, Vector3d(0, 1.5, 0.9));
    EXPECT_EQ(std::get<Sphere>(cell.keep_outs[2].solid).radius, 0.2);
    EXPECT_EQ(cell.keep_outs[3].name, "cell.keep_out[3]");
    EXPECT_EQ(std::get<HalfSpace>(cell.keep_outs[4].solid).normal, -Vector3d::UnitY());
    ASSERT_EQ(cell.links.size(), 2U);
    EXPECT_EQ(cell.links[0].frame, 0);
    EXPECT_EQ(cell.links[1].name, "forearm");
    EXPECT_EQ(cell.links[1].frame, 2);
    EXPECT_DOUBLE_EQ(cell.links[1].solid.radius, 0.06);
    ASSERT_TRUE(cell.sight.has_value());
    EXPECT_EQ(cell.sight->range.upper, 9);
    EXPECT_DOUBLE_EQ(cell.sight->azimuth.upper, 210 * degree);
    EXPECT_FALSE(cell.sight->is_line_required);
    EXPECT_DOUBLE_EQ(cell.sight->acceptance_half_angle, 25 * degree);
    EXPECT_EQ(cell.sight->normals[0], Vector3d::UnitX());
    EXPECT_EQ(cell.sight->least_visible, 1);
    EXPECT_DOUBLE_EQ(cell.home[1], -10 * degree);
    EXPECT_DOUBLE_EQ(cell.speed[0], 90 * degree);
}

TEST(ReadCell, TakesSumsOfJointsAndHowTheRobotMoves) {
    const Cell cell =
        campaign_from(
            replaced(cell_text, "  home_deg",
                     "  joint_sums: {q2 - q1 + 10 deg: {limits_deg: [-80, 90]}}\n"
                     "  acceleration_deg_per_s2: [180, 360]\n  settle_s: 0.5\n  home_deg"))
            .cell;
    ASSERT_EQ(cell.joint_sums.size(), 1U);
    EXPECT_EQ(cell.joint_sums[0].name, "q2 - q1 + 10 deg");
    EXPECT_EQ(cell.joint_sums[0].coefficients, Eigen::Vector2d(-1, 1));
    EXPECT_NEAR(cell.joint_sums[0].limits.lower, -90 * degree, 1e-12);
    EXPECT_NEAR(cell.joint_sums[0].limits.upper, 80 * degree, 1e-12);
    EXPECT_DOUBLE_EQ(cell.acceleration[1], 360 * degree);
    EXPECT_EQ(cell.settle, 0.5);
    const auto expect = [](const std::string& sums, const std::string& column,
                           const std::string& words) {
        expect_error("  home_deg", "  joint_sums: " + sums + "\n  home_deg", "29:" + column, words);
    };
    expect("{q2 - q3: {limits_deg: [0, 1]}}", "21", "'q3' is no joint");
    expect("{q2 - q1: {limits_mm: [0, 1]}}", "37", "must be in deg or rad");
    expect("{q2 - q1: {limits_deg: [1, 0]}}", "38", "lower end must come first");
    expect_error("  home_deg", "  joint_sums: {q2 - q1: {limits_deg: [-5, 30]}}\n  home_deg",
                 "30:13", "is beyond joint_sums: q2 - q1 is -10 deg, must be from ");
    expect_error("  home_deg", "  acceleration_deg_per_s2: [1, 1e-300]\n  home_deg", "29:28",
                 "is beyond 0.01 to 100000 deg/s^2, which no joint has");
    expect_error("  home_deg", "  acceleration_deg_per_s2: [200000, 1]\n  home_deg", "29:28",
                 "which no joint has; is it in deg/s^2?");
    expect_error("  home_deg", "  acceleration_deg_per_s2: [1, 0]\n  home_deg", "29:28",
                 "must be positive");
}

TEST(ReadCell, IsEmptyIfTheFileHasNone) {
    const Cell cell = campaign_from(testing::campaign_text).cell;
    EXPECT_TRUE(cell.links.empty());
    EXPECT_FALSE(cell.sight.has_value());
}

TEST(ReadCell, TellsWhatIsWrongAndWhere) {
    expect_error("margin_deg: 5", "margin_deg: 90", "13:15", "is too large");
    expect_error("margin_deg: 5", "margin: 5", "13:3", "unknown key 'margin'");
    expect_error("{q2: -10 deg}", "{q3: -10 deg}", "14:11", "'q3' is no joint");
    expect_error("{q2: -10 deg}", "{q2: -130 deg}", "14:15", "must lie within");
    expect_error("{q2: -10 deg}", "{q2: -10 mm}", "14:15", "must be a number and a unit");
    expect_error("max: [2000", "max: [-2000", "16:50", "must be above min");
    expect_error("radius: 50}", "radius: 0}", "20:81", "must be positive");
    expect_error("half_space: {point", "name: w, box: {point", "23:17", "unknown key 'box'");
    expect_error("{half_space: {point_mm: [0, 2000, 0], normal: [0, -2, 0]}}", "{name: nothing}",
                 "23:7", "states 0 solids; must state one");
    expect_error("normal: [0, -2, 0]", "normal: [0, 0, 0]", "23:53", "must not be zero");
    expect_error("after: q2", "after: q9", "26:30", "is no frame of this robot");
    expect_error("radius_mm: 60", "radius_mm: -60", "26:85", "must be positive");
    expect_error("range_m: [1, 9]", "range_m: [9, 1]", "27:22", "lower end must come first");
    expect_error("range_m: [1, 9]", "range_m: [-1, 9]", "27:22", "must not be negative");
    expect_error("[150, 210]", "[-150, 211]", "27:43", "wider than a full turn");
    expect_error("at_least_visible: 1", "at_least_visible: 3", "28:98", "must be from 1 to 2");
    expect_error("[[2, 0, 0], [0, 0, 1]]", "[[2, 0, 0]]", "28:56", "must have 2");
    expect_error("angle_deg: 25", "angle_deg: 0", "28:43", "must be positive");
    expect_error("home_deg: [0, -10]", "home_deg: [0]", "29:13", "must have 2");
    expect_error("home_deg: [0, -10]", "home_deg: [0, 121]", "29:13",
                 "q2 is 121 deg, must be from");
    expect_error("elevation_deg: [-10, 40]", "elevation_deg: [100, 145]", "27:70",
                 "from -90 to 90 deg");
    expect_error("elevation_deg: [-10, 40]", "elevation_deg: [-91, 40]", "27:70",
                 "from -90 to 90 deg");
    expect_error("elevation_deg: [-10, 40]", "elevation_mrad: [-10, 2000]", "27:71",
                 "from -1570.8 to 1570.8 mrad");
    expect_error("[90, 180]", "[90, 0]", "30:20", "must be positive for every joint");
}

TEST(ReadCell, KnowsTheDemonstrationCell) {
    const std::string folder = source_folder() + "/designs/cell_demo/";
    const CampaignFile file = read_campaign(folder + "campaign.yaml");
    const Campaign expected_campaign = testing::cell_campaign();
    const Cell expected = testing::demo_cell();
    EXPECT_EQ(file.robot.joint_count(), 6);
    EXPECT_TRUE(
        file.nominal.world_from_base.isApprox(expected_campaign.nominal.world_from_base, 1e-12));
    EXPECT_TRUE(file.nominal.sensor.isApprox(expected_campaign.nominal.sensor, 1e-12));
    ASSERT_EQ(file.cell.links.size(), expected.links.size());
    for (std::size_t i = 0; i < expected.links.size(); ++i) {
        const Link& link = file.cell.links[i];
        EXPECT_EQ(link.name, expected.links[i].name);
        EXPECT_EQ(link.frame, expected.links[i].frame);
        EXPECT_TRUE(link.solid.from.isApprox(expected.links[i].solid.from, 1e-12));
        EXPECT_TRUE(link.solid.to.isApprox(expected.links[i].solid.to, 1e-12));
        EXPECT_DOUBLE_EQ(link.solid.radius, expected.links[i].solid.radius);
    }
    ASSERT_EQ(file.cell.keep_outs.size(), expected.keep_outs.size());
    for (std::size_t i = 0; i < expected.keep_outs.size(); ++i) {
        EXPECT_EQ(file.cell.keep_outs[i].name, expected.keep_outs[i].name);
        const Capsule probe{Vector3d(1.1, 0.3, 0.7), Vector3d(2, -0.4, 0.9), 0.1};
        EXPECT_NEAR(clearance(probe, file.cell.keep_outs[i].solid),
                    clearance(probe, expected.keep_outs[i].solid), 1e-12);
    }
    EXPECT_DOUBLE_EQ(file.cell.sight->azimuth.lower, expected.sight->azimuth.lower);
    EXPECT_TRUE(file.cell.sight->normals[2].isApprox(expected.sight->normals[2], 1e-12));
    EXPECT_TRUE(file.cell.speed.isApprox(expected.speed, 1e-12));
    EXPECT_TRUE(file.cell.home.isApprox(expected.home, 1e-12));
}

TEST(ReadSensor, TakesNoiseOfATrackerAndOfEachAxis) {
    const auto noise_with = [](const std::string& by) {
        const Campaign campaign = campaign_from(replaced(cell_text, "sigma_mm: 0.05", by));
        return dynamic_cast<const PointSensor&>(*campaign.sensor).noise();
    };
    const auto tracker =
        std::get<LaserTrackerNoise>(noise_with("noise: {range_um: 10, angle_urad: 5}"));
    EXPECT_DOUBLE_EQ(tracker.range_sigma, 1e-5);
    EXPECT_DOUBLE_EQ(tracker.angle_sigma, 5e-6);
    const auto axes = std::get<PerAxisNoise>(noise_with("sigma_um: [10, 20, 30]"));
    EXPECT_TRUE(axes.sigma.isApprox(Vector3d(1e-5, 2e-5, 3e-5)));
    const std::string sigma = "sigma_mm: 0.05";
    expect_error(sigma, "noise: {range_um: 0, angle_urad: 5}", "9:21", "must be positive");
    expect_error(sigma, "noise: {range_um: 10}", "9:10", "has no key angle_deg");
    expect_error(sigma, "sigma_mm: [1, 2]", "9:13", "three for x, y and z");
    expect_error(sigma, "sigma_mm: [1, 2, 0]", "9:20", "must be positive");
    expect_error(sigma, "sigma_mm: 1\n  noise: {range_um: 1, angle_urad: 5}", "8:3",
                 "must have either sigma_mm or noise");
}

TEST(ReadRobot, TakesTheRepeatabilityOfJoints) {
    const std::string q2 = "q2: {limits_deg: [-120, 120]}";
    const auto text =
        replaced(cell_text, q2, "q2: {limits_deg: [-120, 120], repeatability_urad: 20}");
    const VectorXd repeatability = campaign_from(text).joint_repeatability;
    ASSERT_EQ(repeatability.size(), 2);
    EXPECT_EQ(repeatability[0], 0);
    EXPECT_DOUBLE_EQ(repeatability[1], 2e-5);
    EXPECT_EQ(campaign_from(cell_text).joint_repeatability.size(), 0);
    expect_error(q2, "q2: {limits_deg: [-120, 120], repeatability_mm: 1}", "5:53",
                 "the joint drives a rotation");
    expect_error(q2, "q2: {limits_deg: [-120, 120], repeatability_urad: -1}", "5:55", "positive");
}

}  // namespace
}  // namespace posewise::io
