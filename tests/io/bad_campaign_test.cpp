#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "posewise/io/campaign_file.hpp"
#include "support/temporary_folder.hpp"

// Each bad campaign file gives one line: the place, what is wrong and what would be right.

namespace posewise::io {
namespace {

using testing::campaign_text;
using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;

std::string error_of(const std::string& text) {
    const TemporaryFolder folder;
    const std::string path = folder.write("campaign.yaml", text);
    return input_error_of([&] { read_campaign(path); });
}

std::string error_with(const std::string& part, const std::string& by) {
    return error_of(replaced(campaign_text, part, by));
}

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
              "campaign.yaml: is larger than 1 MiB; must be smaller");
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
              "campaign.yaml:16:3: unknown key 'sigma' in sensor; did you mean 'sigma_mm'?");
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
              "campaign.yaml:16:13: sensor.sigma_mm is '-0.05'; must be positive");
    EXPECT_EQ(error_with("sigma_mm: 0.05", "sigma_mm: 0"),
              "campaign.yaml:16:13: sensor.sigma_mm is '0'; must be positive");
}

TEST(BadCampaign, NegativeModelError) {
    EXPECT_EQ(error_with("model_error_mm: 0.2", "model_error_mm: -1"),
              "campaign.yaml:18:17: model_error_mm is '-1'; must be zero or positive");
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
              "campaign.yaml:17:30: sensor.targets.known says that positions are known; needs "
              "position_mm, not count");
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
              "campaign.yaml:20:21: spread.length_mm is '0'; must be positive");
}

TEST(BadCampaign, UnknownCriterion) {
    const std::string message = error_with("criterion: o3", "criterion: o9");
    EXPECT_EQ(message.rfind("campaign.yaml:21:12: criterion: 'o9' is no criterion; must be", 0), 0U)
        << message;
}

TEST(BadCampaign, NegativeSeed) {
    EXPECT_EQ(error_with("seed: 7", "seed: -7"),
              "campaign.yaml:22:7: seed is '-7'; must be a whole number from 0 to "
              "18446744073709551615");
}

struct Slip {
    std::string part;
    std::string by;
    std::string error;  ///< from the line's number on
};

TEST(BadCampaign, MagnitudesThatNoCellHas) {
    for (const Slip& slip : std::vector<Slip>{
             {"Tx 312 mm", "Tx 1e200 m",
              "10:10: the amount is too large; must be at most 1e+06 m in magnitude"},
             {"0.5*q1", "1e-300*q1",
              "11:16: a joint's coefficient must be from 1e-6 to 1e6 in magnitude"},
             {"90 deg", "1e9 deg",
              "11:25: the amount is too large; must be at most 10000 rad in magnitude"},
             {"[0, 500]", "[0, 1e300]",
              "6:27: robot.joints.lift.limits_mm[2] is '1e300'; must be at most 1e+06 m in "
              "magnitude"},
             {"[100, 0, 0]", "[1e99, 0, 0]",
              "17:28: sensor.targets.position_mm[1][1] is '1e99'; must be at most 1e+06 m in "
              "magnitude"},
             {"sigma_mm: 0.05", "sigma_mm: 1e-300",
              "16:13: sensor.sigma_mm is '1e-300'; must be from 1e-12 to 1000 (m or rad)"},
             {"model_error_mm: 0.2", "model_error_mm: 2e6",
              "18:17: model_error_mm is '2e6'; must be from 1e-12 to 1000 (m or rad)"},
             {"dq2: 0.5 mrad", "dq2: 1e-200 rad",
              "20:57: spread.parameters.dq2 is '1e-200 rad'; must be from 1e-12 to 1000 (m or "
              "rad)"}}) {
        EXPECT_EQ(error_with(slip.part, slip.by), "campaign.yaml:" + slip.error);
    }
}

TEST(BadCampaign, ModelErrorMayBeZero) {
    EXPECT_EQ(error_with("model_error_mm: 0.2", "model_error_mm: 0"), "no error");
}

TEST(BadCampaign, NameOfTwoLines) {
    EXPECT_EQ(error_with("name: crane", "name: \"a\\nq1_rad,\\e[31m\""),
              "campaign.yaml:1:7: name is 'a\\x0aq1_rad,\\x1b[31m'; must be one line without "
              "control characters");
}

TEST(BadCampaign, TooManyJointsOrElements) {
    std::string elements;
    for (int i = 0; i < 1001; ++i) elements += "    - Tx 1 mm\n";
    EXPECT_EQ(error_with("    - Tz lift\n", "    - Tz lift\n" + elements),
              "campaign.yaml:8:5: robot.elements lists 1007 elements; must be at most 1000");
    std::string joints;
    for (int i = 0; i < 100; ++i)
        joints += "    a" + std::to_string(i) + ": {limits_deg: [0, 1]}\n";
    EXPECT_EQ(error_with("    lift:", joints + "    lift:"),
              "campaign.yaml:4:5: robot.joints states 103 joints; must be at most 100");
}

TEST(BadCampaign, ALongTextIsCutInTheMessage) {
    std::string omegas;
    for (int i = 0; i < 5000; ++i) omegas += "\u03a9";
    const std::string message = error_with("kind: points", "kind: " + omegas);
    EXPECT_LT(message.size(), 150U);
    EXPECT_NE(message.find("\u03a9...'; must be points"), std::string::npos) << message;
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

std::string error_with_terms(const std::string& keys) {
    return error_with("  elements:\n", keys + "\n  elements:\n");
}

TEST(BadCampaign, GravityAndHarmonicsThatCannotBe) {
    EXPECT_EQ(error_with_terms("  gravity: maybe").substr(0, 22), "campaign.yaml:7:12: ro");
    EXPECT_EQ(
        error_with_terms("  gravity: {direction: [0, 1, 0], joints: [q2]}"),
        "campaign.yaml:7:12: robot.gravity is not possible: joint 'q2' does not turn about an "
        "axis that stays perpendicular to gravity");
    EXPECT_EQ(error_with_terms("  gravity: {direction: [0, 0, 0]}"),
              "campaign.yaml:7:12: robot.gravity is not possible: direction of gravity must be "
              "finite and not zero");
    EXPECT_EQ(error_with_terms("  gravity: {joints: [q4]}").substr(0, 49),
              "campaign.yaml:7:22: 'q4' is no joint of the robot");
    EXPECT_EQ(
        error_with_terms("  harmonics: {orders: [1, 0]}"),
        "campaign.yaml:7:27: robot.harmonics.orders[2] is '0'; must be from 1e-3 to 1e4 a turn");
    EXPECT_EQ(error_with_terms("  harmonics: {orders: [1, 2, 1.0]}"),
              "campaign.yaml:7:30: robot.harmonics.orders[3] is '1.0' again; keep one");
    EXPECT_EQ(error_with_terms("  harmonics: {orders: []}").substr(0, 19), "campaign.yaml:7:23:");
    EXPECT_EQ(error_with_terms("  harmonics: {orders: [1], joints: [lift]}"),
              "campaign.yaml:7:14: robot.harmonics is not possible: joint 'lift' slides; harmonics "
              "need one that turns");
}

}  // namespace
}  // namespace posewise::io
