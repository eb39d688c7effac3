#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "lift_urdf.hpp"
#include "posewise/io/robot_files.hpp"
#include "support/mutate.hpp"
#include "support/sweep.hpp"
#include "support/urdf_text.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using namespace testing;

TEST(HostileXml, IsRefusedWithItsPlace) {
    const std::string base = "<link name=\"base\"/>";
    const std::string tag = "begins a tag that is not XML; must be like <name a=\"1\" b=\"2\">";
    const std::string question =
        "is not XML: a <?...?> must end with ?>, and <?xml must stand first";
    const std::string markup = "is not XML: a '<' must begin a tag or be written &lt;";
    const std::string outside = "is not XML: text outside of the root element";
    expect_messages_of({
        {lift_urdf, "", " is not XML: it has no element"},
        {lift_urdf, "<!-- only this -->", " is not XML: it has no element"},
        {lift_urdf, "no markup at all", "1:1: " + outside},
        {"</robot>", "</robot>\n and more", "35:2: " + outside},
        {"</robot>", "", "3:1: is not XML: <robot> is never closed"},
        {"</robot>", "</robot", "34:1: is not XML: an end tag must be </name>"},
        {"</robot>", "</robot></robot>", "34:9: is not XML: an end tag without a start tag"},
        {"</robot>", "</robot><robot/>",
         "34:9: is not XML: a second root element begins; must be one"},
        {base, "<link name=\"base\">",
         "4:3: is not XML: <link> is not closed before the end tag in line 34"},
        {base, "<link name=\"base\"><a/></lnk>",
         "4:3: is not XML: <link> is not closed before the end tag in line 4"},
        {base, "<link name=\"base/>", "4:3: " + tag},
        {base, "<link name=base/>", "4:3: " + tag},
        {base, "<link a='1'name='base'/>", "4:3: " + tag},
        {base, "<link name='base' <a/>", "4:3: " + tag},
        {base, base + " <", "4:23: " + markup},
        {base, base + " < b", "4:23: " + markup},
        {"</robot>\n", "</robot><", "34:9: " + markup},
        {"<!-- A robot -->", "<!-- A robot", "2:1: begins a comment that never ends"},
        {base, base + "<![CDATA[ <b> ]]", "4:22: begins a CDATA section that never ends"},
        {base, base + "<?b", "4:22: " + question},
        {base, base + "<?xml version='1.0'?>", "4:22: " + question},
        {"<?xml", "<!-- first --><?xml", "1:15: " + question},
        {base, "<xacro:property name=\"a\" value=\"1\"/>",
         "4:3: is a template for xacro; must be what xacro makes of it"},
        {"A robot", std::string("A\0robot", 7), "2:7: has a NUL byte; must be text in UTF-8"},
        {lift_urdf, std::string("\xFF\xFE<\0r\0", 6), "1:4: has a NUL byte; must be text in UTF-8"},
        {"xyz=\"0.4 0 0\"", "xyz=\"0.4 0 0\" xyz=\"0 0 0\"",
         "28:5: is not XML: a second attribute 'xyz' in one <origin>; must be one"},
    });
}

/// What a well-formed file may have, and a reader that looks for '<' and '>' only falls over.
TEST(ReadUrdf, TakesEveryMarkupThatIsNoElement) {
    const std::string base = "<link name=\"base\"/>";
    for (const std::string by :
         {"<link name='base'><![CDATA[ </robot> ]]></link>", "<link name = 'b&#x61;se'></link >",
          "<link name=\"base\" note=\"'>'\"/>", "<link name='base'/><!-- <link> -->",
          "<link name='base'/> text > &amp; &#60; more <?php <a> ?>",
          "<link\n\tname='base'\r\n/>"}) {
        EXPECT_EQ(error_of(replaced(lift_urdf, base, by)), "no error") << by;
    }
    EXPECT_EQ(error_of("\xEF\xBB\xBF" + lift_urdf), "no error");
    EXPECT_EQ(error_of(lift_urdf + "<!-- end --><?end?>\n"), "no error");
    EXPECT_EQ(error_of(replaced(lift_urdf, "?>", " encoding='latin1'?>")), "no error");
}

TEST(HostileXml, WithANameThatIsNotUtf8BecomesACampaign) {
    const TemporaryFolder folder;
    const std::string path = folder.write(
        "robot.urdf", replaced(lift_urdf, "<robot name=\"", "<robot name=\"\xff\x98\x98\x98"));
    const UrdfRobot robot = read_urdf({path, "base", "tool"});
    EXPECT_NE(make_campaign_text(robot, folder.path("c.yaml")).find("name: \"\\\\xff\\\\x98"),
              std::string::npos);
}

TEST(HostileXml, OfEntitiesIsRefused) {
    const std::string problem = "declares a document type or an entity; must have none";
    expect_messages_of({
        {"<!-- A robot -->",
         "<!DOCTYPE robot [ <!ENTITY a \"aaaaaaaaaa\"> <!ENTITY b \"&a;&a;\"> ]>",
         "2:1: " + problem},
        {"<!-- A robot -->", "<!DOCTYPE robot SYSTEM \"file:///etc/passwd\">", "2:1: " + problem},
        {"<!-- A robot -->", "<!DOCTYPE robot [", "2:1: " + problem},
        {"<link name=\"base\"/>", "<!DOCTYPE robot>", "4:3: " + problem},
        {"<link name=\"base\"/>", "<!ENTITY a 'b'>", "4:3: " + problem},
        {"xyz=\"0.4 0 0\"", "xyz=\"&a; 0 0\"",
         "28:5: joint 'wrist' has origin xyz '&a; 0 0'; must be three numbers, each at most 1e+06 "
         "in magnitude"},
    });
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
              "robot.urdf: has 10000 joints between base link 'link0' and tip link 'link10000'; "
              "must be at most 1000");
    EXPECT_EQ(
        error_of(urdf_text(std::vector<JointText>(101, {"revolute", "", ""})), "", ""),
        "robot.urdf: has 101 joints between base link 'link0' and tip link 'link101'; at most "
        "100 of them may move");
}

TEST(HostileXml, OfAnyKindIsARobotThatCanBeExportedOrOneLine) {
    RandomStream stream(31);
    Index readable = 0;
    const TemporaryFolder folder;
    for (Index i = 0; i < sweep_count() / 4; ++i) {
        const UrdfSource source{folder.write("robot.urdf", mutate_bytes(lift_urdf, stream)), "base",
                                "tool"};
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
