#include "program.hpp"

/// A robot from its URDF to a campaign, and calibrated back to its URDF.
namespace posewise::testing {
namespace {

/// Like a UR: quarter turns rounded as many files have them, a gripper beside the way.
const std::string urdf = R"(<?xml version="1.0"?>
<!-- An arm; its maker's comment -->
<robot name="arm">
  <link name="world"/>
  <link name="base"/>
  <joint name="stand" type="fixed">
    <parent link="world"/><child link="base"/>
    <origin xyz="0 0 0.5" rpy="0 0 0"/>
  </joint>
  <joint name="pan" type="revolute">
    <parent link="base"/><child link="shoulder"/>
    <origin xyz="0 0 0.1273" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="2"/>
  </joint>
  <link name="shoulder"/>
  <joint name='lift' type='revolute'>
    <parent link="shoulder"/><child link="upper_arm"/>
    <origin   xyz='0 0.05 0'   rpy = '1.5708 0.0 0'  />
    <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="2"/>
  </joint>
  <link name="upper_arm"/>
  <joint name="elbow" type="revolute">
    <parent link="upper_arm"/><child link="forearm"/>
    <origin rpy="1.5708 0 0"
            xyz="-0.612 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="2"/>
  </joint>
  <link name="forearm"/>
  <joint name="wrist-1" type="revolute">
    <parent link="forearm"/><child link="wrist_1"/>
    <origin xyz="-0.5723 0 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="2"/>
  </joint>
  <link name="wrist_1"/>
  <joint name="wrist-2" type="continuous">
    <parent link="wrist_1"/><child link="wrist_2"/>
    <origin xyz="0 0.1639 0"/>
    <axis xyz="0 0.1 1"/>
  </joint>
  <link name="wrist_2"/>
  <joint name="wrist-3" type="revolute"><parent link="wrist_2"/><child link="wrist_3"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="1" velocity="2"/></joint>
  <link name="wrist_3"/>
  <link name="tool0"/>
  <joint name="flange" type="fixed">
    <parent link="wrist_3"/><child link="tool0"/>
    <origin xyz="0 0.0922 0" rpy="-1.5708 0 0"/>
  </joint>
  <link name="finger"/>
  <joint name="grip" type="prismatic">
    <parent link="wrist_3"/><child link="finger"/>
    <axis xyz="1 0 0"/>
    <mimic joint="wrist-3"/>
  </joint>
</robot>
)";

class Urdf : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_text("arm.urdf", urdf);
    }

    /// Copies a file with parts of it replaced.
    void rewrite(const std::string& from, const std::string& to,
                 const std::vector<std::pair<std::string, std::string>>& changes) const {
        std::string text = text_of(from);
        for (const auto& [part, by] : changes) {
            ASSERT_NE(text.find(part), std::string::npos) << part;
            text.replace(text.find(part), part.size(), by);
        }
        write_text(to, text);
    }

    /// What inspect --write-campaign leaves open.
    void fill_in(const std::string& campaign) const {
        rewrite(campaign, campaign,
                {{"# base:", "base:"},
                 {"robot:\n", "robot:\n  errors: geometric\n"},
                 {"{count: 3}", "{position_mm: [[100, 0, 50], [0, 100, 50], [-80, -80, 60]]}"}});
    }
};

TEST_F(Urdf, IsInspectedWithoutACampaign) {
    const std::string text = run_well("inspect arm.urdf --base base --tip tool0");
    EXPECT_EQ(text.rfind("arm\n", 0), 0U) << text;
    EXPECT_NE(text.find("33 of its 45 parameters are identifiable; by the formula 4R + 2P + 3n = "
                        "4*6 + 2*0 + 3*3 = 33"),
              std::string::npos)
        << text;
    EXPECT_EQ(number_behind(text, "least number of poses:"), 3);
    EXPECT_NE(text.find("wrist_2  revolute      -180      180  deg"), std::string::npos) << text;
    EXPECT_NE(text.find("lift     0.000000  -1.000000  -0.000004"), std::string::npos) << text;
    EXPECT_NE(text.find("1 mm Ty_lift = "), std::string::npos) << "dropped: the next is parallel";
    EXPECT_EQ(number_behind(text, "flange at zero: position"), -1184.3);
}

TEST_F(Urdf, NeedsATipWhereThereAreSeveral) {
    expect_input_error("inspect arm.urdf",
                       "arm.urdf: the tip link must be named (--tip), it could be finger or tool0");
    expect_input_error("inspect arm.urdf --tip tol0", "did you mean 'tool0'?");
    expect_input_error("inspect arm.urdf --tip finger --write-campaign c.yaml",
                       "drives a rotation and a translation");
}

