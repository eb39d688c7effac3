#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/jacobian/identification.hpp"
#include "support/campaign_from.hpp"
#include "support/robots.hpp"
#include "support/slips.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::campaign_from;
using testing::degree;
using testing::input_error_of;
using testing::TemporaryFolder;

const std::string rows_of_a_rail =
    R"(    - {joint: rail, kind: prismatic, a_mm: 0, alpha_deg: -90, d_mm: 50, theta_deg: 0, limits_mm: [0, 900]}
    - {joint: q1, a_mm: 300, alpha_deg: 0, d_mm: 0, theta_deg: 30, limits_deg: [-90, 90], repeatability_mrad: 0.1}
    - joint: q2
      drive: -q2 + 0.5*q1
      a_mm: 200
      alpha_deg: 90
      d_mm: 0
      theta_deg: 0
      limits_rad: [-1, 1]
    - {a_mm: 0, alpha_deg: 0, d_mm: 100, theta_deg: 0}
)";

std::string campaign_of(const std::string& rows, const std::string& convention = "standard") {
    return "name: table\nrobot:\n  dh:\n    convention: " + convention + "\n    rows:\n" + rows +
           "  errors: geometric\nsensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n";
}

TEST(DhSection, IsReadWithOffsetsSignsCouplingsAndFixedRows) {
    const CampaignFile file = campaign_from(campaign_of(rows_of_a_rail));
    const Chain& robot = file.declared_robot;
    ASSERT_EQ(robot.joint_count(), 3);
    EXPECT_EQ(robot.joints()[0].name, "rail");
    EXPECT_DOUBLE_EQ(robot.joints()[0].upper, 0.9);
    EXPECT_DOUBLE_EQ(robot.joints()[1].lower, -90 * degree);
    EXPECT_EQ(robot.joint(0).motion, Motion::Translation);
    EXPECT_NEAR(file.joint_repeatability[1], 1e-4, 1e-18);
    EXPECT_EQ(file.error_model, ErrorModel::Complete);

    using Eigen::AngleAxisd;
    using Eigen::Translation3d;
    const Vector3d X = Vector3d::UnitX(), Z = Vector3d::UnitZ();
    const Vector3d q(0.4, 0.7, -0.2);
    const Isometry3d expected = Translation3d(0, 0, 0.05 + q[0]) * AngleAxisd(-90 * degree, X) *
                                AngleAxisd(30 * degree + q[1], Z) * Translation3d(0.3, 0, 0) *
                                AngleAxisd(-q[2] + 0.5 * q[1], Z) * Translation3d(0.2, 0, 0) *
                                AngleAxisd(90 * degree, X) * Translation3d(0, 0, 0.1);
    EXPECT_TRUE(robot.base_from_flange(q, VectorXd()).isApprox(expected, 1e-14));
}

TEST(DhSection, KeepsThePitchOfASlide) {
    const std::string rows = testing::replaced(rows_of_a_rail, "limits_mm: [0, 900]",
                                               "limits_mm: [0, 900], pitch_mm: 20");
    const Chain robot = campaign_from(campaign_of(rows)).declared_robot;
    EXPECT_DOUBLE_EQ(robot.joint(0).pitch, 0.02);
    const Chain full = full_model(robot);
    const VectorXd errors = VectorXd::Zero(full.parameter_count());
    const Chain exported = without_terms(full);
    const std::string text =
        make_dh_text(exported, dh_rows(exported, VectorXd::Zero(exported.parameter_count())));
    EXPECT_NE(text.find("kind: prismatic, pitch_mm: 20"), std::string::npos) << text;
    const std::string sensor = "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n";
    const Chain again = campaign_from("name: again\n" + text + sensor).declared_robot;
    EXPECT_DOUBLE_EQ(again.joint(0).pitch, 0.02);
    EXPECT_LT(compare_flanges(full, errors, again, VectorXd()).position, 1e-12);
}

