#include <gtest/gtest.h>

#include <map>
#include <pugixml.hpp>
#include <sstream>

#include "../../src/model/complete_model.hpp"
#include "posewise/io/robot_files.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

// Models for MuJoCo, by a forward kinematics of their own.

namespace posewise::io {
namespace {

using namespace detail;
using namespace testing;

VectorXd numbers_of(pugi::xml_node node, const char* attribute, Index count) {
    std::istringstream text(node.attribute(attribute).value());
    VectorXd numbers(count);
    for (Index i = 0; i < count; ++i) EXPECT_TRUE(text >> numbers[i]) << attribute;
    EXPECT_TRUE((text >> std::ws).eof()) << attribute;
    return numbers;
}

Isometry3d place_of(pugi::xml_node node) {
    const VectorXd q = numbers_of(node, "quat", 4);
    Isometry3d place = Isometry3d::Identity();
    place.translation() = numbers_of(node, "pos", 3);
    place.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    return place;
}

/// Where the sites are, by name, at joint values by name: as MuJoCo has it, body by body, the
/// joints of each one after another about or along its axes, equalities kept.
std::map<std::string, Isometry3d> sites_at(const pugi::xml_document& model,
                                           std::map<std::string, double> qpos) {
    for (const pugi::xml_node follows : model.child("mujoco").child("equality").children("joint")) {
        const VectorXd polynomial = numbers_of(follows, "polycoef", 5);
        EXPECT_TRUE(qpos.contains(follows.attribute("joint2").value()));
        qpos[follows.attribute("joint1").value()] =
            polynomial[0] + polynomial[1] * qpos[follows.attribute("joint2").value()];
    }
    std::map<std::string, Isometry3d> sites;
    std::size_t used = 0;
    Isometry3d frame = Isometry3d::Identity();
    for (pugi::xml_node body = model.child("mujoco").child("worldbody").child("body"); body;
         body = body.child("body")) {
        frame = frame * place_of(body);
        for (const pugi::xml_node joint : body.children("joint")) {
            const double value = qpos.at(joint.attribute("name").value());
            const Vector3d axis = numbers_of(joint, "axis", 3);
            ++used;
            if (std::string_view(joint.attribute("type").value()) == "hinge") {
                frame = frame * Eigen::AngleAxisd(value, axis);
            } else {
                frame = frame * Eigen::Translation3d(value * axis);
            }
        }
        for (const pugi::xml_node site : body.children("site")) {
            sites[site.attribute("name").value()] = frame * place_of(site);
        }
    }
    EXPECT_EQ(used, qpos.size());
    return sites;
}

/// FANUC's coupling: joint 3 against the ground, and a joint that another one follows by half.
Chain coupled() {
    using enum Motion;
    return {{{"q1", -3, 3}, {"q2", -1, 2}, {"q3", -2, 1}},
            {{Rotation, Axis::Z, 0.1, {{0, 1}}, "d1"},
             {Translation, Axis::X, 0.3, {}, "a1"},
             {Rotation, Axis::Y, 0, {{1, -1}}, "d2"},
             {Rotation, Axis::X, 0.2, {{2, 1}, {1, 1}}, "d3"},
             {Translation, Axis::Z, 0.5, {}, ""},
             {Rotation, Axis::Y, 0, {{0, 0.5}}, "d4"},
             {Translation, Axis::X, 0.3, {}, "a4"}}};
}

TEST(WriteMujoco, HasTheFlangeAndTargetsWhereTheCalibratedRobotHasThem) {
    const TemporaryFolder folder;
    const std::string path = folder.path("arm.xml");
    for (const Chain& chain : {fanuc(), scara(), gantry_with_wrist(), ur_type(), coupled()}) {
        Geometry geometry;
        geometry.robot = complete_model(with_harmonics(chain, {1}));
        RandomStream stream(31);
        geometry.errors = random_vector(stream, geometry.robot.parameter_count(), 1e-2);
        for (Index k = 0; k < geometry.errors.size(); ++k) {
            if (geometry.robot.parameter_term(k) != nullptr) geometry.errors[k] = 0;
        }
        geometry.targets = {{0.1, 0.02, 0.3}, {0, -0.1, 0.05}};
        const FlangeDifference difference = write_mujoco(path, "a\"<b", geometry);
        EXPECT_LT(difference.position, 1e-13);
        EXPECT_LT(difference.orientation, 1e-13);
        pugi::xml_document model;
        ASSERT_TRUE(model.load_file(path.c_str()));
        EXPECT_STREQ(model.child("mujoco").attribute("model").value(), "a\"<b");
        for (Index i = 0; i < 100; ++i) {
            VectorXd q(geometry.robot.joint_count());
            std::map<std::string, double> qpos;
            for (Index j = 0; j < q.size(); ++j) {
                const Joint& joint = geometry.robot.joint(j);
                qpos[joint.name] = q[j] = stream.uniform(joint.lower, joint.upper);
            }
            const Isometry3d flange = geometry.robot.base_from_flange(q, geometry.errors);
            const auto sites = sites_at(model, qpos);
            EXPECT_EQ(sites.size(), 3U);
            EXPECT_TRUE(sites.at("flange").isApprox(flange, 1e-12));
            for (std::size_t k = 0; k < 2; ++k) {
                const Vector3d target = sites.at("target" + std::to_string(k + 1)).translation();
                EXPECT_LT((target - flange * geometry.targets[k]).norm(), 1e-12);
            }
        }
        for (const pugi::xpath_node found : model.select_nodes("//joint[@range]")) {
            const auto& joints = geometry.robot.joints();
            const auto joint =
                std::ranges::find(joints, found.node().attribute("name").value(), &Joint::name);
            ASSERT_NE(joint, joints.end());
            EXPECT_EQ(numbers_of(found.node(), "range", 2),
                      Eigen::Vector2d(joint->lower, joint->upper));
        }
        EXPECT_EQ(std::ssize(model.select_nodes("//joint[@range]")), geometry.robot.joint_count());
    }
}

TEST(WriteMujoco, HasTheToolOfMeasuredPoses) {
    const TemporaryFolder folder;
    Geometry geometry;
    geometry.robot = ur_type();
    geometry.tool =
        Isometry3d(Eigen::Translation3d(0.1, 0, 0.2) * Eigen::AngleAxisd(1, Vector3d::UnitY()));
    write_mujoco(folder.path("a.xml"), "ur", geometry);
    pugi::xml_document model;
    ASSERT_TRUE(model.load_file(folder.path("a.xml").c_str()));
    const pugi::xml_node tool = model.select_node("//site[@name='tool']").node();
    EXPECT_TRUE(place_of(tool).isApprox(*geometry.tool, 1e-14));
}

}  // namespace
}  // namespace posewise::io
