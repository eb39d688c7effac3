#include <gtest/gtest.h>

#include <algorithm>

#include "lift_urdf.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/campaign_file.hpp"

namespace posewise::io {
namespace {

using namespace testing;

std::string with_shape(const std::string& link, const std::string& shape,
                       const std::string& origin = "") {
    return replaced(lift_urdf, "<link name=\"" + link + "\"/>",
                    "<link name=\"" + link + "\"><collision>" + origin + "<geometry>" + shape +
                        "</geometry></collision></link>");
}

UrdfBodies bodies_of(const std::string& content) {
    const TemporaryFolder folder;
    return read_urdf_bodies(read_urdf({folder.write("robot.urdf", content), "base", "tool"}));
}

TEST(ReadUrdfBodies, HoldBoxesCylindersSpheresAndCapsules) {
    RandomStream random(3);
    const auto holds = [](const UrdfBodies& bodies, const Vector3d& point) {
        return std::ranges::any_of(bodies.links, [&](const Link& link) {
            return distance(point, link.solid.from, link.solid.to) <= link.solid.radius + 1e-12;
        });
    };
    for (const Vector3d& size : {Vector3d(0.5, 0.1, 0.2), Vector3d(0.3, 0.02, 0.3)}) {
        const UrdfBodies box = bodies_of(with_shape(
            "base", "<box size='" + std::to_string(size.x()) + ' ' + std::to_string(size.y()) +
                        ' ' + std::to_string(size.z()) + "'/>"));
        ASSERT_FALSE(box.links.empty());
        for (int k = 0; k < 500; ++k) {
            Vector3d corner;
            for (Index axis = 0; axis < 3; ++axis) {
                corner[axis] = size[axis] / 2 * std::clamp(random.uniform(-2, 2), -1.0, 1.0);
            }
            EXPECT_TRUE(holds(box, corner)) << corner.transpose();
        }
    }
    const UrdfBodies cylinder =
        bodies_of(with_shape("base", "<cylinder radius='0.1' length='0.4'/>"));
    for (int k = 0; k < 200; ++k) {
        const double angle = random.uniform(-3, 3);
        EXPECT_TRUE(holds(cylinder, {0.1 * std::cos(angle), 0.1 * std::sin(angle), 0.2}));
    }
    const Link ball = bodies_of(with_shape("base", "<sphere radius='0.25'/>")).links.at(0);
    EXPECT_EQ(ball.solid.radius, 0.25);
    const Link capsule =
        bodies_of(with_shape("base", "<capsule radius='0.05' length='0.2'/>")).links.at(0);
    EXPECT_EQ(capsule.solid.to, Vector3d(0, 0, 0.1));
}

TEST(ReadUrdfBodies, AreInTheFramesOfACell) {
    const Link plate =
        bodies_of(with_shape("plate", "<sphere radius='0.1'/>", "<origin xyz='0 0.1 0'/>"))
            .links.at(0);
    EXPECT_EQ(plate.name, "plate");
    EXPECT_EQ(plate.frame, 1) << "behind a fixed joint, after the lift";
    EXPECT_LT(plate.solid.radius, 0.1 + 1e-12);
    EXPECT_EQ(bodies_of(with_shape("tool", "<sphere radius='0.1'/>")).links.at(0).frame, 3);
}

TEST(ReadUrdfBodies, SayWhatIsSkipped) {
    const UrdfBodies meshes = bodies_of(with_shape("arm", "<mesh filename='a.stl'/>"));
    EXPECT_TRUE(meshes.links.empty());
    ASSERT_EQ(meshes.skipped.size(), 1U);
    EXPECT_EQ(meshes.skipped[0],
              "the collision meshes of arm are not looked at; state capsules for them under "
              "cell.links");
    EXPECT_EQ(bodies_of(with_shape("arm", "<cone radius='1'/>")).skipped.at(0),
              "link 'arm' has a collision shape <cone>, which is not known; state capsules for it "
              "under cell.links");
    EXPECT_NE(input_error_of([] {
                  bodies_of(with_shape("arm", "<sphere/>"));
              }).find("link 'arm' has a <sphere> without positive radius"),
              std::string::npos);
    // The tool within the column, at any place of the lift.
    std::string always = with_shape("base", "<box size='9 9 9'/>");
    always = replaced(always, "<link name=\"arm\"/>",
                      "<link name=\"arm\"><collision><geometry><sphere radius='0.1'/></geometry>"
                      "</collision></link>");
    always = replaced(always, "<link name=\"tool\"/>",
                      "<link name=\"tool\"><collision><geometry><sphere radius='0.2'/></geometry>"
                      "</collision></link>");
    const UrdfBodies overlapping = bodies_of(always);
    EXPECT_NE(
        overlapping.skipped.at(0).find("of link 'tool' overlaps that of link 'base' wherever"),
        std::string::npos)
        << overlapping.skipped.at(0);
}

TEST(MakeCampaignText, HasTheRobotsBodiesAsLinksOfItsCell) {
    const TemporaryFolder folder;
    const std::string path =
        folder.write("robot.urdf", with_shape("arm", "<cylinder radius='0.05' length='0.3'/>"));
    const std::string text =
        make_campaign_text(read_urdf({path, "base", "tool"}), folder.write("c.yaml", ""));
    const CampaignFile file =
        parse_campaign(text, (std::filesystem::path(path).parent_path() / "c.yaml").string());
    ASSERT_EQ(file.cell.links.size(), 1U) << text;
    EXPECT_EQ(file.cell.links[0].name, "arm");
    EXPECT_EQ(file.cell.links[0].frame, 2);
}

}  // namespace
}  // namespace posewise::io
