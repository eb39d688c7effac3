#include "posewise/io/campaign_file.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "campaign_text.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/measurement/point_sensor.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::campaign_text;
using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;
constexpr double pi = std::numbers::pi;

CampaignFile read(const std::string& text) {
    const TemporaryFolder folder;
    return read_campaign(folder.write("campaign.yaml", text));
}

std::string error_of(const std::string& text) {
    return input_error_of([&] { read(text); });
}

std::string error_with(const std::string& part, const std::string& by) {
    return error_of(replaced(campaign_text, part, by));
}

TEST(ReadCampaign, TakesJointsWithLimitsInAnyUnit) {
    const Chain robot = read(campaign_text).campaign.robot;
    ASSERT_EQ(robot.joint_count(), 3);
    EXPECT_EQ(robot.joints()[0].name, "q1");
    EXPECT_DOUBLE_EQ(robot.joints()[0].upper, pi / 2);
    EXPECT_EQ(robot.joints()[1].upper, 1.5);
    EXPECT_EQ(robot.joints()[2].upper, 0.5);
    EXPECT_EQ(robot.joint_motion(2), Motion::Translation);
}

TEST(ReadCampaign, TakesElementsWithSignsOffsetsAndCoupling) {
    const std::vector<Element> elements = read(campaign_text).campaign.robot.elements();
    ASSERT_EQ(elements.size(), 6U);
    EXPECT_EQ(elements[2].value, 0.312);
    EXPECT_EQ(elements[2].parameter, "Tx1");
    const Element& coupled = elements[3];
    EXPECT_EQ(coupled.motion, Motion::Rotation);
    EXPECT_EQ(coupled.axis, Axis::Y);
    EXPECT_DOUBLE_EQ(coupled.value, pi / 2);
    ASSERT_EQ(coupled.joints.size(), 2U);
    EXPECT_EQ(coupled.joints[0].joint, 1);
    EXPECT_EQ(coupled.joints[0].coefficient, -1);
    EXPECT_EQ(coupled.joints[1].joint, 0);
    EXPECT_EQ(coupled.joints[1].coefficient, 0.5);
    EXPECT_EQ(elements[5].value, -1.5);
    EXPECT_EQ(elements[5].parameter, "");
}

TEST(ReadCampaign, DoesNotMindBlanksInElements) {
    const auto text = replaced(campaign_text, "Ry -q2 + 0.5*q1 + 90 deg [dq2]",
                               "'  Ry - q2+0.5 * q1+90deg[ dq2 ] '");
    const Element spaced = read(text).campaign.robot.elements()[3];
    const Element plain = read(campaign_text).campaign.robot.elements()[3];
    EXPECT_EQ(spaced.value, plain.value);
    EXPECT_EQ(spaced.parameter, plain.parameter);
    ASSERT_EQ(spaced.joints.size(), plain.joints.size());
    for (std::size_t k = 0; k < plain.joints.size(); ++k) {
        EXPECT_EQ(spaced.joints[k].joint, plain.joints[k].joint);
        EXPECT_EQ(spaced.joints[k].coefficient, plain.joints[k].coefficient);
    }
}

TEST(ReadCampaign, TakesSensorBaseSpreadAndDefaults) {
    const CampaignFile file = read(campaign_text);
    const Campaign& campaign = file.campaign;
    EXPECT_EQ(campaign.name, "crane");
    const auto& sensor = dynamic_cast<const PointSensor&>(*campaign.sensor);
    EXPECT_EQ(sensor.target_count(), 2);
    EXPECT_FALSE(sensor.is_known(0));
    EXPECT_DOUBLE_EQ(sensor.sigma(), 5e-5);
    EXPECT_TRUE(campaign.has_nominal_targets);
    EXPECT_EQ(campaign.nominal.sensor[4], 0.2);
    EXPECT_TRUE(campaign.has_nominal_base);
    EXPECT_EQ(campaign.nominal.world_from_base.translation(), Vector3d(1, 0, -0.5));
    EXPECT_TRUE((campaign.nominal.world_from_base.linear() * Vector3d::UnitX())
                    .isApprox(Vector3d::UnitY()));
    EXPECT_EQ(campaign.model_error, 2e-4);
    EXPECT_EQ(campaign.spread.length, 2e-3);
    EXPECT_EQ(campaign.spread.angle, 3e-3);
    EXPECT_EQ(campaign.spread.by_name.at("dq2"), 5e-4);
    EXPECT_EQ(campaign.spread.by_name.at("Tx1"), 4e-3);
    EXPECT_EQ(file.criterion, Criterion::O3);
    EXPECT_EQ(file.seed, 7U);
    EXPECT_EQ(file.mat.joints, "q");
    EXPECT_EQ(file.mat.points, (std::vector<std::string>{"mA", "mB"}));
    EXPECT_DOUBLE_EQ(file.mat.angle_unit, pi / 180);
    EXPECT_EQ(file.mat.length_unit, 1e-3);
}

