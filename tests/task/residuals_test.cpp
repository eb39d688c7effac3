#include <gtest/gtest.h>

#include <cmath>

#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/scene.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

class ListResiduals : public ::testing::Test {
  protected:
    ListResiduals() {
        measurements_ = simulate(campaign_, {.pose_count = 14, .repeats = 2}).measurements;
        testing::hide_at_random(measurements_, 0.1, 5);
    }
    double rms(const std::vector<ReadingResidual>& readings,
               VectorXd ReadingResidual::*part) const {
        double sum = 0;
        for (const ReadingResidual& one : readings) sum += (one.*part).squaredNorm();
        return std::sqrt(sum / static_cast<double>(readings.size()));
    }

    Campaign campaign_ = testing::tracked_campaign(testing::fanuc());
    Measurements measurements_;
};

TEST_F(ListResiduals, AreThoseOfTheCalibration) {
    const Calibration found = calibrate(campaign_, measurements_);
    const auto readings = list_residuals(found, measurements_);
    ASSERT_EQ(static_cast<Index>(readings.size()), measurements_.is_seen.count());
    EXPECT_NEAR(rms(readings, &ReadingResidual::calibrated), found.estimate.fit.distance_rms,
                1e-15);
    EXPECT_NEAR(rms(readings, &ReadingResidual::nominal), found.nominal.distance_rms, 1e-15);
    double held_out = 0;
    for (const ReadingResidual& one : readings) {
        held_out += one.held_out.value().squaredNorm();
        EXPECT_TRUE(measurements_.is_seen(one.sample, one.target));
        const Index first = measurements_.first_sample[static_cast<std::size_t>(one.configuration)];
        EXPECT_TRUE(one.sample >= first && one.sample < first + 2);
        EXPECT_FALSE(one.direction);
    }
    EXPECT_NEAR(std::sqrt(held_out / static_cast<double>(readings.size())),
                found.held_out->samples.distance_rms, 1e-15);

    // Judged again from what is kept, nothing differs.
    const auto again = list_residuals(found.campaign, found.estimate, measurements_, {{}, 14});
    ASSERT_EQ(again.size(), readings.size());
    for (std::size_t k = 0; k < again.size(); ++k) {
        EXPECT_EQ(again[k].calibrated, readings[k].calibrated);
        EXPECT_EQ(again[k].nominal, readings[k].nominal);
        EXPECT_EQ(again[k].held_out, readings[k].held_out);
        EXPECT_EQ(again[k].standardised, readings[k].standardised);
    }
    EXPECT_FALSE(list_residuals(found.campaign, found.estimate, measurements_).front().held_out);
}

/// Over many robots the squares of standardised residuals are 1 on average, also where the
/// parameters take up a large part of the readings.
TEST_F(ListResiduals, AreStandardisedByWhatIsExpectedOfThem) {
    double sum = 0;
    Index count = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Measurements measured =
            simulate(campaign_, {.pose_count = 12, .repeats = 2, .truth_seed = seed, .seed = seed})
                .measurements;
        CalibrationOptions options;
        options.folds = 0;
        for (const ReadingResidual& one :
             list_residuals(calibrate(campaign_, measured, options), measured)) {
            sum += one.standardised.squaredNorm();
            count += one.standardised.size();
        }
    }
    EXPECT_NEAR(sum / static_cast<double>(count), 1, 0.05);
}

TEST_F(ListResiduals, SayWhereTheTrackerSawThem) {
    const Vector3d place(0.5, -0.25, 0.125);
    campaign_.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt),
                                      LaserTrackerNoise{1e-5, 1e-5, place});
    CalibrationOptions options;
    options.folds = 0;
    const Calibration found = calibrate(campaign_, measurements_, options);
    for (const ReadingResidual& one : list_residuals(found, measurements_)) {
        const Vector3d seen = measurements_.observation(one.sample, one.target).transpose();
        const auto [range, azimuth, elevation] = one.direction.value();
        const Vector3d told =
            place + range * Vector3d(std::cos(elevation) * std::cos(azimuth),
                                     std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        EXPECT_LT((told - (seen - one.calibrated)).norm(), 1e-9);
    }
}

TEST_F(ListResiduals, HaveAxes) {
    EXPECT_EQ(residual_axes(campaign_), (std::vector<std::string>{"x", "y", "z"}));
    for (const auto& [name, other] : testing::campaigns_of_every_sensor(testing::fanuc())) {
        const Sensor& sensor = *other.sensor;
        EXPECT_EQ(std::ssize(residual_axes(other)), sensor.rows_per_target()) << name;
        EXPECT_EQ(std::ssize(reading_names(other)), sensor.target_count()) << name;
    }
}

}  // namespace
}  // namespace posewise
