#include <gtest/gtest.h>

#include "../../src/io/format/json.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/parameter_error.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::input_error_of;
using testing::TemporaryFolder;

/// Files in the place of a campaign.
TEST(FileKind, OfWhatIsNoCampaignIsNamed) {
    const TemporaryFolder folder;
    const auto error_of = [&](const std::string& text) {
        const std::string path = folder.write("f", text);
        return input_error_of([&] { read_campaign(path); });
    };
    EXPECT_EQ(error_of("<?xml version=\"1.0\"?>\n<robot name=\"a\"/>"),
              "f: is a URDF; must be a campaign file (YAML); `posewise inspect FILE "
              "--write-campaign campaign.yaml` makes a campaign of it");
    EXPECT_NE(error_of("<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:arm/></robot>")
                  .find("a xacro file"),
              std::string::npos);
    // What xacro has made is a URDF.
    EXPECT_NE(
        error_of("<!-- made by xacro from arm.xacro -->\n<robot name=\"arm\"/>").find("a URDF"),
        std::string::npos);
    EXPECT_EQ(error_of("{\"kind\": \"posewise estimate\", \"format\": 1}"),
              "f: is an estimate that posewise wrote; must be a campaign file (YAML)");
    EXPECT_EQ(error_of("# by hand\nconfig,q1_deg\n1,2\n"),
              "f: is a table of configurations; must be a campaign file (YAML)");
    // YAML in braces is a campaign all the same.
    EXPECT_NE(error_of("{name: x}").find("has no key robot"), std::string::npos);
}

TEST(FileKind, OfACampaignInAnotherPlaceIsNamed) {
    const TemporaryFolder folder;
    const std::string path = folder.write("c.yaml", "name: a\nrobot:\n  urdf: a.urdf\n");
    EXPECT_EQ(input_error_of([&] { detail::read_document(path, "plan"); }),
              "c.yaml: is a campaign file; must be a plan as posewise writes it");
    EXPECT_EQ(input_error_of([&] { read_configurations(path, CampaignFile{}); }),
              "c.yaml: is a campaign file; must be a table (CSV)");
}

TEST(FileKind, ALineThatATabIndentsIsNamed) {
    const TemporaryFolder folder;
    const std::string path = folder.write("c.yaml", "name: a\nrobot:\n\turdf: a.urdf\n");
    EXPECT_NE(input_error_of([&] {
                  read_campaign(path);
              }).find("the line is indented by a tab; must be by spaces"),
              std::string::npos);
}

}  // namespace
}  // namespace posewise::io
