#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "lift_urdf.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/model/chain.hpp"
#include "support/sweep.hpp"
#include "support/urdf_text.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using namespace testing;

TEST(ReadUrdf, GivesTheJointsFromBaseToTip) {
    const UrdfRobot robot = read(lift_urdf);
    EXPECT_EQ(robot.name, "lift & arm");
    ASSERT_EQ(robot.joints.size(), 4U);
    EXPECT_EQ(robot.joints[0].name, "lift");
    EXPECT_EQ(robot.joints[0].kind, UrdfJointKind::Prismatic);
    EXPECT_EQ(robot.joints[0].axis, Vector3d::UnitZ());
    EXPECT_EQ(robot.joints[1].kind, UrdfJointKind::Fixed);
    EXPECT_EQ(robot.joints[1].rpy, Vector3d(0.1, -0.2, 1.5));
    EXPECT_EQ(robot.joints[3].axis, Vector3d::UnitX()) << "the format's default";
    EXPECT_EQ(joint_speeds(robot).size(), 0) << "the wrist has none";
}

TEST(ReadUrdf, TakesLimitsAndNames) {
    const Chain chain = make_chain(read(lift_urdf));
    ASSERT_EQ(chain.joint_count(), 3);
    EXPECT_EQ(chain.joints()[1].name, "arm_joint");
    EXPECT_EQ(chain.joints()[1].lower, -1.5);
    EXPECT_EQ(chain.joints()[1].upper, 2);
    EXPECT_EQ(chain.joints()[2].upper, std::numbers::pi);
    EXPECT_EQ(chain.joint(0).motion, Motion::Translation);
    const std::string faster =
        replaced(lift_urdf, "<origin xyz=\"0.4 0 0\"/>", "<limit velocity='4'/>");
    EXPECT_EQ(joint_speeds(read(faster)), Vector3d(0.5, 1.5, 4));
}

TEST(ReadUrdf, FindsRootAndOnlyLeafByItself) {
    const UrdfRobot robot = read(urdf_text({{"revolute", "", ""}, {"fixed", "", ""}}), "", "");
    EXPECT_EQ(robot.source.base_link, "link0");
    EXPECT_EQ(robot.source.tip_link, "link2");
}

TEST(ReadUrdf, FoldsFixedJoints) {
    const Vector3d q(0.3, 0.8, -1.1);
    using Eigen::AngleAxisd;
    using Eigen::Translation3d;
    const Isometry3d expected =
        Translation3d(0.1, 0, 0.5) * Translation3d(0, 0, q[0]) * Translation3d(0, 0.2, 0) *
        Isometry3d(rotation_from_rpy({0.1, -0.2, 1.5})) * Translation3d(0, 0, 0.3) *
        AngleAxisd(0.4, Vector3d::UnitX()) * AngleAxisd(q[1], -Vector3d::UnitY()) *
        Translation3d(0.4, 0, 0) * AngleAxisd(q[2], Vector3d::UnitX());
    EXPECT_TRUE(
        make_chain(read(lift_urdf)).base_from_flange(q, VectorXd()).isApprox(expected, 1e-14));
}