/// The first three rows of the PUMA 560 in both conventions [Craig 1986, fig. 3.21].
TEST(DhSection, ConventionsAgreeOnOneRobot) {
    const std::string limits = ", limits_deg: [-100, 100]}\n";
    const Chain standard =
        campaign_from(
            campaign_of(
                "    - {joint: q1, a_m: 0, alpha_deg: -90, d_m: 0, theta_deg: 0" + limits +
                "    - {joint: q2, a_m: 0.4318, alpha_deg: 0, d_m: 0.2435, theta_deg: 0" + limits +
                "    - {joint: q3, a_m: -0.0203, alpha_deg: 90, d_m: -0.0934, theta_deg: 0" +
                limits))
            .declared_robot;
    const Chain modified =
        campaign_from(
            campaign_of(
                "    - {joint: q1, a_m: 0, alpha_deg: 0, d_m: 0, theta_deg: 0" + limits +
                    "    - {joint: q2, a_m: 0, alpha_deg: -90, d_m: 0.2435, theta_deg: 0" + limits +
                    "    - {joint: q3, a_m: 0.4318, alpha_deg: 0, d_m: -0.0934, theta_deg: 0" +
                    limits + "    - {a_m: -0.0203, alpha_deg: 90, d_m: 0, theta_deg: 0}\n",
                "modified"))
            .declared_robot;
    for (const Vector3d& q : {Vector3d(0, 0, 0), Vector3d(0.5, -1.2, 0.9)}) {
        EXPECT_TRUE(standard.base_from_flange(q, VectorXd())
                        .isApprox(modified.base_from_flange(q, VectorXd()), 1e-14));
    }
}

TEST(DhSection, MayTurnAboutYOfTheStandardConvention) {
    const std::string rows =
        "    - {joint: q1, a_mm: 300, alpha_deg: 0, d_mm: 0, theta_deg: 0, beta_deg: 30, "
        "limits_deg: [-90, 90]}\n";
    const Chain robot = campaign_from(campaign_of(rows)).declared_robot;
    const Isometry3d expected =
        Eigen::Translation3d(0.3, 0, 0) * Eigen::AngleAxisd(30 * degree, Vector3d::UnitY());
    EXPECT_TRUE(robot.base_from_flange(VectorXd::Zero(1), VectorXd()).isApprox(expected, 1e-14));
    EXPECT_EQ(input_error_of([&] { campaign_from(campaign_of(rows, "modified")); }),
              "campaign.yaml:6:77: robot.dh.rows[1].beta_deg is stated in a table of the modified "
              "convention; only the standard one has it");
    const std::string other = testing::replaced(rows, "beta_deg: 30", "beta_rad: 0.5");
    EXPECT_NE(input_error_of([&] { campaign_from(campaign_of(other)); }).find("must be one unit"),
              std::string::npos);
}

TEST(DhSection, TellsWhatIsWrongAndWhere) {
    const std::string number = ", which is not a number; must be a finite number without unit";
    const std::string like = " is no sum of joints; must be like '-q3 + 0.5*q2'";
    const std::string fixed = "{a_mm: 0, alpha_deg: 0, d_mm: 100";
    const std::string unit = ", but others of the table are in ";
    const std::vector<testing::Slip> slips{
        {"a_mm: 300, ", "",
         "7:7: robot.dh.rows[2] has no key a_mm, a_m or a_um; it must be stated"},
        {"alpha_deg: 0, d_mm: 100", "alpha_deg: , d_mm: 100",
         "15:17: robot.dh.rows[4].alpha_deg has no value; must be a number"},
        {", limits_deg: [-90, 90]", "",
         "7:7: robot.dh.rows[2] has no key limits_deg, limits_rad, limits_mrad, limits_urad, "
         "limits_mm, limits_m or limits_um; it must be stated"},
        {"a_mm: 300", "a_m: 0.3",
         "7:24: robot.dh.rows[2].a_m is in 'm'" + unit + "'mm'; must be one unit"},
        {"a_mm: 300", "a_mm: 300, a_m: 0.3", "7:30: 'a' is stated in two units; keep one"},
        {"theta_deg: 30", "theta_rad: 0.5",
         "7:64: robot.dh.rows[2].theta_rad is in 'rad'" + unit + "'deg'; must be one unit"},
        {"a_mm: 300", "a_mn: 300",
         "7:19: unknown key 'a_mn' in robot.dh.rows[2]; did you mean 'a_mm'?"},
        {"convention: standard", "convention: craig",
         "4:17: robot.dh.convention is 'craig'; must be standard or modified"},
        {"kind: prismatic", "kind: slide",
         "6:27: robot.dh.rows[1].kind is 'slide'; must be revolute or prismatic"},
        {"a_mm: 300", "a_mm: .nan", "7:25: robot.dh.rows[2].a_mm is '.nan'" + number},
        {"a_mm: 300", "a_mm: 300 mm", "7:25: robot.dh.rows[2].a_mm is '300 mm'" + number},
        {"kind: prismatic, ", "",
         "6:81: robot.dh.rows[1].limits_mm is in 'mm', but the joint drives a rotation; must be in "
         "deg, rad, mrad or urad"},
        {"joint: q1", "joint: rail",
         "7:15: robot.dh.rows[2].joint is 'rail' as in a row before; must be another"},
        {"joint: q1", "joint: mm",
         "7:15: 'mm' cannot name a joint; must be letters, digits and underscores, not a unit"},
        {fixed, "{kind: prismatic, a_mm: 0, alpha_deg: 0, d_mm: 100",
         "15:14: robot.dh.rows[4].kind is stated, but its row has no joint"},
        {fixed, "{limits_mm: [0, 1], a_mm: 0, alpha_deg: 0, d_mm: 100",
         "15:19: robot.dh.rows[4].limits_mm is stated, but its row has no joint"},
        {"-q2 + 0.5*q1", "-q2 + 0.5*rail",
         "9:24: Rz is a rotation but joint 'rail' drives the other kind before; must drive one "
         "kind, since its unit is either rad or m"},
        {"-q2 + 0.5*q1", "0.5*q1",
         "9:14: robot.dh.rows[3].drive is '0.5*q1'; must contain 'q2', the joint of its row"},
        {"-q2 + 0.5*q1", "q2 + 5 deg", "9:14: 'q2 + 5 deg'" + like},
        {"-q2 + 0.5*q1", "q2 q1", "9:14: 'q2 q1'" + like},
        {"  dh:", "  elements: []\n  dh:",
         "5:5: robot.dh is stated beside robot.elements; must be one of them"},
        {"  dh:", "  joints: {}\n  dh:",
         "3:11: robot.joints is stated beside robot.dh; limits must stand in the rows of the "
         "table"},
        {rows_of_a_rail, "    []\n", "6:5: robot.dh.rows names no joint; a row must be of a joint"},
        {"  dh:\n    convention: standard\n    rows:\n" + rows_of_a_rail, "",
         "3:3: robot has no key elements, dh or urdf; one of them must be stated"},
    };
    const auto error = [](const std::string& text) {
        return input_error_of([&] { campaign_from(text); });
    };
    testing::expect_messages(campaign_of(rows_of_a_rail), slips, error, "campaign.yaml:");
}