TEST_F(Urdf, IsTakenAsRealFilesAre) {
    const auto with = [&](const std::string& part, const std::string& by) {
        std::string text = urdf;
        EXPECT_NE(text.find(part), std::string::npos) << part;
        write_text("real.urdf", text.replace(text.find(part), part.size(), by));
    };
    const std::string limit = R"(<limit lower="-3" upper="3" effort="1" velocity="2"/>)";
    const std::string inspect = "inspect real.urdf --base base --tip tool0";
    with(limit, R"(<limit lower="-3" upper="3" effort="1" velocity="2" command_effort="1"/>)");
    Outcome outcome = run(inspect);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err,
              "posewise: warning: real.urdf:14:5: joint 'pan' has limit with unknown attribute "
              "'command_effort', which is left out\n");
    run(inspect + " --write-campaign real.yaml");
    EXPECT_NE(run("inspect real.yaml").err.find("'command_effort', which is left out"),
              std::string::npos);
    with(limit, R"(<limit lower="-1e16" upper="1e16" effort="1" velocity="2"/>)");
    EXPECT_NE(run_well(inspect).find("pan      revolute      -180      180  deg"),
              std::string::npos);
    with(limit, R"(<limit effort="1" velocity="2"/>)");
    outcome = run(inspect + " --write-campaign free.yaml");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("joint 'pan' has no limits that leave it room; must have, here or "
                               "in a campaign under robot.joints\n"),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(text_of("free.yaml")
                  .find("    pan: {limits_deg: [-180, 180]}  # FILL IN: none in the URDF\n"),
              std::string::npos)
        << text_of("free.yaml");
    run_well("inspect free.yaml");
}

/// A parallel arm: the elbow's second joint follows it. Calibrated, exported and read again.
TEST_F(Urdf, TakesAMimicForACoupling) {
    std::string text = urdf;
    const std::string limit = R"(    <limit lower="-3" upper="3" effort="1" velocity="2"/>
  </joint>
  <link name="wrist_1"/>)";
    ASSERT_NE(text.find(limit), std::string::npos);
    text.replace(text.find(limit), limit.size(),
                 "    <mimic joint=\"elbow\" multiplier=\"-1\" offset=\"0.3\"/>\n" + limit);
    write_text("mimic.urdf", text);
    run_well("inspect mimic.urdf --base base --tip tool0 --write-campaign c.yaml");
    EXPECT_EQ(text_of("c.yaml").find("wrist_1:"), std::string::npos) << text_of("c.yaml");
    fill_in("c.yaml");
    run_well("simulate c.yaml --poses 25 --truth 5 -o m.csv");
    const std::string calibrated = run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    EXPECT_LT(number_behind(calibrated, "distance RMS", 1), 0.3) << calibrated;
    run_well("export c.yaml e.json --urdf out.urdf");
    rewrite("c.yaml", "out.yaml",
            {{"errors: geometric\n  urdf: \"mimic.urdf\"", "errors: stated\n  urdf: out.urdf"}});
    const std::string again = run_well("calibrate out.yaml -m m.csv --folds 0");
    EXPECT_NEAR(number_behind(again, "distance RMS", 1),
                number_behind(calibrated, "distance RMS", 1), 2e-4);
}

TEST_F(Urdf, NeedsNoLinksWhereTheyAreTheOnlyOnes) {
    write_text("c.yaml",
               "name: arm\nrobot:\n  urdf: arm.urdf\n  tip_link: tool0\nsensor: {kind: points, "
               "sigma_mm: 0.05, targets: {count: 3}}\n");
    EXPECT_NE(run_well("inspect c.yaml").find("from base link 'world' to tip link 'tool0'"),
              std::string::npos);
    write_text("n.yaml",
               "name: arm\nrobot: {urdf: arm.urdf}\nsensor: {kind: points, sigma_mm: "
               "0.05, targets: {count: 3}}\n");
    expect_input_error("inspect n.yaml", "the tip link must be named (--tip), it could be");
}

TEST_F(Urdf, BecomesACampaignThatLoads) {
    std::filesystem::create_directory(folder_ / "cell");
    run_well("inspect arm.urdf --base base --tip tool0 --write-campaign cell/campaign.yaml");
    const std::string campaign = text_of("cell/campaign.yaml");
    EXPECT_NE(campaign.find("urdf: \"../arm.urdf\""), std::string::npos) << campaign;
    EXPECT_NE(campaign.find("FILL IN"), std::string::npos);
    EXPECT_EQ(campaign.find("\nspread:"), std::string::npos) << "the model's own sizes act";
    const std::string text = run_well("inspect cell/campaign.yaml");
    EXPECT_NE(text.find("33 of its 45 parameters"), std::string::npos) << text;
    expect_input_error("inspect arm.urdf --tip tool0 --write-campaign cell/campaign.yaml",
                       "cell/campaign.yaml: exists already; must be a new file");
    expect_input_error("inspect arm.urdf --tip tool0 --write-campaign none/campaign.yaml",
                       "none/campaign.yaml: cannot be written");
    expect_input_error("inspect arm.urdf --tip tool0 --write-campaign arm.urdf",
                       "is read and shall be written");
    EXPECT_EQ(text_of("arm.urdf"), urdf);
}