TEST(ReadUrdf, ForwardKinematicsOfRandomAxesAgree) {
    RandomStream stream(8);
    for (Index i = 0; i < sweep_count() / 10; ++i) {
        std::vector<JointText> joints;
        Isometry3d expected = Isometry3d::Identity();
        const VectorXd q = random_vector(stream, 7, 2);
        for (Index j = 0; j < 7; ++j) {
            const Vector3d xyz = random_vector(stream, 3, 1);
            const Vector3d rpy = random_vector(stream, 3, 1.5);
            const Vector3d axis = random_vector(stream, 3, 1);
            const bool slides = stream.uniform(0, 1) < 0.3;
            joints.push_back({slides ? "prismatic" : "revolute",
                              "xyz=\"" + vector_text(xyz) + "\" rpy=\"" + vector_text(rpy) + '"',
                              vector_text(axis)});
            expected = expected * Eigen::Translation3d(xyz) * Isometry3d(rotation_from_rpy(rpy));
            if (slides) {
                expected = expected * Eigen::Translation3d(q[j] * axis.normalized());
            } else {
                expected = expected * Eigen::AngleAxisd(q[j], axis.normalized());
            }
        }
        const Chain chain = make_chain(read(urdf_text(joints), "link0", "link7"));
        const Isometry3d pose = chain.base_from_flange(q, VectorXd());
        EXPECT_LT((pose.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    }
}

TEST(BadUrdf, Joints) {
    const std::string many =
        ", which moves in several ways at once; must be one of revolute, "
        "continuous, prismatic or fixed, or not between base and tip link";
    const std::string numbers = "; must be three numbers, each at most 1e+06 in magnitude";
    std::vector<Slip> slips{
        {"\"continuous\"", "\"floating\"", "26:3: joint 'wrist' is of type 'floating'" + many},
        {"\"continuous\"", "\"planar\"", "26:3: joint 'wrist' is of type 'planar'" + many},
        {"\"continuous\"", "\"continous\"",
         "26:3: joint 'wrist' is of type 'continous'; did you mean 'continuous'?"},
        {" type=\"continuous\"", "", "26:3: joint 'wrist' has no type; it must be stated"},
        {"0 -1 0", "0 0 0",
         "23:5: joint 'arm-joint' has the axis '0 0 0', which has no direction; must not be zero"},
        {"<origin xyz=\"0.4 0 0\"/>", "<orign xyz=\"0.4 0 0\"/>",
         "28:5: joint 'wrist' has an element 'orign'; did you mean 'origin'?"},
        {"<axis xyz=\"0 -1 0\"/>", "<axis xyz=\"0 -1 0\"/><axis xyz=\"0 1 0\"/>",
         "23:25: a second <axis> in one <joint>; must be one"},
        {"rpy=\"0.4 0 0\"", "rpy=\"${pi/2} 0 0\"",
         "22:5: joint 'arm-joint' has origin rpy '${pi/2} 0 0'" + numbers},
        {"rpy=\"0.4 0 0\"", "rpy_deg=\"0.4 0 0\"",
         "22:5: joint 'arm-joint' has origin with unknown attribute 'rpy_deg'; must be xyz or rpy"},
    };
    for (const std::string bad : {"0 -1", "0 -1 0 0", "0 nan 0", "0 inf 0", "0 1e400 0", "0 1e9 0",
                                  "0 -1 0x", "0, -1, 0", ""}) {
        slips.push_back(
            {"0 -1 0", bad, "23:5: joint 'arm-joint' has axis xyz '" + bad + "'" + numbers});
    }
    expect_messages_of(slips);
}

TEST(BadUrdf, Limits) {
    const std::string none =
        "20:3: joint 'arm-joint' has no limits that leave it room; must have, here or in a "
        "campaign under robot.joints";
    const std::string limit = "<limit lower=\"-1.5\" upper=\"2\" effort=\"10\" velocity=\"1.5\"/>";
    expect_messages_of({
        {limit, "", none},
        {limit, "<limit effort=\"10\" velocity=\"1\"/>", none},
        {"lower=\"-1.5\"", "lower=\"2\"", none},
        {"lower=\"-1.5\"", "lower=\"2.5\"",
         "24:5: joint 'arm-joint' has limits that are not in order; lower must be below upper"},
        {"upper=\"2\"", "upper=\"two\"",
         "24:5: joint 'arm-joint' has limit upper 'two'; must be a number of at most 1e+06 in "
         "magnitude"},
        {"velocity=\"1.5\"", "velocity=\"-1.5\"",
         "24:5: joint 'arm-joint' has a negative velocity; must be positive"},
        {"lower=\"-1.5\"", "lower=\"-90\"",
         "24:5: joint 'arm-joint' has limits beyond three turns; must be rad: are they degrees?"},
        {"effort=\"10\"", "efort=\"10\"",
         "24:5: joint 'arm-joint' has limit with unknown attribute 'efort'; did you mean "
         "'effort'?"},
    });
}

TEST(ReadUrdf, WarnsOfAttributesOfLimitsThatItDoesNotKnow) {
    const UrdfRobot robot = read(replaced(lift_urdf, "effort=\"10\"", "command_effort=\"10\""));
    const std::vector<std::string> doubts = describe_doubts(robot);
    ASSERT_EQ(doubts.size(), 1U);
    const std::string end =
        "robot.urdf:24:5: joint 'arm-joint' has limit with unknown attribute 'command_effort', "
        "which is left out";
    EXPECT_TRUE(doubts[0].ends_with(end)) << doubts[0];
    EXPECT_EQ(make_chain(robot).joints()[1].upper, 2);
}

TEST(ReadUrdf, LeavesWhatIsOfOtherNamespacesToOthers) {
    std::string extended =
        replaced(lift_urdf, "effort=\"10\"", "drake:acceleration=\"5\" effort=\"10\"");
    extended = replaced(extended, "<axis xyz=\"0 -1 0\"/>",
                        "<axis drake:x=\"1\" xyz=\"0 -1 0\"/><drake:mimc joint=\"a\"/>");
    const UrdfRobot robot = read(extended);
    EXPECT_TRUE(describe_doubts(robot).empty());
    EXPECT_EQ(make_chain(robot).joints()[1].upper, 2);
}

TEST(ReadUrdf, TakesATemplateThatIsOnlyOfLooks) {
    const auto with = [](const std::string& inside) {
        return replaced(lift_urdf, "<link name=\"base\"/>",
                        "<link name=\"base\">" + inside + "</link>");
    };
    const std::string macro = "<xacro:colour name=\"grey\"/>";
    EXPECT_EQ(error_of(with("<visual>" + macro + "</visual>")), "no error");
    EXPECT_EQ(error_of(with("<collision><geometry>" + macro + "</geometry></collision>")),
              "no error");
    for (const std::string& inside : {macro, "<inertial>" + macro + "</inertial>"}) {
        EXPECT_NE(error_of(with(inside)).find("is a template for xacro"), std::string::npos);
    }
    EXPECT_NE(
        error_of(replaced(lift_urdf, "<axis xyz=\"0 -1 0\"/>", "<axis xyz=\"0 -1 0\"/>" + macro))
            .find("is a template for xacro"),
        std::string::npos);
}

TEST(BadUrdf, NamesAMimicOfAJointOutsideBeforeItMissesJoints) {
    const std::string error = error_of(R"(<robot name="finger">
<link name="base"/><link name="f"/><link name="tool"/>
<joint name="drive" type="revolute"><parent link="base"/><child link="f"/>
<limit lower="0" upper="1" effort="1" velocity="1"/></joint>
<joint name="follow" type="revolute"><parent link="base"/><child link="tool"/>
<limit lower="0" upper="1" effort="1" velocity="1"/><mimic joint="drive"/></joint></robot>
)",
                                       "base", "tool");
    EXPECT_NE(error.find("joint 'follow' mimics 'drive', which is no joint between base link"),
              std::string::npos)
        << error;
}

TEST(ReadUrdf, TakesHugeLimitsForNone) {
    const std::string turning =
        replaced(lift_urdf, "lower=\"-1.5\" upper=\"2\"", "lower=\"-1e16\" upper=\"1e16\"");
    const Chain chain = make_chain(read(turning));
    EXPECT_EQ(chain.joints()[1].lower, -std::numbers::pi);
    EXPECT_EQ(read(turning).joints[2].kind, UrdfJointKind::Continuous);
    const std::string sliding =
        replaced(lift_urdf, "lower=\"0\" upper=\"0.8\"", "lower=\"-1e16\" upper=\"1e16\"");
    EXPECT_FALSE(read(sliding).joints[0].limits);
    const std::string fast = replaced(lift_urdf, "velocity=\"1.5\"", "velocity=\"1e16\"");
    EXPECT_EQ(read(fast).joints[2].speed, 0);
}

TEST(ReadUrdf, DrivesAMimicByTheJointThatItMimics) {
    const std::string mimic = "<mimic joint=\"wrist\" multiplier=\"-0.5\" offset=\"0.2\"/>";
    const std::string with_origin = "<origin xyz=\"0 0.1 0\"/><axis xyz=\"0 0 -1\"/>" + mimic;
    const UrdfRobot robot =
        read(replaced(lift_urdf, "<mimic joint=\"wrist\"/>", with_origin), "base", "finger");
    const Chain chain = make_chain(robot);
    ASSERT_EQ(chain.joint_count(), 3);
    const Vector3d q(0.3, 0.8, -1.1);
    const Isometry3d expected = make_chain(read(lift_urdf)).base_from_flange(q, VectorXd()) *
                                Eigen::Translation3d(0, 0.1, 0) *
                                Eigen::AngleAxisd(-0.5 * q[2] + 0.2, -Vector3d::UnitZ());
    EXPECT_TRUE(chain.base_from_flange(q, VectorXd()).isApprox(expected, 1e-14));
    EXPECT_EQ(make_chain(read(lift_urdf, "base", "finger")).joint_count(), 3);
}

TEST(ReadUrdf, LimitsAJointByWhatItsMimicMay) {
    const auto limits_with = [](const std::string& mimic) {
        const std::string limited =
            mimic + "<limit lower=\"-0.4\" upper=\"0.1\" effort=\"1\" velocity=\"1\"/>";
        const Chain chain = make_chain(
            read(replaced(lift_urdf, "<mimic joint=\"wrist\"/>", limited), "base", "finger"));
        return std::pair{chain.joint(2).lower, chain.joint(2).upper};
    };
    const auto [lower, upper] =
        limits_with("<mimic joint='wrist' multiplier='-0.5' offset='0.2'/>");
    EXPECT_DOUBLE_EQ(lower, 0.2);
    EXPECT_DOUBLE_EQ(upper, 1.2);
    EXPECT_THROW(limits_with("<mimic joint='arm-joint' offset='5'/>"), InputError);
}

TEST(BadUrdf, Mimics) {
    const std::string stated = "<mimic joint=\"wrist\"/>";
    const auto error = [&](const std::string& by, const std::string& base) {
        return error_of(replaced(lift_urdf, stated, by), base, "finger");
    };
    const std::string rule =
        ", which is no joint between base link 'base' and tip link 'finger' that moves by itself; "
        "choose links that hold both or neither, or make it fixed";
    EXPECT_EQ(error("<mimic joint='mount'/>", "base"),
              "robot.urdf:30:3: joint 'grip' mimics 'mount'" + rule);
    EXPECT_EQ(error("<mimic joint='grip'/>", "base"),
              "robot.urdf:30:3: joint 'grip' mimics 'grip'" + rule);
    EXPECT_EQ(error("<mimic/>", "base"),
              "robot.urdf:32:5: joint 'grip' has a <mimic> without joint");
    EXPECT_EQ(error("<mimic joint='wrist' multiplier='0'/>", "base"),
              "robot.urdf:32:5: joint 'grip' has multiplier 0; must move, or be of type fixed");
    EXPECT_EQ(error("<mimic joint='wrist' factor='2'/>", "base"),
              "robot.urdf:32:5: joint 'grip' has mimic with unknown attribute 'factor'; must be "
              "joint, multiplier or offset");
}

TEST(BadUrdf, Trees) {
    expect_messages_of({
        {"<child link=\"tool\"/>", "<child link=\"toll\"/>",
         "27:25: joint 'wrist' has child 'toll', which is no link of this robot; did you mean "
         "'tool'?"},
        {"<child link=\"tool\"/>", "", "26:3: joint 'wrist' has no <child>; it must be stated"},
        {"<parent link=\"arm\"/>", "<parent/>", "27:5: a <parent> has no link; it must be stated"},
        {"<child link=\"finger\"/>", "<child link=\"arm\"/>",
         "30:3: link 'arm' is the child of two joints, 'arm-joint' and 'grip'; links must form a "
         "tree"},
        {"<parent link=\"column\"/>", "<parent link=\"tool\"/>",
         "26:3: joint 'wrist' closes a cycle; links must form a tree"},
        {"<link name=\"arm\"/>", "<link name=\"arm\"/><link name=\"arm\"/>",
         "7:21: link 'arm' occurs twice, first in line 7; must have a name of its own"},
        {"name=\"wrist\"", "name=\"lift\"",
         "26:3: joint 'lift' occurs twice, first in line 10; must have a name of its own"},
        {"name=\"wrist\"", "name=\"arm_joint\"", " joint 'arm_joint' occurs twice"},
        {" name=\"wrist\"", "", "26:3: a <joint> has no name; it must be stated"},
        {"<link name=\"arm\"/>", "<link name=\"a&#10;rm\"/>",
         "7:3: a <link> has name 'a\\x0arm'; must be one line without control characters"},
        {"<link name=\"arm\"/>", "<link name=\"a\nrm\"/>",
         "7:3: a <link> has name 'a\\x0arm'; must be one line without control characters"},
        {lift_urdf, "<robot name='a'/>", "1:1: has no <link>; a robot must have links"},
        {lift_urdf, "<sdf><robot/></sdf>",
         "1:1: is no URDF: its root element is <sdf>; must be <robot>"},
    });
}

TEST(BadUrdf, Ends) {
    struct Ends {
        std::string base, tip, message;
    };
    const std::string none = "robot.urdf: has no joint that moves between base link ";
    for (const auto& [base, tip, message] : std::vector<Ends>{
             {"bass", "tool", "robot.urdf: has no link 'bass'; did you mean 'base'?"},
             {"base", "tol", "robot.urdf: has no link 'tol'; did you mean 'tool'?"},
             {"tool", "base",
              "robot.urdf: tip link 'base' is not below base link 'tool' but below 'base' only; "
              "must be below it"},
             {"tool", "tool", none + "'tool' and tip link 'tool'"},
             {"column", "plate", none + "'column' and tip link 'plate'"},
             {"finger", "", "robot.urdf: has no tip link below base link 'finger'"},
             {"tool", "finger",
              "robot.urdf:30:3: joint 'grip' mimics 'wrist', which is no joint between base link "
              "'tool' and tip link 'finger' that moves by itself; choose links that hold both or "
              "neither, or make it fixed"}}) {
        EXPECT_EQ(error_of(lift_urdf, base, tip), message);
    }
    const std::string two =
        replaced(lift_urdf, "<parent link=\"tool\"/>", "<parent link=\"arm\"/>");
    EXPECT_EQ(error_of(two, "", ""),
              "robot.urdf: the tip link must be named (--tip), it could be finger or tool");
    const std::string ring = replaced(urdf_text({{"fixed", "", ""}, {"fixed", "", ""}}),
                                      "<child link=\"link2\"/>", "<child link=\"link0\"/>");
    EXPECT_EQ(error_of(ring, "link1", ""), "robot.urdf: has no tip link below base link 'link1'");
}

}  // namespace
}  // namespace posewise::io
