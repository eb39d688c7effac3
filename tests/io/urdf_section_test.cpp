#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/robots.hpp"
#include "support/slips.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"
#include "support/urdf_text.hpp"

// The same robots as URDF and as DH table, and what can be identified of each.

namespace posewise::io {
namespace {

using namespace detail;
using namespace testing;

const std::string sensor_text = "sensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n";
const std::string quarter = "1.5707963267948966";

struct RobotText {
    std::string name;
    std::vector<JointText> joints;
    std::string convention;
    /// joint, a, alpha in degrees, d, theta in degrees; a joint is "q1", "p1" (it slides) or "".
    struct Row {
        std::string joint;
        double a, alpha, d, theta;
    };
    std::vector<Row> rows;
    Index revolute = 0;
    Index prismatic = 0;
};

JointText turns(const std::string& axis, const std::string& xyz = "0 0 0",
                const std::string& rpy = "0 0 0") {
    return {"revolute", "xyz=\"" + xyz + "\" rpy=\"" + rpy + '"', axis};
}

JointText slides(const std::string& axis) { return {"prismatic", "", axis}; }

JointText fixed(const std::string& xyz) { return {"fixed", "xyz=\"" + xyz + '"', ""}; }

/// All frames parallel to the base's at zero, as many URDFs have it.
std::vector<JointText> spherical_wrist_joints() {
    return {turns("0 0 1"),
            turns("0 1 0"),
            turns("0 1 0", "0.4318 0.15 0"),
            turns("0 0 -1", "0.0203 0 0"),
            turns("0 1 0", "0 0 -0.4318"),
            turns("0 0 -1"),
            fixed("0 0 -0.06")};
}

const std::vector<RobotText::Row> spherical_wrist_rows{
    {"q1", 0, -90, 0, 0},     {"q2", 0.4318, 0, 0.15, 0}, {"q3", 0.0203, -90, 0, 0},
    {"q4", 0, 90, 0.4318, 0}, {"q5", 0, -90, 0, 0},       {"q6", 0, 0, 0.06, 0}};

RobotText rail() {
    RobotText robot{
        "rail with 6R", spherical_wrist_joints(), "standard", {{"q1", 0, -90, 0, 0}}, 6, 1};
    robot.joints[0].origin = "rpy=\"-" + quarter + " 0 0\"";
    robot.joints.insert(robot.joints.begin(), slides("0 0 1"));
    robot.rows[0].joint = "p1";
    for (std::size_t k = 0; k < 6; ++k) {
        robot.rows.push_back(spherical_wrist_rows[k]);
        robot.rows.back().joint = "q" + std::to_string(k + 2);
    }
    return robot;
}

std::vector<RobotText> robots() {
    const std::string pi_2 = quarter;
    return {
        {"planar 3R",
         {turns("0 0 1"), turns("0 0 1", "0.4 0 0"), turns("0 0 1", "0.3 0 0"), fixed("0.2 0 0")},
         "standard",
         {{"q1", 0.4, 0, 0, 0}, {"q2", 0.3, 0, 0, 0}, {"q3", 0.2, 0, 0, 0}},
         3,
         0},
        {"SCARA",
         {turns("0 0 1", "0 0 0.3"),
          turns("0 0 1", "0.4 0 0"),
          {"prismatic", "xyz=\"0.35 0 0\"", "0 0 -1"},
          turns("0 0 -1")},
         "standard",
         {{"q1", 0.4, 0, 0.3, 0}, {"q2", 0.35, 180, 0, 0}, {"p3", 0, 0, 0, 0}, {"q4", 0, 0, 0, 0}},
         3,
         1},
        {"PPP + RRR",
         {slides("0 0 1"), slides("0 1 0"), slides("1 0 0"), turns("1 0 0"), turns("0 1 0"),
          turns("1 0 0"), fixed("0.1 0 0")},
         "standard",
         {{"p1", 0, -90, 0, 0},
          {"p2", 0, -90, 0, -90},
          {"p3", 0, 0, 0, 0},
          {"q4", 0, 90, 0, 0},
          {"q5", 0, -90, 0, 0},
          {"q6", 0, 0, 0.1, 0}},
         3,
         3},
        {"6R with spherical wrist", spherical_wrist_joints(), "standard", spherical_wrist_rows, 6,
         0},
        {"UR type",
         {turns("0 0 1"),
          turns("0 0 1", "0 0 0.1273", pi_2 + " 0 0"),
          turns("0 0 1", "-0.612 0 0"),
          turns("0 0 1", "-0.5723 0 0"),
          turns("0 0 1", "0 0 0.163941", pi_2 + " 0 0"),
          // The last two in frames that are turned, with axes that make up for it.
          turns("-0.6 0.8 0", "0 0 0.1157", "-" + pi_2 + " 0 0"),
          {"fixed", "xyz=\"0 0 0\" rpy=\"0.3 0.2 0.1\"", ""}},
         "",
         {},
         6,
         0},
        {"7R",
         {turns("0 0 1", "0 0 0.333"), turns("0 0 1", "0 0 0", "-" + pi_2 + " 0 0"),
          turns("0 0 1", "0 -0.316 0", pi_2 + " 0 0"), turns("0 0 1", "0.0825 0 0", pi_2 + " 0 0"),
          turns("0 0 1", "-0.0825 0.384 0", "-" + pi_2 + " 0 0"),
          turns("0 0 1", "0 0 0", pi_2 + " 0 0"), turns("0 0 1", "0.088 0 0", pi_2 + " 0 0"),
          fixed("0 0 0.107")},
         "modified",
         {{"q1", 0, 0, 0.333, 0},
          {"q2", 0, -90, 0, 0},
          {"q3", 0, 90, 0.316, 0},
          {"q4", 0.0825, 90, 0, 0},
          {"q5", -0.0825, -90, 0.384, 0},
          {"q6", 0, 90, 0, 0},
          {"q7", 0.088, 90, 0, 0},
          {"", 0, 0, 0.107, 0}},
         7,
         0},
        rail()};
}

std::string dh_text(const RobotText& robot) {
    std::string text =
        "name: table\nrobot:\n  errors: geometric\n  dh:\n    convention: " + robot.convention +
        "\n    rows:\n";
    for (const auto& row : robot.rows) {
        const bool slides = row.joint.starts_with('p');
        std::string name = row.joint;
        if (slides) name[0] = 'q';
        text += "      - {a_m: " + std::to_string(row.a) +
                ", alpha_deg: " + std::to_string(row.alpha) + ", d_m: " + std::to_string(row.d) +
                ", theta_deg: " + std::to_string(row.theta);
        if (!name.empty()) {
            text += ", joint: " + name + (slides ? ", kind: prismatic, limits_m" : ", limits_rad") +
                    ": [-2, 2]";
        }
        text += "}\n";
    }
    return text + sensor_text;
}

CampaignFile read_text(const std::string& campaign, const std::string& urdf = "") {
    const TemporaryFolder folder;
    folder.write("robot.urdf", urdf);
    return read_campaign(folder.write("campaign.yaml", campaign));
}

std::string campaign_of_urdf(const std::string& tip, const std::string& more = "") {
    return "name: urdf\nrobot:\n  urdf: robot.urdf\n  base_link: link0\n  tip_link: " + tip + '\n' +
           more + "  errors: geometric\n" + sensor_text;
}

CampaignFile read_robot_as_urdf(const std::vector<JointText>& joints) {
    return read_text(campaign_of_urdf("link" + std::to_string(joints.size())), urdf_text(joints));
}

/// How the flange moves from where it is at zero: the same whatever its frame.
Isometry3d motion_from_zero(const Chain& chain, const VectorXd& q) {
    const VectorXd none;
    return chain.base_from_flange(q, none) *
           chain.base_from_flange(VectorXd::Zero(q.size()), none).inverse();
}

/// The complete model has that many identifiable parameters, the reduced one spans them all, and
/// each error parameter of the robot is one of them. (Base and targets may be one too many: the
/// height of base and targets of a SCARA is one unknown.)
void expect_identifiable(const CampaignFile& file, Index count, const std::string& name) {
    const Campaign complete = with_robot(file, complete_model(file.declared_robot));
    EXPECT_EQ(static_cast<Index>(find_identifiable(complete).kept.size()), count) << name;
    const Identifiability reduced = find_identifiable(file);
    EXPECT_EQ(static_cast<Index>(reduced.kept.size()), count) << name << ", reduced";
    for (const DroppedParameter& dropped : reduced.dropped) {
        EXPECT_GE(dropped.parameter, 6 + file.robot.parameter_count()) << name;
    }
}

TEST(UrdfAndDh, AreTheSameRobots) {
    for (const RobotText& robot : robots()) {
        if (robot.rows.empty()) continue;
        const Chain urdf = read_robot_as_urdf(robot.joints).declared_robot;
        const Chain dh = read_text(dh_text(robot)).declared_robot;
        ASSERT_EQ(urdf.joint_count(), dh.joint_count()) << robot.name;
        RandomStream stream(3);
        for (int i = 0; i < 10; ++i) {
            const VectorXd q = random_vector(stream, urdf.joint_count(), 2);
            const Isometry3d difference =
                motion_from_zero(urdf, q).inverse() * motion_from_zero(dh, q);
            EXPECT_LT((difference.matrix() - Isometry3d::Identity().matrix()).norm(), 1e-12)
                << robot.name;
        }
    }
}

TEST(UrdfAndDh, HaveAsManyIdentifiableParametersAsTheFormulaSays) {
    for (const RobotText& robot : robots()) {
        const Index formula = 4 * robot.revolute + 2 * robot.prismatic + 3 * 3;
        expect_identifiable(read_robot_as_urdf(robot.joints), formula, robot.name);
        if (robot.rows.empty()) continue;
        expect_identifiable(read_text(dh_text(robot)), formula, robot.name + " as DH table");
    }
}

TEST(UrdfSection, OverridesLimitsAndAddsRepeatability) {
    const std::string urdf = urdf_text({turns("0 0 1"), slides("0 1 0"), turns("1 0 0")});
    const CampaignFile file =
        read_text(campaign_of_urdf("link3",
                                   "  joints:\n    q2: {limits_mm: [0, 300]}\n"
                                   "    q3: {repeatability_mrad: 0.02}\n"),
                  urdf);
    EXPECT_EQ(file.declared_robot.joints()[0].upper, 2);
    EXPECT_EQ(file.declared_robot.joints()[1].upper, 0.3);
    EXPECT_EQ(file.declared_robot.joints()[2].upper, 2);
    EXPECT_NEAR(file.joint_repeatability[2], 2e-5, 1e-18);
    EXPECT_EQ(file.error_model, ErrorModel::Complete);
    ASSERT_TRUE(file.urdf);
    EXPECT_EQ(file.urdf->tip_link, "link3");
}

TEST(UrdfSection, SetsLimitsTheUrdfLacks) {
    const std::string urdf = urdf_text({{"revolute", "", "0 0 1", "effort=\"1\" velocity=\"1\""}});
    EXPECT_EQ(
        input_error_of([&] { read_text(campaign_of_urdf("link1"), urdf); }),
        "robot.urdf:5:3: joint 'q1' has no limits that leave it room; must have, here or in a "
        "campaign under robot.joints");
    const auto file =
        read_text(campaign_of_urdf("link1", "  joints: {q1: {limits_rad: [-1, 1]}}\n"), urdf);
    EXPECT_EQ(file.declared_robot.joints()[0].lower, -1);
}

TEST(UrdfSection, TakesSpeedsUnlessTheCellStatesThem) {
    const std::string urdf = urdf_text({turns("0 0 1"), turns("1 0 0")});
    EXPECT_EQ(read_text(campaign_of_urdf("link2"), urdf).cell.speed, Eigen::Vector2d(3, 3));
    const std::string cell = "cell: {speed_rad_per_s: [1, 2]}\n";
    EXPECT_EQ(read_text(campaign_of_urdf("link2") + cell, urdf).cell.speed, Eigen::Vector2d(1, 2));
}

TEST(UrdfSection, TakesThePitchOfASlideFromTheCampaign) {
    const std::string urdf = urdf_text({slides("0 0 1"), turns("0 1 0", "0.2 0 0")});
    const auto read_with = [&](const std::string& joints) {
        return read_text(campaign_of_urdf("link2", "  joints: {" + joints + "}\n"), urdf);
    };
    const Chain robot = read_with("q1: {pitch_mm: 20}").declared_robot;
    EXPECT_DOUBLE_EQ(robot.joint(0).pitch, 0.02);
    EXPECT_EQ(with_harmonics(robot, {1}, {0}).parameter_count(), 2);
    EXPECT_NE(input_error_of([&] {
                  read_with("q2: {pitch_mm: 20}");
              }).find("robot.joints.q2.pitch_mm is stated, but the joint turns"),
              std::string::npos);
}

TEST(UrdfSection, FindsTheFileFromTheCampaignsFolder) {
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path("cells/a"));
    std::filesystem::create_directories(folder.path("robots"));
    folder.write("robots/robot.urdf", urdf_text({turns("0 0 1")}));
    const std::string campaign =
        replaced(campaign_of_urdf("link1"), "robot.urdf", "../../robots/robot.urdf");
    EXPECT_EQ(
        read_campaign(folder.write("cells/a/campaign.yaml", campaign)).declared_robot.joint_count(),
        1);
}

TEST(BadUrdfSection, GivesOneLine) {
    const std::string urdf = urdf_text({turns("0 0 1"), turns("1 0 0")});
    const std::vector<Slip> slips{
        {"urdf: robot.urdf", "urdf: none.urdf",
         "none.urdf: cannot be read: No such file or directory"},
        {"urdf: robot.urdf", "urdf: ''",
         "campaign.yaml:3:9: robot.urdf is empty; must be the path of a URDF file"},
        {"tip_link: link2", "tip_link: ''",
         "campaign.yaml:5:13: robot.tip_link is empty; must be the name of a link"},
        {"tip_link: link2", "tip_link: lnk2",
         "robot.urdf: has no link 'lnk2'; did you mean 'link2'?"},
        {"{q1:", "{q3:",
         "campaign.yaml:6:12: 'q3' is no moving joint of the URDF; did you mean 'q1'?"},
        {"limits_deg", "limits_mm",
         "campaign.yaml:6:28: robot.joints.q1.limits_mm is in 'mm', but the joint drives a "
         "rotation; must be in deg, rad, mrad or urad"},
        {"  base_link", "  dh: {}\n  base_link",
         "campaign.yaml:3:9: robot.urdf is stated beside robot.dh; must be one of them"},
        {"urdf: robot.urdf", "elements: [Rz q1]",
         "campaign.yaml:4:14: robot.base_link is stated beside robot.elements; only a URDF has "
         "links"},
    };
    expect_messages(campaign_of_urdf("link2", "  joints: {q1: {limits_deg: [0, 9]}}\n"), slips,
                    [&](const std::string& campaign) {
                        return input_error_of([&] { read_text(campaign, urdf); });
                    });
}

/// A random axis in the frame of an origin; a third of the time exactly parallel to the last one, a
/// third exactly perpendicular.
Vector3d next_axis(RandomStream& stream, const Vector3d& last) {
    const Vector3d any = random_vector(stream, 3, 1).normalized();
    const double kind = stream.uniform(0, 3);
    if (kind < 1) return last;
    if (kind < 2) return last.cross(any).normalized();
    return any;
}

TEST(RandomUrdfs, HaveAsManyIdentifiableParametersAsTheFormulaSays) {
    RandomStream stream(11);
    for (Index i = 0; i < sweep_count() / 10; ++i) {
        std::vector<JointText> joints;
        Vector3d last = random_vector(stream, 3, 1).normalized();
        Index revolute = 0;
        for (Index j = 0; j < 6; ++j) {
            const Vector3d rpy = random_vector(stream, 3, 3);
            last = rotation_from_rpy(rpy).transpose() * next_axis(stream, last);
            // Two sliding joints along one line cannot be told apart; at most one slides here.
            const bool is_prismatic = i % 3 == 0 && j == i % 6;
            revolute += is_prismatic ? 0 : 1;
            joints.push_back({is_prismatic ? "prismatic" : "revolute",
                              "xyz=\"" + vector_text(random_vector(stream, 3, 1)) + "\" rpy=\"" +
                                  vector_text(rpy) + '"',
                              vector_text(last)});
        }
        expect_identifiable(read_robot_as_urdf(joints), 4 * revolute + 2 * (6 - revolute) + 9,
                            "robot " + std::to_string(i));
    }
}

}  // namespace
}  // namespace posewise::io
