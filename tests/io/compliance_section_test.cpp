#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "mat_writer.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaign_from.hpp"
#include "support/temporary_folder.hpp"

// Compliances in a campaign file, the torques they need, and the masses of a URDF.

namespace posewise::io {
namespace {

using namespace testing;

/// The crane, its second joint level, with a section `compliance`.
std::string text_with(const std::string& compliance) {
    const std::string level = replaced(campaign_text, "Ry -q2 + 0.5*q1", "Ry -q2");
    return replaced(level, "  elements:\n", "  compliance: " + compliance + "\n  elements:\n");
}

CampaignFile read_with(const std::string& compliance) {
    return campaign_from(text_with(compliance));
}

const std::string weights = "{links: {q2: {mass_kg: 10, center_mm: [0, 0, 500]}}}";
const std::string torques = "{torques_Nm: {q2: 300, q1: 40}}";

TEST(ComplianceSection, TakesWeightsOfLinksAndPayload) {
    const Chain robot = read_with(weights).robot;
    ASSERT_EQ(compliances(robot).size(), 1U);
    EXPECT_EQ(compliances(robot)[0].joint, 1);
    EXPECT_EQ(robot.parameter_names()[3], "q2.compliance");
    EXPECT_NEAR(compliances(robot)[0].largest, 10 * 9.80665 * 0.5, 0.01);
    EXPECT_TRUE(robot.torques().empty());

    // At the flange: 1.5 m behind, the arm is level at q2 = 90 deg, so that it pulls with q2.
    const Chain loaded =
        read_with("{payload: {mass_kg: 2, center_mm: [0, 0, 0]}, joints: [q2]}").robot;
    EXPECT_NEAR(compliances(loaded)[0].largest, 2 * 9.80665 * 1.5, 0.1);
    const Campaign campaign = read_with(weights);
    EXPECT_EQ(parameter_scale(campaign)[6 + 3], 1e-3);
    EXPECT_THROW(read_with("{payload: {mass_kg: 2, center_mm: [0, 0, 0]}, joints: [q1]}"),
                 InputError);
}

TEST(ComplianceSection, TakesMeasuredTorques) {
    const Chain robot = read_with(torques).robot;
    ASSERT_EQ(robot.torques().size(), 2U);
    EXPECT_EQ(robot.torques()[0].joint, 1);
    EXPECT_EQ(robot.torques()[0].largest, 300);
    EXPECT_EQ(robot.configuration_size(), 5);
    EXPECT_EQ(compliances(robot)[1].largest, 300);
}

TEST(ComplianceSection, SaysWhatIsWrong) {
    std::vector<Slip> slips{
        {"", "{}",
         "15: robot.compliance states no weight; must have links, payload or torques_Nm[...]"},
        {"", "{links: {q4: {mass_kg: 1, center_mm: [0, 0, 0]}}}",
         "24: 'q4' is no joint of the robot; did you mean[...]"},
        {"", "{links: {q2: {mass_kg: 0, center_mm: [0, 0, 0]}}}",
         "38: robot.compliance.links.q2.mass_kg is '0'; must be from 1e-06 to 100000 kg[...]"},
        {"", "{links: {q2: {mass_kg: 1}}}",
         "28: robot.compliance.links.q2 has no key center_mm,[...]"},
        {"", "{links: urdf}",
         "23: robot.compliance.links is urdf, but the robot does not come from one[...]"},
        {"", "{links: all}",
         "23: robot.compliance.links must be a map of joints, or urdf for the masses of[...]"},
        {"", "{links: [q2]}", "23: robot.compliance.links must be a map of joints, or urdf[...]"},
        {"", "{torques_Nm: {q2: -3}}",
         "33: robot.compliance.torques_Nm.q2 is '-3'; must be from 1e-06 to 1e+06 N m[...]"},
        {"", "{torques_Nm: {}}",
         "28: robot.compliance.torques_Nm is empty; must state the largest torque of[...]"},
        {"", "{torques_Nm: {q4: 3}}", "29: 'q4' is no joint of the robot; did you mean[...]"},
        {"", "{torques_Nm: {lift: 3}}",
         "28: robot.compliance.torques_Nm is not possible: the measured torque of joint 'lift' is "
         "of one that slides[...]"},
        {"", "{torques_Nm: {q2: 3}, joints: [q2]}",
         "45: robot.compliance.joints is stated beside torques_Nm;[...]"},
        {"", "{links: {q2: {mass_kg: 1, center_mm: [0, 0, 1]}}, direction: [0, 0, 0]}",
         "76: robot.compliance.direction is zero; must point the way that weights pull"},
        {"", "{links: {q2: {mass_kg: 1, center_mm: [0, 0, 1]}}, joints: [q2, q2]}",
         "78: robot.compliance.joints[2] lists 'q2' twice; keep one[...]"},
        {"", "true", "15: [...]"},
    };
    for (Slip& slip : slips) slip.part = weights;
    expect_messages(
        text_with(weights), slips,
        [](const std::string& text) { return input_error_of([&] { campaign_from(text); }); },
        "campaign.yaml:7:");
}

const std::string measured =
    "config,sample,q1_rad,q2_rad,lift_m,tau_q1_Nm,tau_q2_Nm,p1_x_m,p1_y_m,p1_z_m,p2_x_m,p2_y_m,"
    "p2_z_m\n"
    "a,0,0.1,0.2,0.3,5,100,1,2,3,4,5,6\n"
    "a,1,0.1,0.2,0.3,7,104,1.5,2,3,4,5,6\n"
    "b,0,0.1,0.2,0.3,5,200,7,8,9,10,11,12\n";

TEST(MeasuredTorques, AreMeansBehindTheJoints) {
    const TemporaryFolder folder;
    const std::string path = folder.write("m.csv", measured);
    const Campaign campaign = read_with(torques);
    const Measurements read = read_measurements_csv(path, campaign);
    ASSERT_EQ(read.configurations.cols(), 5);
    EXPECT_EQ(read.configuration_count(), 2);   // equal joints, another load
    EXPECT_EQ(read.configurations(0, 3), 102);  // of q2, as the campaign lists it first
    EXPECT_EQ(read.configurations(0, 4), 6);
    EXPECT_EQ(read.configurations(1, 3), 200);

    write_measurements_csv(folder.path("w.csv"), campaign, read, {});
    EXPECT_EQ(read_measurements_csv(folder.path("w.csv"), campaign).configurations,
              read.configurations);
    // Who makes no use of them may leave them in the file.
    const std::string other = replaced(measured, "b,0,0.1,0.2,", "b,0,0.1,0.3,");
    EXPECT_EQ(read_measurements_csv(folder.write("o.csv", other), read_with(weights))
                  .configurations.cols(),
              3);
}

TEST(MeasuredTorques, ThatAreMissingAreAskedFor) {
    const TemporaryFolder folder;
    const Campaign campaign = read_with(torques);
    const auto error = [&](const std::string& text) {
        const std::string path = folder.write("m.csv", text);
        return input_error_of([&] { read_measurements_csv(path, campaign); });
    };
    const std::vector<Slip> slips{
        {"tau_q2_Nm", "tau_q3_Nm", "1:46: column 'tau_q3_Nm' is unknown; di[...]"},
        {"tau_q2_Nm", "tau_q2", "1:46: column 'tau_q2' has no unit; must be like tau_q2_Nm"},
        {"tau_q2_Nm", "tau_q2_mm",
         "1:46: column 'tau_q2_mm' has the wrong kind of unit; must be like tau_q2_Nm"},
        {",100,", ",nan,", "2:19: [...]"},
        {",100,", ",-700,",
         "2:19: the torque of q2 is -700 N m, over twice the largest that the campaign states, "
         "300; correct compliance.torques_Nm or the unit here"},
        {",100,", ",1e7,", "2:19: '1e7' is out of any cell; must be at most 1e+06 Nm in magnitude"},
        {measured, "config,q1_rad,q2_rad,lift_m,p1_x_m,p1_y_m,p1_z_m,p2_x_m,p2_y_m,p2_z_m\n",
         "[...]missing columns tau_q2_Nm, tau_q1_Nm;[...]"},
    };
    expect_messages(measured, slips, error, "m.csv:");
}

TEST(MeasuredTorques, AreAVariableOfAMatFile) {
    const TemporaryFolder folder;
    const CampaignFile file = read_campaign(folder.write(
        "c.yaml", replaced(text_with(torques), "joints: q,", "joints: q, torques: T,")));
    const std::string path = folder.path("m.mat");
    const auto write = [&](std::size_t torque_rows) {
        mat_t* const mat = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
        add_matrix(mat, "q", 2, 3, {10, 20, 30, 40, 100, 200});
        add_matrix(mat, "T", torque_rows, 2, {1, 2, 3, 4, 5, 6});
        add_matrix(mat, "mA", 2, 3, {1, 2, 3, 4, 5, 6});
        add_matrix(mat, "mB", 2, 3, {1, 2, 3, 4, 5, 6});
        Mat_Close(mat);
    };
    write(2);
    const Measurements read = read_measurements(path, file);
    ASSERT_EQ(read.configurations.cols(), 5);
    EXPECT_EQ(read.configurations(1, 3), 2);
    EXPECT_EQ(read.configurations(1, 4), 4);
    write(3);
    EXPECT_EQ(input_error_of([&] { read_measurements(path, file); }),
              "m.mat: variable 'T' has 3 rows; must have 2 as 'q'");
}

const std::string urdf = R"(<robot name="arm">
  <link name="base"><inertial><mass value="30"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.1 0.2 0.3" rpy="1 0 0"/><mass value="4"/></inertial></link>
  <link name="plate"><inertial><origin xyz="0 0 0.05"/><mass value="2"/></inertial></link>
  <link name="tool"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="arm"/>
    <origin xyz="0 0 0.5" rpy="0.3 0 0"/><axis xyz="0.6 0.8 0"/><limit lower="-1" upper="1"/>
  </joint>
  <joint name="weld" type="fixed">
    <parent link="arm"/><child link="plate"/><origin xyz="0.4 0 0" rpy="0 0.5 0"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="plate"/><child link="tool"/><axis xyz="1 0 0"/><limit lower="-1" upper="1"/>
  </joint>
</robot>
)";

TEST(UrdfLoads, StandWhereTheFileSays) {
    const TemporaryFolder folder;
    const UrdfSource source{folder.write("arm.urdf", urdf), "base", "tool"};
    const std::vector<Load> loads = read_urdf_loads(source);
    ASSERT_EQ(loads.size(), 3U);
    EXPECT_EQ(loads[0].link, 0);
    EXPECT_EQ(loads[1].link, 1);
    EXPECT_EQ(loads[2].link, 1);  // the plate is welded to the arm
    EXPECT_EQ(loads[2].mass, 2);

    // In the base frame, by the format's own definition.
    const double q = 0.7;
    Isometry3d origin = Isometry3d::Identity();
    origin.translation().z() = 0.5;
    origin.linear() = rotation_from_rpy(Vector3d(0.3, 0, 0));
    const Isometry3d arm = origin * Eigen::AngleAxisd(q, Vector3d(0.6, 0.8, 0));
    Isometry3d weld = Isometry3d::Identity();
    weld.translation().x() = 0.4;
    weld.linear() = rotation_from_rpy(Vector3d(0, 0.5, 0));
    const Chain robot = make_chain(read_urdf(source));
    const auto links = robot.base_from_links(Eigen::Vector2d(q, 0.1), VectorXd());
    EXPECT_TRUE((links[1] * loads[1].center).isApprox(arm * Vector3d(0.1, 0.2, 0.3), 1e-14));
    EXPECT_TRUE((links[1] * loads[2].center).isApprox(arm * weld * Vector3d(0, 0, 0.05), 1e-14));
}

TEST(UrdfLoads, AreTakenByACampaignThatAsksForThem) {
    const TemporaryFolder folder;
    folder.write("arm.urdf", urdf);
    const std::string sensor =
        "name: arm\nsensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n";
    const Chain robot =
        read_campaign(folder.write("c.yaml", sensor + "robot: {urdf: arm.urdf, base_link: base, "
                                                      "tip_link: tool, errors: stated, "
                                                      "compliance: {links: urdf}}\n"))
            .robot;
    ASSERT_EQ(compliances(robot).size(), 1U);
    EXPECT_EQ(robot.parameter_names(), std::vector<std::string>{"turn.compliance"});
}

TEST(UrdfLoads, SayWhatIsWrongWithThem) {
    const TemporaryFolder folder;
    const auto error = [&](const std::string& text) {
        const UrdfSource source{folder.write("arm.urdf", text), "base", "tool"};
        return input_error_of([&] { read_urdf_loads(source); });
    };
    const std::vector<Slip> slips{
        {"<mass value=\"4\"/>", "", "20: link 'arm' has an <inertial> with[...]"},
        {"\"4\"", "\"-4\"", "69: link 'arm' has a negative mass[...]"},
        {"\"4\"", "\"4 kg\"",
         "69: link 'arm' has mass value '4 kg'; must be a number of at most 1e+06 in magnitude"},
        {"0.1 0.2 0.3", "0.1 0.2", "30: link 'arm' has origin xyz '0.1 0.2'; mus[...]"},
    };
    expect_messages(urdf, slips, error, "arm.urdf:3:");
    const UrdfSource source{folder.write("arm.urdf", urdf), "plate", "tool"};
    EXPECT_EQ(read_urdf_loads(source).size(), 1U);
    const std::string bare =
        replaced(urdf, "<inertial><origin xyz=\"0 0 0.05\"/><mass value=\"2\"/></inertial>", "");
    const UrdfSource massless{folder.write("arm.urdf", bare), "plate", "tool"};
    EXPECT_EQ(input_error_of([&] { read_urdf_loads(massless); }),
              "arm.urdf: states no mass of a link from 'plate' to 'tool'");
}

}  // namespace
}  // namespace posewise::io
