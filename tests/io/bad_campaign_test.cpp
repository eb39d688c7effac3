#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "posewise/io/campaign_file.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

// Each bad campaign file gives one line: the place, what is wrong and what would be right.

namespace posewise::io {
namespace {

using namespace testing;

std::string campaign_error(const std::string& text) {
    const TemporaryFolder folder;
    const std::string path = folder.write("campaign.yaml", text);
    return input_error_of([&] { read_campaign(path); });
}

void expect_campaign_messages(const std::vector<Slip>& slips) {
    expect_messages(campaign_text, slips, campaign_error, "campaign.yaml:");
}

TEST(BadCampaign, Files) {
    const TemporaryFolder folder;
    EXPECT_EQ(input_error_of([&] { read_campaign(folder.path("none.yaml")); }),
              "none.yaml: cannot be read: No such file or directory");
    std::filesystem::create_directory(folder.path("folder"));
    EXPECT_EQ(input_error_of([&] { read_campaign(folder.path("folder")); }),
              "folder: is a directory; must be a file");
    EXPECT_NE(campaign_error(std::string("\0\xFF\xFE\x01", 4)), "no error");
    expect_campaign_messages({
        {campaign_text, "", " is empty, or begins with no key; must be a campaign in YAML"},
        {campaign_text, ", a", " is empty, or begins with no key; must be a campaign in YAML"},
        {campaign_text, "name: \"a\\\x01\"\n",
         "1:11: is not YAML: unknown escape character: \\x01; correct it there or just before"},
        {campaign_text, "# nothing\n",
         " is empty, or begins with no key; must be a campaign in YAML"},
        {campaign_text, std::string(2 << 20, 'a'), " is larger than 1 MiB; must be smaller"},
        {campaign_text, "name: a\nrobot: \xC3\xA4\xE9\n",
         "2:10: is not UTF-8 text here; must be UTF-8 (or plain ASCII)"},
        {campaign_text, "just words\n",
         "1:1: the file is 'just words'; must be a map of keys and values"},
        {campaign_text, "name: [a, b\nrobot: {\n", "[...]is not YAML[...]"},
        {"name: crane\n", "name: \"\"\n",
         "1:7: name is empty; must be what the campaign is called"},
        {campaign_text, "name: a\n---\nname: b\n",
         "2:1: a second document begins; must be one document"},
    });
}

TEST(BadCampaign, HostileNesting) {
    for (const std::string part : {"[", "{a: ", "- ", "? ", "&a [", "'", "\"", "!!", "<<: *a\n"}) {
        std::string text;
        while (text.size() < 100000) text += part;
        EXPECT_NE(campaign_error(text), "no error") << part;
    }
}

TEST(BadCampaign, Keys) {
    expect_campaign_messages({
        {"name: crane\n", "", "1:1: the file has no key name; it must be stated"},
        {"position_mm: [1000, 0, -500], ", "",
         "19:7: base has no key position_mm, position_m or position_um; it must be stated"},
        {"sensor:", "sensr:", "14:1: unknown key 'sensr'; did you mean 'sensor'?"},
        {"  kind:", "  knid:", "15:3: unknown key 'knid' in sensor; did you mean 'kind'?"},
        {"  mat:", "  spreadsheet:",
         "24:3: unknown key 'spreadsheet' in measurements; must be columns, mat or observation"},
        {"sigma_mm", "sigma", "16:3: unknown key 'sigma' in sensor; did you mean 'sigma_mm'?"},
        {"seed: 7", "name: again", "22:1: key 'name' occurs twice, first in line 1; keep one"},
        {"sigma_mm: 0.05", "sigma_mm: 0.05\n  sigma_um: 50",
         "17:3: 'sigma' is stated in two units; keep one"},
        {"name: crane", "name:", "1:1: name has no value; must be text"},
        {"name: crane", "name: \"a\\nq1_rad,\\e[31m\"",
         "1:7: name is 'a\\x0aq1_rad,\\x1b[31m'; must be one line without control characters"},
    });
}

TEST(BadCampaign, Robots) {
    std::string elements = "    - Tz lift\n";
    for (int i = 0; i < 1001; ++i) elements += "    - Tx 1 mm\n";
    std::string joints;
    for (int i = 0; i < 100; ++i) {
        joints += "    a" + std::to_string(i) + ": {limits_deg: [0, 1]}\n";
    }
    expect_campaign_messages({
        {"    q2: {", "    q1: {", "5:5: key 'q1' occurs twice, first in line 4; keep one"},
        {"    lift: {", "    mm: {",
         "6:5: 'mm' cannot name a joint; must be letters, digits and underscores, not a unit"},
        {"    - Tz lift\n", "", "6:5: joint 'lift' drives no element; must occur in one"},
        {"Rz q1", "Rz q4", "8:10: 'q4' is no joint of the robot; did you mean 'q1'?"},
        {"limits_mm", "limits_deg",
         "6:24: robot.joints.lift.limits_deg is in 'deg', but the joint drives a translation; "
         "must be in mm, m or um"},
        {"[-90, 90]", "[90, -90]",
         "4:22: robot.joints.q1.limits_deg is not in order; the lower limit must come first"},
        {"[-90, 90]", "[90]", "4:22: robot.joints.q1.limits_deg has 1 values; must have 2"},
        {"    - Tz lift\n", elements,
         "8:5: robot.elements lists 1007 elements; must be at most 1000"},
        {"    lift:", joints + "    lift:",
         "4:5: robot.joints states 103 joints; must be at most 100"},
        {"  elements:", "  errors: geometrical\n  elements:",
         "7:11: robot.errors is 'geometrical'; did you mean 'geometric'?"},
    });
}

TEST(BadCampaign, Numbers) {
    const std::string rule = "; must be a finite number without unit";
    const std::string range = "; must be from 1e-09 to 1e+06 mm";
    expect_campaign_messages({
        {"[-90, 90]", "[-90, .inf]",
         "4:28: robot.joints.q1.limits_deg[2] is '.inf', which is not a number" + rule},
        {"sigma_mm: 0.05", "sigma_mm: nan",
         "16:13: sensor.sigma_mm is 'nan', which is not finite" + rule},
        {"sigma_mm: 0.05", "sigma_mm: 1e999",
         "16:13: sensor.sigma_mm is '1e999', which is beyond the range of numbers" + rule},
        {"model_error_mm: 0.2", "model_error_mm: 0.2 mm",
         "18:17: model_error_mm is '0.2 mm', which is not a number" + rule + ", or auto"},
        {"sigma_mm: 0.05", "sigma_mm: -0.05",
         "16:13: sensor.sigma_mm is '-0.05'; must be positive"},
        {"sigma_mm: 0.05", "sigma_mm: 0", "16:13: sensor.sigma_mm is '0'; must be positive"},
        {"model_error_mm: 0.2", "model_error_common: 1.1",
         "18:21: model_error_common is '1.1'; must be from 0 to 1"},
        {"model_error_mm: 0.2", "model_error_mm: -1",
         "18:17: model_error_mm is '-1'; must be zero or positive"},
        {"length_mm: 2", "length_mm: 0", "20:21: spread.length_mm is '0'; must be positive"},
        {"seed: 7", "seed: -7",
         "22:7: seed is '-7'; must be a whole number from 0 to 18446744073709551615"},
        {"Tx 312 mm", "Tx 1e200 m",
         "10:10: the amount is too large; must be at most 1e+06 m in magnitude"},
        {"0.5*q1", "1e-300*q1",
         "11:16: a joint's coefficient must be from 1e-6 to 1e6 in magnitude"},
        {"90 deg", "1e9 deg",
         "11:25: the amount is too large; must be at most 572958 deg in magnitude"},
        {"[0, 500]", "[0, 1e300]",
         "6:27: robot.joints.lift.limits_mm[2] is '1e300'; must be at most 1e+09 mm in magnitude"},
        {"[100, 0, 0]", "[1e99, 0, 0]",
         "17:28: sensor.targets.position_mm[1][1] is '1e99'; must be at most 1e+09 mm in "
         "magnitude"},
        {"sigma_mm: 0.05", "sigma_mm: 1e-300", "16:13: sensor.sigma_mm is '1e-300'" + range},
        {"model_error_mm: 0.2", "model_error_mm: 2e6", "18:17: model_error_mm is '2e6'" + range},
        {"length_mm: 2", "length_mm: 2, offset_mrad: 2e6",
         "20:37: spread.offset_mrad is '2e6'; must be from 1e-09 to 3141.59 mrad"},
        {"angle_mrad: 3", "angle_mrad: 7000",
         "20:36: spread.angle_mrad is '7000'; must be from 1e-09 to 3141.59 mrad"},
        {"length_mm: 2", "length_mm: 2e4",
         "20:21: spread.length_mm is '2e4'; must be from 1e-09 to 10000 mm"},
        {"length_mm: 2", "length_mm: 2, offset_deg: -0.1",
         "20:36: spread.offset_deg is '-0.1'; must be positive"},
        {"dq2: 0.5 mrad", "dq2: 1e-200 rad",
         "20:57: spread.parameters.dq2 is '1e-200 rad'; must be from 1e-12 to 3.14159 rad"},
        {"model_error_mm: 0.2", "model_error_mm: Auto",
         "18:17: model_error_mm is 'Auto', which is not a number" + rule + ", or auto"},
        {"model_error_mm: 0.2", "model_error_mm: [0.1]",
         "18:17: model_error_mm is a list; must be a number, or auto"},
        {"sigma_mm: 0.05", "sigma_mm: 1e10", "16:13: sensor.sigma_mm is '1e10'" + range},
    });
    EXPECT_EQ(campaign_error(replaced(campaign_text, "model_error_mm: 0.2", "model_error_mm: 0")),
              "no error");
}

TEST(BadCampaign, SensorsAndTheRest) {
    const std::string positions = "position_mm: [[100, 0, 0], [0, 200, -10]]";
    const std::string either = "17:12: sensor.targets must have either count or position_mm";
    expect_campaign_messages({
        {"kind: points", "kind: point", "15:9: sensor.kind is 'point'; did you mean 'points'?"},
        {"{position_mm", "{count: 2, position_mm", either},
        {positions, "known: false", either},
        {positions, "count: 2, known: true",
         "17:30: sensor.targets.known says that positions are known; needs position_mm, not count"},
        {positions, "count: 0", "17:20: sensor.targets.count is 0; must be from 1 to 1000"},
        {"[[100, 0, 0], [0, 200, -10]]", "[]",
         "17:26: sensor.targets.position_mm is empty; must list at least one target"},
        {"[100, 0, 0]", "[100, 0]",
         "17:27: sensor.targets.position_mm[1] has 2 values; must have 3"},
        {"{dq2: 0.5 mrad", "{dq3: 0.5 mrad",
         "20:52: 'dq3' is no parameter of this campaign; did you mean 'dq1'?"},
        {"dq2: 0.5 mrad", "dq2: 0.5 mm",
         "20:57: spread.parameters.dq2 is '0.5 mm'; must be a positive number and a unit, deg, "
         "rad[...]"},
        {"criterion: o3", "criterion: o9", "21:12: criterion: 'o9' is no criterion; must be[...]"},
        {"[mA, mB]", "[mA]",
         "24:28: measurements.mat.points names 1 variables; must name 2, one for each target of "
         "the sensor"},
        {"length_unit: mm", "length_unit: deg",
         "24:68: measurements.mat.length_unit is 'deg'; must be mm, m or um"},
    });
}

TEST(BadCampaign, ALongTextIsCutInTheMessage) {
    std::string omegas;
    for (int i = 0; i < 5000; ++i) omegas += "\u03a9";
    const std::string message =
        campaign_error(replaced(campaign_text, "kind: points", "kind: " + omegas));
    EXPECT_LT(message.size(), 170U);
    EXPECT_NE(message.find("\u03a9...'; must be points"), std::string::npos) << message;
}

TEST(BadCampaign, PitchesThatCannotBe) {
    const std::string number = ", which is not a number; must be a finite number without unit";
    const std::string of_lift = "6:43: robot.joints.lift.pitch_mm is ";
    const auto lift = [](const std::string& pitch) {
        return "limits_mm: [0, 500], pitch_" + pitch;
    };
    expect_campaign_messages({
        {"limits_mm: [0, 500]", lift("mm: 0"), of_lift + "'0'; must be from 0.001 to 1000 mm"},
        {"limits_mm: [0, 500]", lift("mm: -20"), of_lift + "'-20'; must be from 0.001 to 1000 mm"},
        {"limits_mm: [0, 500]", lift("mm: .nan"), of_lift + "'.nan'" + number},
        {"limits_mm: [0, 500]", lift("m: 20"),
         "6:42: robot.joints.lift.pitch_m is '20'; must be from 1e-06 to 1 m"},
        {"limits_mm: [0, 500]", lift("deg: 20"),
         "6:33: unknown key 'pitch_deg' in robot.joints.lift; did you mean 'pitch_mm'?"},
        {"limits_deg: [-90, 90]", "limits_deg: [-90, 90], pitch_mm: 20",
         "4:43: robot.joints.q1.pitch_mm is stated, but the joint turns; must be of one that "
         "slides"},
    });
}

TEST(BadCampaign, GravityAndHarmonicsThatCannotBe) {
    std::vector<Slip> slips{
        {"", "gravity: maybe", "7:12: ro[...]"},
        {"", "gravity: {direction: [0, 1, 0], joints: [q2]}",
         "7:12: robot.gravity is not possible: joint 'q2' does not turn about an axis that stays "
         "perpendicular to gravity"},
        {"", "gravity: {direction: [0, 0, 0]}",
         "7:24: robot.gravity.direction is zero; must point the way that weights pull"},
        {"", "gravity: {joints: [q4]}", "7:22: 'q4' is no joint of the robot[...]"},
        {"", "harmonics: {orders: [1, 0]}",
         "7:27: robot.harmonics.orders[2] is '0'; must be from 1e-3 to 1e4 a turn"},
        {"", "harmonics: {orders: [1, 2, 1.0]}",
         "7:30: robot.harmonics.orders[3] is '1.0' again; keep one"},
        {"", "harmonics: {orders: []}", "7:23:[...]"},
        {"", "axis_tilt: {joints: [q1]}", "7:14: robot.axis_tilt has no key orders[...]"},
        {"", "harmonics: {orders: [1], joints: [lift]}",
         "7:14: robot.harmonics is not possible: joint 'lift' slides; harmonics need its pitch, or "
         "a joint that turns"},
        {"", "axis_tilt: {orders: [1], joints: [lift]}",
         "7:14: robot.axis_tilt is not possible: joint 'lift' slides; tilts need one that turns"},
    };
    for (Slip& slip : slips) {
        slip.part = "  elements:\n";
        slip.by = "  " + slip.by + "\n  elements:\n";
    }
    expect_campaign_messages(slips);
}

}  // namespace
}  // namespace posewise::io
