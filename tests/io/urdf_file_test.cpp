#include "posewise/io/urdf_file.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "campaign_text.hpp"
#include "posewise/model/complete_model.hpp"
#include "posewise/model/transforms.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"
#include "support/urdf_text.hpp"

namespace posewise::io {
namespace {

using namespace testing;

/// A column that slides, an arm behind a fixed joint, a wrist; a finger that mimics beside the way.
const std::string text = R"(<?xml version="1.0"?>
<!-- A robot -->
<robot name="lift &amp; arm">
  <link name="base"/>
  <link name="column"/>
  <link name="plate"/>
  <link name="arm"/>
  <link name="tool"/>
  <link name="finger"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="column"/>
    <origin xyz="0.1 0 0.5"/>
    <axis xyz="0 0 2"/>
    <limit lower="0" upper="0.8" effort="100" velocity="0.5"/>
  </joint>
  <joint name="mount" type="fixed">
    <origin xyz="0 0.2 0" rpy="0.1 -0.2 1.5"/>
    <parent link="column"/><child link="plate"/>
  </joint>
  <joint name="arm-joint" type="revolute">
    <parent link="plate"/><child link="arm"/>
    <origin rpy="0.4 0 0" xyz="0 0 0.3"/>
    <axis xyz="0 -1 0"/>
    <limit lower="-1.5" upper="2" effort="10" velocity="1.5"/>
  </joint>
  <joint name="wrist" type="continuous">
    <parent link="arm"/><child link="tool"/>
    <origin xyz="0.4 0 0"/>
  </joint>
  <joint name="grip" type="revolute">
    <parent link="tool"/><child link="finger"/>
    <mimic joint="wrist"/>
  </joint>
</robot>
)";

UrdfRobot read(const std::string& content, const std::string& base = "base",
               const std::string& tip = "tool") {
    const TemporaryFolder folder;
    return read_urdf({folder.write("robot.urdf", content), base, tip});
}

std::string error_of(const std::string& content, const std::string& base = "base",
                     const std::string& tip = "tool") {
    return input_error_of([&] { make_chain(read(content, base, tip)); });
}

std::string error_with(const std::string& part, const std::string& by) {
    return error_of(replaced(text, part, by));
}

TEST(ReadUrdf, GivesTheJointsFromBaseToTip) {
    const UrdfRobot robot = read(text);
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
    const Chain chain = make_chain(read(text));
    ASSERT_EQ(chain.joint_count(), 3);
    EXPECT_EQ(chain.joints()[1].name, "arm_joint");
    EXPECT_EQ(chain.joints()[1].lower, -1.5);
    EXPECT_EQ(chain.joints()[1].upper, 2);
    EXPECT_EQ(chain.joints()[2].upper, std::numbers::pi);
    EXPECT_EQ(chain.joint(0).motion, Motion::Translation);
    const std::string faster = replaced(text, "<origin xyz=\"0.4 0 0\"/>", "<limit velocity='4'/>");
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
    EXPECT_TRUE(make_chain(read(text)).base_from_flange(q, VectorXd()).isApprox(expected, 1e-14));
}

std::string vector_text(const Vector3d& v) {
    std::ostringstream words;
    words.precision(17);
    words << v.x() << ' ' << v.y() << ' ' << v.z();
    return words.str();
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
    EXPECT_EQ(error_of(text, "base", "finger"),
              "robot.urdf:30:3: joint 'grip' mimics another joint; only joints that move by "
              "themselves can be part of the chain");
    EXPECT_EQ(
        error_with("type=\"continuous\"", "type=\"floating\""),
        "robot.urdf:26:3: joint 'wrist' is of type 'floating', which moves in several ways at "
        "once; must be one of revolute, continuous, prismatic or fixed");
    EXPECT_EQ(error_with("type=\"continuous\"", "type=\"planar\""),
              "robot.urdf:26:3: joint 'wrist' is of type 'planar', which moves in several ways at "
              "once; must be one of revolute, continuous, prismatic or fixed");
    EXPECT_EQ(error_with("type=\"continuous\"", "type=\"continous\""),
              "robot.urdf:26:3: joint 'wrist' is of type 'continous'; did you mean 'continuous'?");
    EXPECT_EQ(error_with(" type=\"continuous\"", ""),
              "robot.urdf:26:3: joint 'wrist' has no type; it must be stated");
    EXPECT_EQ(
        error_with("0 -1 0", "0 0 0"),
        "robot.urdf:23:5: joint 'arm-joint' has the axis '0 0 0', which has no direction; must "
        "not be zero");
    EXPECT_EQ(error_with("<origin xyz=\"0.4 0 0\"/>", "<orign xyz=\"0.4 0 0\"/>"),
              "robot.urdf:28:5: joint 'wrist' has an element 'orign'; did you mean 'origin'?");
    EXPECT_EQ(error_with("<axis xyz=\"0 -1 0\"/>", "<axis xyz=\"0 -1 0\"/><axis xyz=\"0 1 0\"/>"),
              "robot.urdf:23:25: a second <axis> in one <joint>; must be one");
}

TEST(BadUrdf, Numbers) {
    const std::string rule = "; must be three numbers, each at most 1e+06 in magnitude";
    for (const std::string bad : {"0 -1", "0 -1 0 0", "0 nan 0", "0 inf 0", "0 1e400 0", "0 1e9 0",
                                  "0 -1 0x", "0, -1, 0", ""}) {
        EXPECT_EQ(error_with("0 -1 0", bad),
                  "robot.urdf:23:5: joint 'arm-joint' has axis xyz '" + bad + "'" + rule);
    }
    EXPECT_EQ(error_with("rpy=\"0.4 0 0\"", "rpy=\"${pi/2} 0 0\""),
              "robot.urdf:22:5: joint 'arm-joint' has origin rpy '${pi/2} 0 0'" + rule);
    EXPECT_EQ(
        error_with("rpy=\"0.4 0 0\"", "rpy_deg=\"0.4 0 0\""),
        "robot.urdf:22:5: joint 'arm-joint' has origin with unknown attribute 'rpy_deg'; must "
        "be xyz or rpy");
}

TEST(BadUrdf, Limits) {
    const std::string none =
        "joint 'arm-joint' has no limits that leave it room; must have, here or in a campaign "
        "under "
        "robot.joints";
    const std::string limit = "<limit lower=\"-1.5\" upper=\"2\" effort=\"10\" velocity=\"1.5\"/>";
    EXPECT_EQ(error_with(limit, ""), "robot.urdf:20:3: " + none);
    EXPECT_EQ(error_with(limit, "<limit effort=\"10\" velocity=\"1\"/>"),
              "robot.urdf:20:3: " + none);
    EXPECT_EQ(error_with("lower=\"-1.5\"", "lower=\"2\""), "robot.urdf:20:3: " + none);
    EXPECT_EQ(error_with("lower=\"-1.5\"", "lower=\"2.5\""),
              "robot.urdf:24:5: joint 'arm-joint' has limits that are not in order; lower must be "
              "below upper");
    EXPECT_EQ(
        error_with("upper=\"2\"", "upper=\"two\""),
        "robot.urdf:24:5: joint 'arm-joint' has limit upper 'two'; must be a number of at most "
        "1e+06 in magnitude");
    EXPECT_EQ(error_with("velocity=\"1.5\"", "velocity=\"-1.5\""),
              "robot.urdf:24:5: joint 'arm-joint' has a negative velocity; must be positive");
}

TEST(BadUrdf, Trees) {
    EXPECT_EQ(error_of(text, "bass"), "robot.urdf: has no link 'bass'; did you mean 'base'?");
    EXPECT_EQ(error_of(text, "base", "tol"), "robot.urdf: has no link 'tol'; did you mean 'tool'?");
    EXPECT_EQ(
        error_of(text, "tool", "base"),
        "robot.urdf: tip link 'base' is not below base link 'tool' but below 'base' only; must "
        "be below it");
    EXPECT_EQ(error_of(text, "tool", "tool"),
              "robot.urdf: has no joint that moves between base link 'tool' and tip link 'tool'");
    EXPECT_EQ(
        error_of(text, "column", "plate"),
        "robot.urdf: has no joint that moves between base link 'column' and tip link 'plate'");
    EXPECT_EQ(
        error_with("<child link=\"tool\"/>", "<child link=\"toll\"/>"),
        "robot.urdf:27:25: joint 'wrist' has child 'toll', which is no link of this robot; did "
        "you mean 'tool'?");
    EXPECT_EQ(error_with("<child link=\"tool\"/>", ""),
              "robot.urdf:26:3: joint 'wrist' has no <child>; it must be stated");
    EXPECT_EQ(error_with("<parent link=\"arm\"/>", "<parent/>"),
              "robot.urdf:27:5: a <parent> has no link; it must be stated");
    EXPECT_EQ(
        error_with("<child link=\"finger\"/>", "<child link=\"arm\"/>"),
        "robot.urdf:30:3: link 'arm' is the child of two joints, 'arm-joint' and 'grip'; links "
        "must form a tree");
    EXPECT_EQ(error_with("<parent link=\"column\"/>", "<parent link=\"tool\"/>"),
              "robot.urdf:26:3: joint 'wrist' closes a cycle; links must form a tree");
    EXPECT_EQ(error_with("<link name=\"arm\"/>", "<link name=\"arm\"/><link name=\"arm\"/>"),
              "robot.urdf:7:21: link 'arm' occurs twice, first in line 7; must have a name of its "
              "own");
    EXPECT_EQ(
        error_with("name=\"wrist\"", "name=\"lift\""),
        "robot.urdf:26:3: joint 'lift' occurs twice, first in line 10; must have a name of its "
        "own");
    EXPECT_EQ(error_with("name=\"wrist\"", "name=\"arm_joint\""),
              "robot.urdf: joint 'arm_joint' occurs twice");
    EXPECT_EQ(error_with(" name=\"wrist\"", ""),
              "robot.urdf:26:3: a <joint> has no name; it must be stated");
    EXPECT_EQ(error_with("<link name=\"arm\"/>", "<link name=\"a&#10;rm\"/>"),
              "robot.urdf:7:3: a <link> has name 'a\\x0arm'; must be one line without control "
              "characters");
    EXPECT_EQ(error_of("<robot name='a'/>"),
              "robot.urdf:1:1: has no <link>; a robot must have links");
    EXPECT_EQ(error_of("<sdf><robot/></sdf>"),
              "robot.urdf:1:1: is no URDF: its root element is <sdf>; must be <robot>");
}

TEST(BadUrdf, TipThatCouldBeSeveral) {
    const std::string two = replaced(text, "<parent link=\"tool\"/>", "<parent link=\"arm\"/>");
    EXPECT_EQ(error_of(two, "", ""),
              "robot.urdf: the tip link must be named, it could be finger or tool");
    EXPECT_EQ(error_of(text, "finger", ""), "robot.urdf: has no tip link below base link 'finger'");
    const std::string ring = replaced(urdf_text({{"fixed", "", ""}, {"fixed", "", ""}}),
                                      "<child link=\"link2\"/>", "<child link=\"link0\"/>");
    EXPECT_EQ(error_of(ring, "link1", ""), "robot.urdf: has no tip link below base link 'link1'");
}

TEST(HostileXml, IsRefusedWithItsPlace) {
    EXPECT_EQ(error_of(""),
              "robot.urdf: is not XML: empty document; correct it there or just before");
    EXPECT_EQ(error_of("no markup at all"),
              "robot.urdf:1: is not XML: parsing text; correct it there or just before");
    EXPECT_EQ(error_with("</robot>", ""),
              "robot.urdf:3: is not XML: parsing; correct it there or just before");
    EXPECT_EQ(error_with("<link name=\"base\"/>", "<link name=\"base\">"),
              "robot.urdf:4: is not XML: mismatched element; correct it there or just before");
    EXPECT_EQ(error_with("name=\"base\"/>", "name=\"base/>"),
              "robot.urdf:4:3: begins a tag that never ends");
    EXPECT_EQ(error_with("<!-- A robot -->", "<!-- A robot"),
              "robot.urdf:2:1: begins a comment that never ends");
    EXPECT_EQ(error_with("</robot>", "</robot><robot/>"),
              "robot.urdf:34: is not XML: a second root element begins; must be one");
    EXPECT_EQ(error_with("<link name=\"base\"/>", "<xacro:property name=\"a\" value=\"1\"/>"),
              "robot.urdf:4:3: is a template for xacro; must be what xacro makes of it");
    EXPECT_EQ(error_with("A robot", std::string("A\0robot", 7)),
              "robot.urdf:2:7: has a NUL byte; must be text in UTF-8");
    EXPECT_EQ(error_with("xyz=\"0.4 0 0\"", "xyz=\"0.4 0 0\" xyz=\"0 0 0\""),
              "robot.urdf:28: is not XML: parsing attribute; correct it there or just before");
}

TEST(HostileXml, OfEntitiesIsRefused) {
    EXPECT_EQ(error_with("<!-- A robot -->",
                         "<!DOCTYPE robot [ <!ENTITY a \"aaaaaaaaaa\"> <!ENTITY b \"&a;&a;\"> ]>"),
              "robot.urdf:2:1: declares a document type or an entity; must have none");
    EXPECT_EQ(error_with("<!-- A robot -->", "<!DOCTYPE robot SYSTEM \"file:///etc/passwd\">"),
              "robot.urdf:2:1: declares a document type or an entity; must have none");
    EXPECT_EQ(
        error_with("xyz=\"0.4 0 0\"", "xyz=\"&a; 0 0\""),
        "robot.urdf:28:5: joint 'wrist' has origin xyz '&a; 0 0'; must be three numbers, each "
        "at most 1e+06 in magnitude");
}

TEST(HostileXml, ThatIsDeepLongOrHugeIsRefusedAtOnce) {
    std::string deep;
    for (int i = 0; i < 200000; ++i) deep += "<a>";
    EXPECT_EQ(error_of(deep), "robot.urdf:1:151: is nested more than 50 deep; must be less");
    EXPECT_EQ(error_of("<robot name=\"" + std::string(1 << 20, 'x') + "\"/>"),
              "robot.urdf:1:1: begins a tag longer than 64 KiB; must be shorter");
    std::string attributes;
    for (int i = 0; i < 300000; ++i) attributes += " a" + std::to_string(i) + "=''";
    EXPECT_EQ(error_of("<robot" + attributes + "/>"),
              "robot.urdf:1:1: begins a tag longer than 64 KiB; must be shorter");
    EXPECT_EQ(error_of(std::string((4 << 20) + 1, ' ')),
              "robot.urdf: is larger than 4 MiB; must be smaller");
}

/// Takes a moment if the tree is walked again and again.
TEST(HostileXml, ThatIsALongTreeIsReadAtOnce) {
    const std::vector<JointText> joints(10000, {"fixed", "", ""});
    EXPECT_EQ(error_of(urdf_text(joints), "", ""),
              "robot.urdf: has no joint that moves between base link 'link0' and tip link "
              "'link10000'");
    EXPECT_EQ(
        error_of(urdf_text(std::vector<JointText>(101, {"revolute", "", ""})), "", ""),
        "robot.urdf: has 101 joints between base link 'link0' and tip link 'link101'; at most "
        "100 of them may move");
}

/// A few bytes replaced, cut out or doubled.
std::string mutate(std::string content, RandomStream& stream) {
    const std::string bytes = "<>/=\"'&;! -.09exyz\n\t\x01\xff";
    const auto below = [&](std::size_t count) {
        return static_cast<std::size_t>(stream.uniform(0, static_cast<double>(count) - 1e-6));
    };
    for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
        const std::size_t position = below(content.size());
        const std::size_t length = std::min(below(30), content.size() - position);
        const double kind = stream.uniform(0, 3);
        if (kind < 1) {
            content[position] = bytes[below(bytes.size())];
        } else if (kind < 2) {
            content.erase(position, length);
        } else {
            content.insert(position, content.substr(below(content.size()), length));
        }
    }
    return content;
}

TEST(HostileXml, OfAnyKindIsARobotThatCanBeExportedOrOneLine) {
    RandomStream stream(31);
    Index readable = 0;
    const TemporaryFolder folder;
    for (Index i = 0; i < sweep_count() / 4; ++i) {
        const UrdfSource source{folder.write("robot.urdf", mutate(text, stream)), "base", "tool"};
        try {
            const Chain robot = complete_model(make_chain(read_urdf(source)));
            const VectorXd errors = random_vector(stream, robot.parameter_count(), 0.1);
            const CalibratedUrdf urdf = make_calibrated_urdf(source, robot, errors);
            ++readable;
            if (!urdf.not_expressed.empty()) continue;
            const Chain again =
                make_chain(read_urdf({folder.write("again.urdf", urdf.text), "base", "tool"}));
            const VectorXd q = random_vector(stream, robot.joint_count(), 1);
            EXPECT_TRUE(again.base_from_flange(q, VectorXd())
                            .isApprox(robot.base_from_flange(q, errors), 1e-9))
                << urdf.text;
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        }
    }
    EXPECT_GT(readable, sweep_count() / 120);
    EXPECT_LT(readable, sweep_count() / 4);
}

}  // namespace
}  // namespace posewise::io