TEST(ReadCampaign, TurnsTheBaseAboutFixedAxesXThenYThenZ) {
    const auto text = replaced(campaign_text, "rpy_deg: [0, 0, 90]", "rpy_deg: [90, 0, 90]");
    const Matrix3d R = read(text).campaign.nominal.world_from_base.linear();
    EXPECT_TRUE((R * Vector3d::UnitY()).isApprox(Vector3d::UnitZ()));  // by roll; yaw leaves it
}

TEST(ReadCampaign, NeedsOnlyNameRobotAndSensor) {
    const auto end = campaign_text.find("model_error_mm");
    const CampaignFile file = read(replaced(
        campaign_text.substr(0, end), "position_mm: [[100, 0, 0], [0, 200, -10]]", "count: 3"));
    EXPECT_EQ(file.campaign.model_error, 1e-4);
    EXPECT_EQ(file.campaign.spread.length, 1e-3);
    EXPECT_EQ(file.criterion, Criterion::D);
    EXPECT_EQ(file.seed, 1U);
    EXPECT_FALSE(file.campaign.has_nominal_base);
    EXPECT_FALSE(file.campaign.has_nominal_targets);
    ASSERT_EQ(file.campaign.nominal.sensor.size(), 9);
    const Vector3d a = file.campaign.nominal.sensor.segment<3>(0);
    const Vector3d b = file.campaign.nominal.sensor.segment<3>(3);
    const Vector3d c = file.campaign.nominal.sensor.segment<3>(6);
    EXPECT_GT((b - a).cross(c - a).norm(), 0.01);  // not in line
}

TEST(ReadCampaign, TakesKnownTargets) {
    const auto text = replaced(campaign_text, "-10]]}", "-10]], known: true}");
    const Campaign campaign = read(text).campaign;
    EXPECT_EQ(campaign.nominal.sensor.size(), 0);
    const auto& sensor = dynamic_cast<const PointSensor&>(*campaign.sensor);
    EXPECT_EQ(sensor.target(1, VectorXd()), Vector3d(0, 0.2, -0.01));
}

TEST(ReadCampaign, HasTheStatedErrorsIfAnyIsStated) {
    const CampaignFile file = read(campaign_text);
    EXPECT_EQ(file.error_model, ErrorModel::Stated);
    EXPECT_EQ(file.campaign.robot.parameter_names(),
              (std::vector<std::string>{"dq1", "Tx1", "dq2", "Ty2"}));
    EXPECT_EQ(file.campaign.nominal.robot, VectorXd::Zero(4));
}

TEST(ReadCampaign, ReducesTheCompleteErrorsToAnIrreducibleSet) {
    const auto text =
        R"(name: pan-tilt
robot:
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}}
  elements: [Rz q1, Tx 1 m, Tz 0.1 m, Ry q2, Tx 0.8 m]
sensor: {kind: points, sigma_mm: 0.1, targets: {count: 3}}
)";
    const CampaignFile file = read(text);
    EXPECT_EQ(file.error_model, ErrorModel::Complete);
    EXPECT_EQ(file.declared_robot.parameter_count(), 0);
    // 4R + 2P + 3n of all, of which base 6 and targets 9.
    EXPECT_EQ(file.campaign.robot.parameter_count(), 4 * 2 + 9 - 6 - 9);
    EXPECT_EQ(file.campaign.nominal.robot.size(), file.campaign.robot.parameter_count());
}

