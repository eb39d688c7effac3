#include <gtest/gtest.h>

#include <numeric>

#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/planning.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

using namespace testing;

/// Two samples of nothing, to put corners in.
Measurements unseen(const Sensor& sensor) {
    Measurements measured;
    measured.observations = RowMatrixXd::Zero(2, sensor.row_count());
    measured.is_seen = Seen::Constant(2, sensor.target_count(), false);
    return measured;
}

void see(Measurements& measured, Index sample, Index target, double u, double v) {
    measured.is_seen(sample, target) = true;
    measured.observations.row(sample).segment<2>(2 * target) << 1e-3 * u, 1e-3 * v;
}

TEST(FindImageCoverage, CountsCornersInCellsAndNamesEmptyZones) {
    const CameraSensor sensor(fixed_camera());  // 1280 x 960 px
    Measurements measured = unseen(sensor);
    see(measured, 0, 0, 0, 0);
    see(measured, 1, 0, 1280, 960);  // the edge belongs to the image
    see(measured, 0, 1, 159, 161);
    see(measured, 1, 1, 640, 480);
    see(measured, 1, 2, 650, 490);
    const auto images = find_image_coverage(sensor, measured);
    ASSERT_EQ(images.size(), 1U);
    const ImageCoverage& image = images.front();
    EXPECT_EQ(image.camera, 0);
    EXPECT_EQ(image.size, (std::array<double, 2>{1280, 960}));
    EXPECT_EQ(image.columns, 8);
    EXPECT_EQ(image.rows, 6);
    std::vector<Index> counts(48, 0);
    counts[0] = counts[8] = counts[47] = 1;
    counts[3 * 8 + 4] = 2;
    EXPECT_EQ(image.counts, counts);
    EXPECT_DOUBLE_EQ(image.part, 4.0 / 48);
    EXPECT_EQ(image.empty, (std::vector<std::string>{"top", "top right", "left", "right",
                                                     "bottom left", "bottom"}));
}

TEST(FindImageCoverage, IsOfEachCameraWhoseImageHasASize) {
    CameraSetup setup = three_cameras();
    setup.image.reset();
    setup.others[1].image = Vector2d(600, 800);  // upright
    const CameraSensor sensor(setup);
    Measurements measured = unseen(sensor);
    const Index corners = sensor.corner_count();
    see(measured, 0, 1, 100, 100);
    see(measured, 0, corners, 100, 100);
    for (Index k = 0; k < corners; ++k) see(measured, 1, 2 * corners + k, 599, 799);
    const auto images = find_image_coverage(sensor, measured);
    ASSERT_EQ(images.size(), 2U);
    EXPECT_EQ(images[0].camera, 1);
    EXPECT_EQ(images[0].counts[0], 1);
    EXPECT_EQ(images[1].camera, 2);
    EXPECT_EQ(images[1].columns, 6);
    EXPECT_EQ(images[1].rows, 8);
    EXPECT_EQ(images[1].counts[47], corners);
    EXPECT_EQ(images[1].empty.size(), 8U);
    const Campaign points = tracked_campaign(fanuc());
    EXPECT_TRUE(find_image_coverage(*points.sensor, unseen(*points.sensor)).empty());
}

TEST(ExpectedReadings, AreTheCornersThatEachPoseShows) {
    const Campaign campaign = before_camera(tracked_campaign(fanuc()), camera_on_flange());
    const Sensor& sensor = *campaign.sensor;
    const Measurements seen = simulate(campaign, {.pose_count = 2, .repeats = 1}).measurements;
    Plan plan;
    plan.poses = {{"a", seen.configurations.row(0).transpose(), 1, {}},
                  {"b", seen.configurations.row(1).transpose(), 2, {3, 5}}};
    const Measurements expected = expected_readings(campaign, plan);
    EXPECT_EQ(expected.ids, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(expected.first_sample, (std::vector<Index>{0, 1, 2}));
    EXPECT_TRUE(expected.is_seen.row(0).all());
    EXPECT_EQ(targets_seen(expected.is_seen.row(1)), (std::vector<Index>{3, 5}));
    for (Index i = 0; i < 2; ++i) {
        const VectorXd q = seen.configurations.row(i).transpose();
        EXPECT_EQ(expected.configurations.row(i).transpose(), q);
        EXPECT_EQ(expected.observations.row(i).transpose(),
                  sensor.predict(world_from_flange(campaign, campaign.nominal, q),
                                 campaign.nominal.sensor));
    }
    EXPECT_EQ(expected_readings(campaign, {}).configuration_count(), 0);
}

TEST(FindImageCoverage, IsKeptWithAPlan) {
    CameraSetup setup = fixed_camera();
    setup.view.least_corners = 6;
    const Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    PlanningOptions options;
    options.pose_count = 12;
    options.pool_count = 2000;
    options.workspace_count = 20;
    const Planning planning = make_plan(campaign, options);
    ASSERT_EQ(planning.images.size(), 1U);
    const auto again =
        find_image_coverage(*campaign.sensor, expected_readings(campaign, planning.plan));
    EXPECT_EQ(planning.images[0].counts, again[0].counts);
    EXPECT_EQ(judge_again(planning.plan, campaign, options).images[0].counts, again[0].counts);
}

TEST(FindImageCoverage, IsOfWhatWasCalibratedWith) {
    const Campaign campaign = before_camera(tracked_campaign(fanuc()), fixed_camera());
    const Measurements measured =
        simulate(campaign, {.pose_count = 30, .repeats = 1, .truth_seed = 2, .seed = 7})
            .measurements;
    CalibrationOptions options;
    options.folds = 0;
    options.used.resize(20);
    std::iota(options.used.begin(), options.used.end(), 5);
    const Calibration found = calibrate(campaign, measured, options);
    ASSERT_EQ(found.images.size(), 1U);
    const ImageCoverage& image = found.images.front();
    EXPECT_EQ(std::accumulate(image.counts.begin(), image.counts.end(), Index{0}),
              take(measured, options.used).is_seen.count());
    EXPECT_GT(image.part, 0.1);
    EXPECT_LT(image.part, find_image_coverage(*campaign.sensor, measured).front().part + 1e-12);
}

}  // namespace
}  // namespace posewise