TEST(MakeDhText, IsReadBackAsTheSameRobot) {
    for (const Chain& chain : {testing::fanuc(), testing::scara(), testing::gantry_with_wrist(),
                               campaign_from(campaign_of(rows_of_a_rail)).robot}) {
        const Chain complete = complete_model(chain);
        RandomStream stream(9);
        const VectorXd errors = testing::random_vector(stream, complete.parameter_count(), 1e-2);
        const std::string text = make_dh_text(complete, dh_rows(complete, errors));
        const Chain back =
            campaign_from("name: back\n" + text +
                          "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n")
                .declared_robot;
        ASSERT_EQ(back.joint_count(), chain.joint_count());
        for (Index j = 0; j < chain.joint_count(); ++j) {
            const auto k = static_cast<std::size_t>(j);
            EXPECT_EQ(back.joints()[k].name, chain.joints()[k].name);
            EXPECT_NEAR(back.joints()[k].lower, chain.joints()[k].lower, 1e-12);
        }
        for (int i = 0; i < 10; ++i) {
            const VectorXd q = testing::random_vector(stream, chain.joint_count(), 1);
            EXPECT_LT((back.base_from_flange(q, VectorXd::Zero(back.parameter_count())).matrix() -
                       complete.base_from_flange(q, errors).matrix())
                          .norm(),
                      1e-10);
        }
    }
}

TEST(MakeDhText, PrintsTheShortestNumbersThatAreReadBackExactly) {
    const Chain chain =
        campaign_from(campaign_of("      - {joint: q1, a_mm: 312.1, alpha_deg: 0, d_mm: 0, "
                                  "theta_deg: 0, limits_deg: [-150, 75.3]}\n"))
            .declared_robot;
    const std::string text = make_dh_text(chain, dh_rows(chain, {}));
    EXPECT_NE(text.find("limits_deg: [-150, 75.3]"), std::string::npos) << text;
    EXPECT_NE(text.find("a_mm: 312.1,"), std::string::npos) << text;
}

TEST(MakeDhText, RefusesAJointThatDrivesTwoAxes) {
    using testing::driven;
    const Chain chain({{"q1", -1, 1}},
                      {driven(Motion::Rotation, Axis::Z, 0), testing::translation(Axis::X, 0.3),
                       driven(Motion::Rotation, Axis::Z, 0, "", -0.5)});
    EXPECT_NE(input_error_of([&] {
                  make_dh_text(chain, dh_rows(chain, {}));
              }).find("'q1' drives more than one axis"),
              std::string::npos);
}

}  // namespace
}  // namespace posewise::io