TEST(ReadCampaign, ReadsTheFanucDesigns) {
    const std::string folder = std::string(POSEWISE_SOURCE_DIR) + "/designs/fanuc_r2000ic_165f/";
    const CampaignFile file = read_campaign(folder + "campaign.yaml");
    EXPECT_EQ(file.campaign.robot.parameter_count(), 18);
    EXPECT_EQ(find_identifiable(file.campaign).dropped.size(), 0U);
    const CampaignFile seed_report = read_campaign(folder + "seed_report.yaml");
    EXPECT_EQ(seed_report.campaign.robot.parameter_count(), 18);
    EXPECT_EQ(find_identifiable(seed_report.campaign).dropped.size(), 1U);
}

TEST(ReadCampaign, FindsAsManyErrorsInTheFanucAsItsDesignStates) {
    const TemporaryFolder folder;
    const std::string path =
        std::string(POSEWISE_SOURCE_DIR) + "/designs/fanuc_r2000ic_165f/campaign.yaml";
    std::ifstream in(path);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    const auto complete = replaced(text, "  elements:", "  errors: complete\n  elements:");
    EXPECT_EQ(read(complete).campaign.robot.parameter_count(), 18);
}

// Bad input: one line each, with place, what is wrong and what would be right.

TEST(BadCampaign, MissingFile) {
    const TemporaryFolder folder;
    EXPECT_EQ(input_error_of([&] { read_campaign(folder.path("none.yaml")); }),
              "none.yaml: cannot be read: No such file or directory");
}

TEST(BadCampaign, DirectoryInsteadOfFile) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder.path("folder"));
    EXPECT_EQ(input_error_of([&] { read_campaign(folder.path("folder")); }),
              "folder: is a directory; must be a file");
}

TEST(BadCampaign, EmptyFile) {
    EXPECT_EQ(error_of(""), "campaign.yaml: is empty; must be a campaign in YAML");
    EXPECT_EQ(error_of("# nothing\n"), "campaign.yaml: is empty; must be a campaign in YAML");
}

TEST(BadCampaign, NotAMap) {
    EXPECT_EQ(error_of("just words\n"),
              "campaign.yaml:1:1: the file is 'just words'; must be a map of keys and values");
}

TEST(BadCampaign, MalformedYaml) {
    const std::string message = error_of("name: [a, b\nrobot: {\n");
    EXPECT_EQ(message.rfind("campaign.yaml:", 0), 0U) << message;
    EXPECT_NE(message.find("is not YAML"), std::string::npos) << message;
}

TEST(BadCampaign, TwoDocuments) {
    EXPECT_EQ(error_of("name: a\n---\nname: b\n"),
              "campaign.yaml:3:1: a second document begins; must be one document");
}

TEST(BadCampaign, HostileNesting) {
    for (const std::string part : {"[", "{a: ", "- ", "? ", "&a [", "'", "\"", "!!", "<<: *a\n"}) {
        std::string text;
        while (text.size() < 100000) text += part;
        EXPECT_NE(error_of(text), "no error") << part;
    }
}

TEST(BadCampaign, HugeFile) {
    EXPECT_EQ(error_of(std::string(2 << 20, 'a')),
              "campaign.yaml: has 2097152 bytes; a campaign file has at most 1 MiB");
}

TEST(BadCampaign, NoBytesOfTextAtAll) {
    EXPECT_NE(error_of(std::string("\0\xFF\xFE\x01", 4)), "no error");
}

TEST(BadCampaign, MissingKey) {
    EXPECT_EQ(error_with("name: crane\n", ""),
              "campaign.yaml:1:1: the file has no key name; it must be stated");
    EXPECT_EQ(error_with("position_mm: [1000, 0, -500], ", ""),
              "campaign.yaml:19:7: base has no key position_mm, position_m or position_um; it must "
              "be stated");
}

TEST(BadCampaign, MisspeltKey) {
    EXPECT_EQ(error_with("sensor:", "sensr:"),
              "campaign.yaml:14:1: unknown key 'sensr'; did you mean 'sensor'?");
    EXPECT_EQ(error_with("  kind:", "  knid:"),
              "campaign.yaml:15:3: unknown key 'knid' in sensor; did you mean 'kind'?");
}

TEST(BadCampaign, KeyThatResemblesNone) {
    EXPECT_EQ(error_with("  mat:", "  spreadsheet:"),
              "campaign.yaml:24:3: unknown key 'spreadsheet' in measurements; must be mat");
}

