#include "posewise/task/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "../../src/model/sampling.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/cells.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

using namespace testing;

Campaign campaign_in_cell() {
    Campaign campaign = cell_campaign();
    campaign.cell = demo_cell();
    return campaign;
}

/// Of the first elements of a scene's robot.
Isometry3d base_from_element(const Chain& robot, Index count, const VectorXd& q) {
    Isometry3d pose = Isometry3d::Identity();
    for (Index k = 0; k < count; ++k) {
        const Element& element = robot.elements()[static_cast<std::size_t>(k)];
        double amount = element.value;
        for (const JointTerm& term : element.joints) amount += term.coefficient * q[term.joint];
        const Vector3d axis = Vector3d::Unit(static_cast<int>(element.axis));
        if (element.motion == Motion::Rotation) {
            pose.rotate(Eigen::AngleAxisd(amount, axis));
        } else {
            pose.translate(amount * axis);
        }
    }
    return pose;
}

TEST(MakeScene, HasTheRobotsFlangeWhereItIs) {
    const Campaign campaign = campaign_in_cell();
    const Parameters truth = draw_truth(campaign, 3);
    const Scene scene = make_scene(campaign, truth);
    EXPECT_EQ(scene.robot.parameter_count(), 0);
    const RowMatrixXd configurations = detail::random_configurations(campaign.robot, 5, 1);
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        EXPECT_TRUE(
            world_from_flange(scene, q).isApprox(world_from_flange(campaign, truth, q), 1e-12));
        VectorXd with_torque(7);
        with_torque << q, 12.5;
        EXPECT_TRUE(world_from_flange(scene, with_torque).isApprox(world_from_flange(scene, q), 0));
    }
    ASSERT_EQ(scene.targets.size(), 3U);
    EXPECT_EQ(scene.targets[2].name, "target3");
    EXPECT_TRUE(scene.targets[2].position.isApprox(truth.sensor.tail<3>()));
    const auto does_nothing = [](const Element& one) {
        return one.value == 0 && one.joints.empty();
    };
    const Chain nominal = make_scene(campaign).robot;
    EXPECT_EQ(std::ranges::count_if(nominal.elements(), does_nothing), 0);
    EXPECT_LT(nominal.elements().size(), campaign.robot.elements().size());
}

TEST(MakeScene, FixesLinksToTheirFrames) {
    const Campaign campaign = campaign_in_cell();
    const Parameters truth = draw_truth(campaign, 3);
    const Scene scene = make_scene(campaign, truth);
    const VectorXd q = detail::random_configurations(campaign.robot, 1, 4).row(0).transpose();
    const auto frames = campaign.robot.base_from_links(q, truth.robot);
    const std::vector<Link>& links = campaign.cell.links;
    ASSERT_GE(scene.capsules.size(), links.size());
    for (std::size_t k = 0; k < links.size(); ++k) {
        const SceneCapsule& capsule = scene.capsules[k];
        EXPECT_EQ(capsule.name, links[k].name);
        EXPECT_FALSE(capsule.is_obstacle);
        const Vector3d expected =
            frames[static_cast<std::size_t>(links[k].frame)] * links[k].solid.to;
        const Vector3d drawn =
            base_from_element(scene.robot, capsule.after_element, q) * capsule.solid.to;
        EXPECT_LT((drawn - expected).norm(), 1e-12) << capsule.name;
    }
}

TEST(MakeScene, HasTheCellInTheWorld) {
    const Campaign campaign = campaign_in_cell();
    const Scene scene = make_scene(campaign);
    EXPECT_NEAR(scene.floor_z.value(), -1.27, 1e-12);
    ASSERT_EQ(scene.walls.size(), 1U);
    EXPECT_NEAR(scene.walls[0].point.y(), -3.7, 1e-12);
    EXPECT_NEAR(scene.walls[0].normal.y(), 1, 1e-12);
    ASSERT_EQ(scene.boxes.size(), 2U);
    EXPECT_EQ(scene.boxes[0].name, "table");
    EXPECT_TRUE(scene.boxes[0].is_obstacle);
    EXPECT_FALSE(scene.boxes[1].is_obstacle) << "targets shall be there";
    const Box table = std::get<Box>(campaign.cell.keep_outs[2].solid);
    const Vector3d corner = scene.boxes[0].world_from_box * (scene.boxes[0].size / 2);
    EXPECT_TRUE(corner.isApprox(campaign.nominal.world_from_base * table.upper, 1e-12));
    const SceneCapsule& sphere = scene.capsules.back();
    EXPECT_TRUE(sphere.is_obstacle);
    EXPECT_EQ(sphere.solid.from, sphere.solid.to);
    EXPECT_EQ(sphere.after_element, 0);

    Campaign tilted = campaign;  // by 2 deg: no level floor
    tilted.nominal.world_from_base.rotate(Eigen::AngleAxisd(0.035, Vector3d::UnitX()));
    EXPECT_FALSE(make_scene(tilted).floor_z);
    EXPECT_EQ(make_scene(tilted).walls.size(), 2U);
}