/// inspect, simulate, calibrate, export: with the exported URDF and base and targets fitted only,
/// the same measurements fit as well as with the estimate.
TEST_F(Urdf, IsCalibrated) {
    run_well("inspect arm.urdf --base base --tip tool0 --write-campaign c.yaml");
    fill_in("c.yaml");
    run_well("simulate c.yaml --poses 20 --truth 5 -o m.csv");
    const std::string calibrated = run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    const std::string text = run_well("export c.yaml e.json --urdf out.urdf");
    EXPECT_NE(text.find("origins of 5 joints changed"), std::string::npos) << text;
    EXPECT_LT(number_behind(text, "out.urdf read back: the flange is within"), 1e-12);
    EXPECT_EQ(text.find("lost"), std::string::npos) << "no terms";
    EXPECT_NE(
        text.find("not part of the robot: where the instrument sees base link 'base' (position 2"),
        std::string::npos)
        << text;

    rewrite("c.yaml", "out.yaml",
            {{"errors: geometric\n  urdf: \"arm.urdf\"", "errors: stated\n  urdf: out.urdf"}});
    const std::string again = run_well("calibrate out.yaml -m m.csv --folds 0");
    EXPECT_EQ(number_behind(again, "distance RMS", 1),
              number_behind(calibrated, "distance RMS", 1));
    EXPECT_GT(number_behind(calibrated, "distance RMS"),
              5 * number_behind(calibrated, "distance RMS", 1));

    const std::string exported = text_of("out.urdf");
    EXPECT_EQ(exported.substr(0, exported.find("<joint name=\"pan\"")),
              urdf.substr(0, urdf.find("<joint name=\"pan\"")));
    EXPECT_NE(exported.find("xyz='"), std::string::npos) << "quotation marks stay";
    const std::string table = run_well("export c.yaml e.json --dh table.yaml");
    EXPECT_NE(table.find("the calibrated robot in "), std::string::npos);
    EXPECT_NE(text_of("table.yaml").find("convention: standard"), std::string::npos);
    EXPECT_NE(table.find("rows 2, 3, 6: RotZ(theta) TransX(a) RotX(alpha) RotY(beta) (Hayati)"),
              std::string::npos)
        << table;
}

TEST_F(Urdf, IsNotOverwrittenNorMadeFromAnotherRobot) {
    run_well("inspect arm.urdf --base base --tip tool0 --write-campaign c.yaml");
    expect_input_error("export c.yaml e.json --urdf arm.urdf", "is read and shall be written");
    expect_input_error("export c.yaml e.json --dh d.yaml --workspace d.yaml",
                       "is read and shall be written");
    expect_input_error("export c.yaml e.json --urdf c.yaml", "is read and shall be written");
    expect_input_error("export c.yaml none.json --urdf o.urdf", "none.json: cannot be read");
    expect_input_error("export " + fanuc_design + " e.json --urdf o.urdf",
                       "has a robot that does not come from a URDF");
    for (const char* const command :
         {"calibrate c.yaml -m m.csv --out",
          "calibrate c.yaml -m m.csv --predict p.csv --predict-out", "plan c.yaml --poses 20 --out",
          "plan c.yaml --poses 20 --csv", "select c.yaml -m m.csv -k 3 --out",
          "study c.yaml -m m.csv --csv", "simulate c.yaml --poses 5 --out",
          "correct c.yaml e.json --poses p.csv --out", "export c.yaml e.json --dh",
          "export c.yaml e.json --ur-kinematics"}) {
        expect_input_error(std::string(command) + " ./arm.urdf", "is read and shall be written");
    }
    fill_in("c.yaml");
    write_text("other.urdf", urdf);
    rewrite("c.yaml", "other.yaml", {{"arm.urdf", "other.urdf"}});
    run_well("simulate c.yaml --poses 20 -o m.csv");
    expect_input_error(
        "calibrate c.yaml -m m.csv --validate m.csv --refit base,targets --validate-campaign "
        "other.yaml --out other.urdf",
        "other.urdf: is read and shall be written");
    EXPECT_EQ(text_of("arm.urdf"), urdf);
    EXPECT_EQ(text_of("other.urdf"), urdf);
}

}  // namespace
}  // namespace posewise::testing