TEST(BadCampaign, KeyWithoutUnit) {
    EXPECT_EQ(error_with("sigma_mm", "sigma"),
              "campaign.yaml:16:3: unknown key 'sigma' in sensor; did you mean 'sigma_m'?");
}

TEST(BadCampaign, DuplicateKey) {
    EXPECT_EQ(error_with("seed: 7", "name: again"),
              "campaign.yaml:22:1: key 'name' occurs twice, first in line 1; keep one");
}

TEST(BadCampaign, QuantityInTwoUnits) {
    EXPECT_EQ(error_with("sigma_mm: 0.05", "sigma_mm: 0.05\n  sigma_um: 50"),
              "campaign.yaml:17:3: 'sigma' is stated in two units; keep one");
}

TEST(BadCampaign, KeyWithoutValue) {
    EXPECT_EQ(error_with("name: crane", "name:"),
              "campaign.yaml:1:1: name has no value; must be text");
}

TEST(BadCampaign, DuplicateJoint) {
    EXPECT_EQ(error_with("    q2: {", "    q1: {"),
              "campaign.yaml:5:5: key 'q1' occurs twice, first in line 4; keep one");
}

TEST(BadCampaign, JointNamedLikeAUnit) {
    EXPECT_EQ(error_with("    lift: {", "    mm: {"),
              "campaign.yaml:6:5: 'mm' cannot name a joint; must be letters, digits and "
              "underscores, not a unit");
}

TEST(BadCampaign, MoreJointsThanElementsUse) {
    EXPECT_EQ(error_with("    - Tz lift\n", ""),
              "campaign.yaml:6:5: joint 'lift' drives no element; must occur in one");
}

TEST(BadCampaign, UnknownJointInAnElement) {
    EXPECT_EQ(error_with("Rz q1", "Rz q4"),
              "campaign.yaml:8:10: 'q4' is no joint of the robot; did you mean 'q1'?");
}

TEST(BadCampaign, LimitsInTheWrongUnit) {
    EXPECT_EQ(error_with("limits_mm", "limits_deg"),
              "campaign.yaml:6:24: robot.joints.lift.limits_deg is in 'deg', but the joint drives "
              "a translation; must be in mm, m or um");
}

TEST(BadCampaign, LimitsOutOfOrder) {
    EXPECT_EQ(error_with("[-90, 90]", "[90, -90]"),
              "campaign.yaml:4:22: robot.joints.q1.limits_deg is not in order; the lower limit "
              "must come first");
}

TEST(BadCampaign, LimitsOfOneNumber) {
    EXPECT_EQ(error_with("[-90, 90]", "[90]"),
              "campaign.yaml:4:22: robot.joints.q1.limits_deg has 1 values; must have 2");
}

TEST(BadCampaign, NumbersThatAreNotFinite) {
    EXPECT_EQ(error_with("[-90, 90]", "[-90, .inf]"),
              "campaign.yaml:4:28: robot.joints.q1.limits_deg[2] is '.inf', which is not a number; "
              "must be a finite number without unit");
    EXPECT_EQ(error_with("sigma_mm: 0.05", "sigma_mm: nan"),
              "campaign.yaml:16:13: sensor.sigma_mm is 'nan', which is not finite; must be a "
              "finite number without unit");
    EXPECT_EQ(error_with("sigma_mm: 0.05", "sigma_mm: 1e999"),
              "campaign.yaml:16:13: sensor.sigma_mm is '1e999', which is beyond the range of "
              "numbers; must be a finite number without unit");
}

TEST(BadCampaign, TextWhereANumberBelongs) {
    EXPECT_EQ(error_with("model_error_mm: 0.2", "model_error_mm: 0.2 mm"),
              "campaign.yaml:18:17: model_error_mm is '0.2 mm', which is not a number; must be a "
              "finite number without unit");
}

TEST(BadCampaign, SigmaThatIsNotPositive) {
    EXPECT_EQ(error_with("sigma_mm: 0.05", "sigma_mm: -0.05"),
              "campaign.yaml:16:13: sensor.sigma_mm is -0.05; must be positive");
    EXPECT_EQ(error_with("sigma_mm: 0.05", "sigma_mm: 0"),
              "campaign.yaml:16:13: sensor.sigma_mm is 0; must be positive");
}