TEST(MakeScene, HasTheBaseWhereItWasMeasured) {
    Campaign campaign = cell_campaign();
    Simulation simulation = simulate(campaign, {.pose_count = 8});
    campaign.nominal.world_from_base.setIdentity();
    const Vector3d measured =
        make_scene(campaign, &simulation.measurements).world_from_base.translation();
    EXPECT_LT((measured - simulation.truth.world_from_base.translation()).norm(), 0.02);
    const Measurements one = take(simulation.measurements, {0});  // which tells no base
    EXPECT_TRUE(make_scene(campaign, &one).world_from_base.isApprox(Isometry3d::Identity(), 0));
}

TEST(InstrumentPosition, IsKnownOfTrackers) {
    Campaign campaign = cell_campaign();
    EXPECT_FALSE(instrument_position(campaign));
    EXPECT_FALSE(make_scene(campaign).instrument);
    campaign.cell.sight = Sight{};
    EXPECT_EQ(instrument_position(campaign).value(), Vector3d::Zero());
    const Vector3d place(1, 2, 3);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt),
                                      LaserTrackerNoise{1e-5, 1e-5, place});
    EXPECT_EQ(instrument_position(campaign).value(), place);
    EXPECT_EQ(make_scene(campaign).instrument->position, place);
}

TEST(ReadingNames, AreThoseOfTargets) {
    EXPECT_EQ(reading_names(cell_campaign()),
              (std::vector<std::string>{"target1", "target2", "target3"}));
}

TEST(MakeScene, HasCamerasAndBoard) {
    const Campaign points = tracked_campaign(fanuc());
    EXPECT_FALSE(make_scene(points).views);
    CameraSetup setup = three_cameras();
    setup.others[1].image.reset();
    const Campaign campaign = before_camera(points, setup);
    const auto& sensor = dynamic_cast<const CameraSensor&>(*campaign.sensor);
    const Scene scene = make_scene(campaign);
    ASSERT_TRUE(scene.views);
    const SceneViews& views = *scene.views;
    EXPECT_FALSE(views.is_camera_on_flange);
    const VectorXd& unknowns = campaign.nominal.sensor;
    EXPECT_TRUE(views.flange_from_it.isApprox(sensor.place(unknowns)));
    ASSERT_EQ(views.cameras.size(), 3U);
    EXPECT_TRUE(views.cameras[2].in_first.isApprox(sensor.placed(2, unknowns).in_first));
    EXPECT_EQ(views.corners, setup.corners);
    // Edges of the image by a pinhole; without a size it is centred.
    const Intrinsics pinhole{1210, 1190, 655, 470, Distortion::None, {}};
    const auto& seen = views.cameras[0].window;
    EXPECT_TRUE(project(pinhole, {seen[0], seen[1], 1}).isZero(1e-9));
    EXPECT_TRUE(project(pinhole, {seen[2], seen[3], 1}).isApprox(*setup.image));
    const auto& centred = views.cameras[2].window;
    EXPECT_DOUBLE_EQ(centred[0], -centred[2]);
    EXPECT_DOUBLE_EQ(centred[1], -centred[3]);
    setup = camera_on_flange();
    setup.intrinsics.fx = 0;
    const Scene unsure = make_scene(before_camera(points, setup));
    EXPECT_TRUE(unsure.views->is_camera_on_flange);
    EXPECT_EQ(unsure.views->cameras[0].window, (std::array<double, 4>{-0.5, -0.5, 0.5, 0.5}));
}

}  // namespace
}  // namespace posewise
