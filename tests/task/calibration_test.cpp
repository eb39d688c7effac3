#include "posewise/task/calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <stdexcept>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/sensors.hpp"

namespace posewise {

std::atomic<int> registrations{0};

// The linker sends calls of register_base_and_targets() here (--wrap, see CMakeLists.txt).
Registration real_registration(const Campaign& campaign, const Measurements& measurements) asm(
    "__real__ZN8posewise25register_base_and_targetsERKNS_8CampaignERKNS_12MeasurementsE");
Registration counted_registration(const Campaign& campaign, const Measurements& measurements) asm(
    "__wrap__ZN8posewise25register_base_and_targetsERKNS_8CampaignERKNS_12MeasurementsE");

Registration counted_registration(const Campaign& campaign, const Measurements& measurements) {
    ++registrations;
    return real_registration(campaign, measurements);
}

namespace {

struct Example {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    Measurements measurements;

    explicit Example(Index poses = 16) {
        measurements = simulate(campaign, {.pose_count = poses, .repeats = 2}).measurements;
    }
};

TEST(Calibrate, LearnsSizesOfErrorsWhereTheyArePriors) {
    Example example;
    CalibrationOptions options;
    options.folds = 0;
    EXPECT_FALSE(calibrate(example.campaign, example.measurements, options).stated_spread);
    example.campaign.spread.is_prior = true;
    const Calibration result = calibrate(example.campaign, example.measurements, options);
    ASSERT_TRUE(result.stated_spread.has_value());
    EXPECT_EQ(result.stated_spread->angle, example.campaign.spread.angle);
    EXPECT_NE(result.campaign.spread.angle, example.campaign.spread.angle);
    example.campaign.spread.is_open = false;
    EXPECT_FALSE(calibrate(example.campaign, example.measurements, options).stated_spread);
}

TEST(DefaultFolds, HoldNothingOutOfOneConfiguration) {
    EXPECT_EQ(default_folds(1), 0);
    EXPECT_EQ(default_folds(2), 2);
    EXPECT_EQ(default_folds(100), 100);
    EXPECT_EQ(default_folds(101), 10);
}

TEST(Calibrate, RegistersOnce) {
    const Example example;
    for (const bool with_models : {false, true}) {
        registrations = 0;
        CalibrationOptions options;
        options.model_selection = with_models;
        const Calibration result = calibrate(example.campaign, example.measurements, options);
        EXPECT_TRUE(result.is_identified());
        EXPECT_TRUE(result.held_out.has_value());
        EXPECT_EQ(registrations, 1);
    }
}

TEST(Calibrate, HoldsWhatItsPartsFind) {
    const Example example;
    const Calibration result = calibrate(example.campaign, example.measurements);
    const Registration registered =
        register_base_and_targets(example.campaign, example.measurements);
    const Estimate estimate =
        identify(example.campaign, example.measurements, registered.parameters);
    EXPECT_EQ(result.estimate.parameters.robot, estimate.parameters.robot);
    EXPECT_EQ(result.estimate.covariance, estimate.covariance);
    const CrossValidation held_out =
        cross_validate(example.campaign, example.measurements, estimate.parameters, 16);
    ASSERT_TRUE(result.held_out.has_value());
    EXPECT_EQ(result.held_out->samples.distance_rms, held_out.samples.distance_rms);
    EXPECT_GT(result.nominal.distance_rms, 2 * result.estimate.fit.distance_rms);
    EXPECT_NEAR(result.repeatability->length, 5e-5, 1e-5);
    EXPECT_EQ(result.measured.configurations, 16);
    EXPECT_EQ(result.measured.samples, 32);
    EXPECT_FALSE(result.doubts.misfit.has_value());
    EXPECT_TRUE(result.doubts.sizes.empty());
    EXPECT_FALSE(result.left_out || result.validation || result.selection);
}

TEST(Calibrate, IsJudgedOnWhatItDidNotUse) {
    const Example example(24);
    const Example fresh(10);
    CalibrationOptions options;
    options.folds = 0;
    for (Index i = 0; i < 18; ++i) options.used.push_back(i);
    options.validation = &fresh.measurements;
    const Calibration result = calibrate(example.campaign, example.measurements, options);
    EXPECT_FALSE(result.held_out.has_value());
    EXPECT_EQ(result.measured.configurations, 18);
    EXPECT_EQ(result.left_out->found.point_count, 6 * 2 * 3);
    EXPECT_EQ(result.validation->found.point_count, 10 * 2 * 3);
    EXPECT_GT(result.left_out->found.distance_rms, result.estimate.fit.distance_rms);
}

TEST(Calibrate, PredictsWhatASingleReadingElsewhereWouldFind) {
    const Example example;
    const Measurements fresh =
        simulate(example.campaign, {.pose_count = 30, .seed = 9}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    options.predicted = fresh.configurations;
    options.validation = &fresh;
    const Calibration result = calibrate(example.campaign, example.measurements, options);
    ASSERT_EQ(result.predicted.size(), 1U);
    const ErrorPrediction& prediction = result.predicted.front();
    EXPECT_FALSE(prediction.is_angle);
    EXPECT_EQ(prediction.overall.total(), result.validation->expected->total());
    ASSERT_EQ(prediction.each.size(), 30U);
    double squares = 0;
    double most = 0;
    double least = 1;
    for (const PredictedError& each : prediction.each) {
        squares += each.total() * each.total() / 30;
        most = std::max(most, each.parameters);
        least = std::min(least, each.parameters);
        EXPECT_GT(each.percentile95, 1.4 * each.total());  // three equal coordinates: 1.61
        EXPECT_LT(each.percentile95, 2 * each.total());    // a single one: 1.96
    }
    EXPECT_NEAR(std::sqrt(squares), prediction.overall.total(), 1e-12);
    EXPECT_GT(most, 1.5 * least);
    options.predicted = RowMatrixXd::Zero(1, 5);
    EXPECT_THROW(calibrate(example.campaign, example.measurements, options), InputError);
}

TEST(Calibrate, ExpectsMoreOverTheWorkspaceThanAtPosesOfASmallPartOfIt) {
    const Example example(24);
    const auto ratio = [&](const Measurements& measurements) {
        CalibrationOptions options;
        options.folds = 0;
        const Calibration result = calibrate(example.campaign, measurements, options);
        return result.expected_workspace.value().parameters / result.expected.parameters;
    };
    EXPECT_GT(ratio(example.measurements), 0.5);
    EXPECT_LT(ratio(example.measurements), 2);
    RowMatrixXd near = 0.3 * example.measurements.configurations;
    EXPECT_GT(ratio(simulate(example.campaign, near, Seen::Ones(24, 3), {}).measurements), 3);
}

TEST(Calibrate, PredictsLengthsAndAnglesOfFullPoses) {
    for (const auto& [name, campaign] : testing::campaigns_of_every_sensor(testing::ur_type())) {
        SCOPED_TRACE(name);
        const Sensor& sensor = *campaign.sensor;
        if (sensor.has_pixels()) continue;  // they follow from a motion of the flange
        Estimate estimate;
        estimate.parameters = campaign.nominal;
        const Index size = parameter_count(campaign);
        estimate.covariance = MatrixXd::Zero(size, size);
        estimate.variance_factor = 4;
        estimate.model_error = 3e-3;
        estimate.model_error_orientation = 5e-3;
        const RowMatrixXd poses = simulate(campaign, {.pose_count = 2}).measurements.configurations;
        const auto predictions = predict_errors(campaign, estimate, poses);
        for (const ErrorPrediction& one : predictions) {
            // Of several instruments the mean over the targets that have any.
            double coordinates = 0;
            std::set<Index> targets;
            for (Index row = 0; row < sensor.row_count(); ++row) {
                if (sensor.is_angle(row) != one.is_angle) continue;
                ++coordinates;
                targets.insert(sensor.target_of(row));
            }
            coordinates /= static_cast<double>(targets.size());
            EXPECT_EQ(one.overall.parameters, 0);
            EXPECT_NEAR(one.overall.model,
                        2 * std::sqrt(coordinates) * (one.is_angle ? 5e-3 : 3e-3), 1e-12);
        }
        EXPECT_EQ(predictions.size(), sensor.has_lengths() && sensor.has_angles() ? 2U : 1U);
    }
}

TEST(Calibrate, PredictsWhat95PercentAreBelow) {
    const Campaign campaign = testing::tracked_campaign(testing::fanuc());
    // Of 39 degrees of freedom: with chi squared instead of F it is 92 %.
    Index below = 0;
    Index count = 0;
    for (std::uint64_t run = 1; run <= 200; ++run) {
        const Simulation simulated =
            simulate(campaign, {.pose_count = 8, .truth_seed = run, .seed = run});
        const Measurements fresh =
            simulate(campaign, {.pose_count = 10, .truth_seed = run, .seed = 100 + run})
                .measurements;
        CalibrationOptions options;
        options.folds = 0;
        options.predicted = fresh.configurations;
        const Calibration result = calibrate(campaign, simulated.measurements, options);
        const RowMatrixXd squares = squared_distances(campaign, result.estimate.parameters, fresh);
        for (Index i = 0; i < squares.rows(); ++i) {
            const double limit =
                result.predicted.front().each[static_cast<std::size_t>(i)].percentile95;
            below += (squares.row(i).array() < limit * limit).count();
            count += squares.cols();
        }
    }
    const double share = static_cast<double>(below) / static_cast<double>(count);
    EXPECT_GT(share, 0.935);
    EXPECT_LT(share, 0.965);
}

TEST(Calibrate, SaysWhatIsNotIdentifiable) {
    const Example few(3);
    const Calibration result = calibrate(few.campaign, few.measurements);
    EXPECT_FALSE(result.is_identified());
    EXPECT_EQ(result.estimate.undetermined,
              "3 configurations give 27 equations, 33 parameters need at least as many");
    Example hidden;
    hidden.measurements.is_seen.col(1).setConstant(false);
    EXPECT_EQ(calibrate(hidden.campaign, hidden.measurements)
                  .estimate.undetermined.find("target 2 is seen in no sample"),
              0U);
}

TEST(Calibrate, TellsHowFarItIsAndPassesOnWhatTheCallbackThrows) {
    const Example example;
    CalibrationOptions options;
    options.folds = 4;
    Index last = 0;
    options.progress = [&](const Progress& progress) {
        EXPECT_EQ(progress.done, last + 1);
        EXPECT_EQ(progress.total, 5);
        last = progress.done;
    };
    calibrate(example.campaign, example.measurements, options);
    EXPECT_EQ(last, 5);
    options.progress = [](const Progress&) { throw std::domain_error("enough"); };
    EXPECT_THROW(calibrate(example.campaign, example.measurements, options), std::domain_error);
}

TEST(Calibrate, StoppedEndsWithTheBestSoFar) {
    const Example example;
    const std::atomic<bool> now{true};
    for (const auto method : {CalibrationMethod::Joint, CalibrationMethod::TwoStep}) {
        CalibrationOptions options;
        options.method = method;
        options.stop.interrupted = &now;
        const Calibration result = calibrate(example.campaign, example.measurements, options);
        EXPECT_EQ(result.estimate.ending, Ending::Interrupted);
        EXPECT_GT(result.estimate.fit.point_count, 0);
        EXPECT_FALSE(result.held_out.has_value());
    }
}

TEST(Calibrate, RefusesOptionsThatContradictEachOther) {
    const Example example;
    CalibrationOptions options;
    options.method = CalibrationMethod::TwoStep;
    options.joint.loss.kind = LossKind::Cauchy;
    EXPECT_THROW(calibrate(example.campaign, example.measurements, options), InputError);
    options = {};
    options.model_selection = true;
    options.folds = 0;
    EXPECT_THROW(calibrate(example.campaign, example.measurements, options), InputError);
    options = {};
    options.folds = 17;
    EXPECT_THROW(calibrate(example.campaign, example.measurements, options), InputError);
}

}  // namespace
}  // namespace posewise