TEST(BadCampaign, NegativeModelError) {
    EXPECT_EQ(error_with("model_error_mm: 0.2", "model_error_mm: -1"),
              "campaign.yaml:18:17: model_error_mm is -1; must be zero or positive");
}

TEST(BadCampaign, UnknownSensorKind) {
    EXPECT_EQ(error_with("kind: points", "kind: point"),
              "campaign.yaml:15:9: sensor.kind is 'point'; did you mean 'points'?");
}

TEST(BadCampaign, TargetsStatedNeitherOrBothWays) {
    const std::string message =
        "campaign.yaml:17:12: sensor.targets must have either count or position_mm";
    EXPECT_EQ(error_with("{position_mm", "{count: 2, position_mm"), message);
    EXPECT_EQ(error_with("position_mm: [[100, 0, 0], [0, 200, -10]]", "known: false"), message);
}

TEST(BadCampaign, KnownTargetsWithoutPositions) {
    EXPECT_EQ(error_with("position_mm: [[100, 0, 0], [0, 200, -10]]", "count: 2, known: true"),
              "campaign.yaml:17:30: sensor.targets.known is true; needs position_mm, not count");
}

TEST(BadCampaign, NoTargets) {
    EXPECT_EQ(error_with("position_mm: [[100, 0, 0], [0, 200, -10]]", "count: 0"),
              "campaign.yaml:17:20: sensor.targets.count is 0; must be from 1 to 1000");
    EXPECT_EQ(error_with("[[100, 0, 0], [0, 200, -10]]", "[]"),
              "campaign.yaml:17:26: sensor.targets.position_mm is empty; must list at least one "
              "target");
}

TEST(BadCampaign, PositionOfTwoNumbers) {
    EXPECT_EQ(error_with("[100, 0, 0]", "[100, 0]"),
              "campaign.yaml:17:27: sensor.targets.position_mm[1] has 2 values; must have 3");
}

TEST(BadCampaign, SpreadOfAnUnknownParameter) {
    EXPECT_EQ(error_with("{dq2: 0.5 mrad", "{dq3: 0.5 mrad"),
              "campaign.yaml:20:52: 'dq3' is no parameter of this campaign; did you mean 'dq1'?");
}

TEST(BadCampaign, SpreadInTheWrongUnit) {
    const std::string message = error_with("dq2: 0.5 mrad", "dq2: 0.5 mm");
    EXPECT_EQ(message.rfind("campaign.yaml:20:57: spread.parameters.dq2 is '0.5 mm'; must be a "
                            "positive number and a unit, deg, rad",
                            0),
              0U)
        << message;
}

TEST(BadCampaign, SpreadThatIsNotPositive) {
    EXPECT_EQ(error_with("length_mm: 2", "length_mm: 0"),
              "campaign.yaml:20:21: spread.length_mm is 0; must be positive");
}

TEST(BadCampaign, UnknownCriterion) {
    const std::string message = error_with("criterion: o3", "criterion: o9");
    EXPECT_EQ(message.rfind("campaign.yaml:21:12: criterion ", 0), 0U) << message;
    EXPECT_NE(message.find("o9"), std::string::npos) << message;
}

TEST(BadCampaign, NegativeSeed) {
    EXPECT_EQ(error_with("seed: 7", "seed: -7"),
              "campaign.yaml:22:7: seed is '-7'; must be a whole number from 0 to "
              "18446744073709551615");
}

TEST(BadCampaign, UnknownErrorModel) {
    EXPECT_EQ(error_with("  elements:", "  errors: completed\n  elements:"),
              "campaign.yaml:7:11: robot.errors is 'completed'; did you mean 'complete'?");
}

TEST(BadCampaign, MatMappingOfTooFewPoints) {
    EXPECT_EQ(error_with("[mA, mB]", "[mA]"),
              "campaign.yaml:24:28: measurements.mat.points names 1 variables; must name 2, one "
              "for each target of the sensor");
}

TEST(BadCampaign, MatMappingWithTheWrongUnit) {
    EXPECT_EQ(error_with("length_unit: mm", "length_unit: deg"),
              "campaign.yaml:24:68: measurements.mat.length_unit is 'deg'; must be mm, m or um");
}

}  // namespace
}  // namespace posewise::io
