#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/parameter_error.hpp"

/// Calibration from measurements that do not show every target in every sample.
namespace posewise {
namespace {

using namespace detail;

using testing::error_of;
using testing::hide_at_random;
using testing::tracked_campaign;

/// FANUC and three unknown targets; tracker and joints make the noise differ and correlate.
Campaign tracker_campaign() {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{4e-5, 3e-5});
    campaign.joint_repeatability = VectorXd::Constant(6, 1e-5);
    campaign.model_error = 5e-5;
    return campaign;
}

Measurements simulate_with_gaps(const Campaign& campaign, const Parameters& truth, Index poses,
                                Index repeats, std::uint64_t seed) {
    Measurements measurements = simulate_measurements(
        campaign, truth, random_configurations(campaign.robot, poses, 4), repeats, seed);
    hide_at_random(measurements, 0.3, seed);
    return measurements;
}

Estimate identify_registered(const Campaign& campaign, const Measurements& measurements) {
    return identify(campaign, measurements,
                    register_base_and_targets(campaign, measurements).parameters);
}

/// What the registration says is not determined.
std::string what_is_missing(const Campaign& campaign, const Measurements& measurements) {
    return register_base_and_targets(campaign, measurements).undetermined;
}

TEST(MissingTargets, ExactMeasurementsGiveTheTruth) {
    Campaign exact = tracked_campaign(testing::fanuc());
    exact.model_error = 0;
    exact.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-14);
    const Parameters truth = draw_truth(exact, 3);
    const Estimate estimate =
        identify_registered(tracker_campaign(), simulate_with_gaps(exact, truth, 24, 2, 5));
    EXPECT_EQ(estimate.ending, Ending::Converged);
    EXPECT_LT(error_of(estimate.parameters, truth).norm(), 1e-10);
}

TEST(MissingTargets, CovarianceIsThatOfManySimulatedCalibrations) {
    const Campaign campaign = tracker_campaign();
    const Parameters truth = draw_truth(campaign, 3);
    const int runs = 300;
    double mahalanobis = 0;
    double chi_square = 0;
    double freedom = 0;
    for (int run = 0; run < runs; ++run) {
        const auto measurements =
            simulate_with_gaps(campaign, truth, 24, 2, 1000 + static_cast<std::uint64_t>(run));
        const Estimate estimate = identify(campaign, measurements, truth);
        const MatrixXd covariance = estimate.covariance / estimate.variance_factor;
        const VectorXd error = error_of(estimate.parameters, truth);
        mahalanobis += error.dot(covariance.ldlt().solve(error));
        EXPECT_EQ(estimate.degrees_of_freedom, 3 * estimate.fit_means.point_count - 33);
        EXPECT_EQ(estimate.fit.point_count, measurements.is_seen.count());
        freedom += static_cast<double>(estimate.degrees_of_freedom);
        chi_square += estimate.variance_factor * static_cast<double>(estimate.degrees_of_freedom);
    }
    EXPECT_LT(freedom / runs, 24 * 9 - 33);
    // chi^2 with 33 degrees of freedom: mean 33, standard deviation sqrt(66) a run.
    EXPECT_NEAR(mahalanobis / runs, 33, 4 * std::sqrt(66.0 / runs));
    EXPECT_NEAR(chi_square / freedom, 1, 4 * std::sqrt(2 / freedom));
}

TEST(MissingTargets, ADroppedTargetIsOneOfWeightZero) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    const Parameters truth = draw_truth(campaign, 3);
    Measurements measurements =
        simulate_measurements(campaign, truth, random_configurations(campaign.robot, 20, 4), 1, 5);
    measurements.is_seen(7, 1) = false;
    measurements.observations.row(7).segment<3>(3).setConstant(99);
    const Estimate estimate = identify_registered(campaign, measurements);

    // The normal equations of all rows, written out: at the optimum J^T W r = 0.
    VectorXd weights = VectorXd::Constant(180, 1 / (5e-5 * 5e-5 + 1e-4 * 1e-4));
    weights.segment<3>(7 * 9 + 3).setZero();
    const RowMatrixXd J =
        make_plain_blocks(campaign, estimate.parameters, measurements.configurations).matrix;
    VectorXd r(180);
    for (Index i = 0; i < 20; ++i) {
        const VectorXd q = measurements.configurations.row(i).transpose();
        r.segment<9>(9 * i) =
            measurements.observations.row(i).transpose() -
            campaign.sensor->predict(world_from_flange(campaign, estimate.parameters, q),
                                     estimate.parameters.sensor);
    }
    const MatrixXd M = J.transpose() * weights.asDiagonal() * J;
    const VectorXd step = M.ldlt().solve(J.transpose() * weights.asDiagonal() * r);
    const VectorXd sigma = standard_deviations(estimate);
    EXPECT_LT(step.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_EQ(estimate.degrees_of_freedom, 177 - 33);
    const double factor = r.dot(weights.asDiagonal() * r) / (177 - 33);
    EXPECT_NEAR(estimate.variance_factor, factor, 1e-10 * factor);
    const MatrixXd covariance = factor * M.ldlt().solve(MatrixXd::Identity(33, 33));
    const MatrixXd difference = sigma.cwiseInverse().asDiagonal() *
                                (covariance - estimate.covariance) *
                                sigma.cwiseInverse().asDiagonal();
    EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-6);
}

TEST(MissingTargets, WhatStandsInTheirPlaceDoesNotMatter) {
    const Campaign campaign = tracker_campaign();
    const auto with_nan = simulate_with_gaps(campaign, draw_truth(campaign, 3), 14, 3, 5);
    Measurements with_numbers = with_nan;
    with_numbers.observations =
        with_nan.observations.array().isNaN().select(1e6, with_nan.observations);
    const Estimate a = identify_registered(campaign, with_nan);
    const Estimate b = identify_registered(campaign, with_numbers);
    EXPECT_TRUE(a.covariance.allFinite());
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.parameters.sensor, b.parameters.sensor);
    EXPECT_EQ(a.fit.distance_rms, b.fit.distance_rms);
    EXPECT_EQ(a.fit_means.distance_max, b.fit_means.distance_max);
    EXPECT_EQ(repeatability(*campaign.sensor, with_nan)->length,
              repeatability(*campaign.sensor, with_numbers)->length);
    const auto held_out = [&](const Measurements& measurements) {
        return cross_validate(campaign, measurements, a.parameters, 7).samples.distance_rms;
    };
    EXPECT_TRUE(std::isfinite(held_out(with_nan)));
    EXPECT_EQ(held_out(with_nan), held_out(with_numbers));
}

TEST(MissingTargets, LeaveOneOutPredictsEveryPointThatWasSeen) {
    const Campaign campaign = tracker_campaign();
    const auto measurements = simulate_with_gaps(campaign, draw_truth(campaign, 3), 16, 2, 5);
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const CrossValidation held_out = cross_validate(campaign, measurements, start, 16);
    EXPECT_TRUE(held_out.failures.empty());
    EXPECT_EQ(held_out.samples.point_count, measurements.is_seen.count());
    EXPECT_EQ(held_out.means.point_count, (times_seen(measurements).array() > 0).count());
    double sum = 0;
    for (Index i = 0; i < 16; ++i) {
        const Estimate without = identify(campaign, take(measurements, all_but(16, {i})), start);
        const Measurements one = take(measurements, {i});
        const Isometry3d flange =
            world_from_flange(campaign, without.parameters, one.configurations.row(0).transpose());
        for (Index sample = 0; sample < 2; ++sample) {
            for (Index target = 0; target < 3; ++target) {
                if (!one.is_seen(sample, target)) continue;
                const Vector3d predicted =
                    flange * without.parameters.sensor.segment<3>(3 * target);
                sum += (one.observation(sample, target).transpose() - predicted).squaredNorm();
            }
        }
    }
    EXPECT_NEAR(held_out.samples.distance_rms,
                std::sqrt(sum / static_cast<double>(measurements.is_seen.count())), 1e-12);
}

TEST(MissingTargets, AFoldThatNeverSeesATargetIsNamed) {
    const Campaign campaign = tracker_campaign();
    Measurements measurements = simulate_measurements(
        campaign, campaign.nominal, random_configurations(campaign.robot, 16, 4), 1, 5);
    measurements.is_seen.col(2).setConstant(false);
    measurements.is_seen(4, 2) = true;
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const CrossValidation held_out = cross_validate(campaign, measurements, start, 16);
    ASSERT_EQ(held_out.failures.size(), 1U);
    EXPECT_EQ(held_out.failures[0].rfind("fold 5: target 3 is seen in no sample of these 15", 0),
              0U)
        << held_out.failures[0];
    EXPECT_EQ(held_out.samples.point_count, 15 * 2);
}

TEST(MissingTargets, ATargetThatIsNeverSeenIsNamed) {
    Campaign campaign = tracker_campaign();
    Measurements measurements = simulate_measurements(
        campaign, campaign.nominal, random_configurations(campaign.robot, 16, 4), 1, 5);
    measurements.is_seen.col(1).setConstant(false);
    EXPECT_EQ(what_is_missing(campaign, measurements),
              "target 2 is seen in no sample of these 16 configurations, so its position cannot be "
              "found; measure it, or leave it out of the campaign's targets");
    EXPECT_EQ(identify(campaign, measurements, campaign.nominal).ending, Ending::NotIdentifiable);

    // One whose position is known is not needed.
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>{std::nullopt, Vector3d(0.3, -0.09, 0.06),
                                             std::nullopt},
        5e-5);
    EXPECT_EQ(what_is_missing(campaign, measurements), "");
}

TEST(MissingTargets, TooFewPointsAreRefusedWithTheirNumber) {
    const Campaign campaign = tracker_campaign();
    Measurements measurements = simulate_measurements(
        campaign, campaign.nominal, random_configurations(campaign.robot, 6, 4), 1, 5);
    measurements.is_seen.setConstant(false);
    for (Index i = 0; i < 6; ++i) measurements.is_seen(i, i % 3) = true;
    EXPECT_NE(what_is_missing(campaign, measurements)
                  .find("these 6 configurations with 6 points do not determine base and targets"),
              std::string::npos);
    EXPECT_EQ(identify(campaign, measurements, campaign.nominal).undetermined,
              "6 configurations give 18 equations, 33 parameters need at least as many");
    measurements.is_seen.resize(6, 2);
    EXPECT_THROW(identify(campaign, measurements, campaign.nominal), InputError);
}

TEST(MissingTargets, RegistrationTakesConfigurationsThatShowOneTargetEach) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.model_error = 0;
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-12);
    Measurements measurements = simulate_measurements(
        campaign, campaign.nominal, random_configurations(campaign.robot, 30, 4), 1, 5);
    measurements.is_seen.setConstant(false);
    for (Index i = 0; i < 30; ++i) measurements.is_seen(i, i % 3) = true;
    const Parameters found = register_base_and_targets(campaign, measurements).parameters;
    EXPECT_LT(error_of(found, campaign.nominal).norm(), 1e-9);
}

TEST(MissingTargets, TwoStepsHeadToTheSameOptimum) {
    const Campaign campaign = tracker_campaign();
    const auto measurements = simulate_with_gaps(campaign, draw_truth(campaign, 3), 24, 2, 5);
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const Estimate joint = identify(campaign, measurements, start);
    const Estimate rough = identify_two_step(campaign, measurements, start, {5});
    const Estimate finer = identify_two_step(campaign, measurements, start, {50});
    EXPECT_LT(finer.variance_factor, rough.variance_factor);
    EXPECT_GE(finer.variance_factor, joint.variance_factor);
    const Estimate from_optimum = identify_two_step(campaign, measurements, joint.parameters);
    EXPECT_NEAR(from_optimum.variance_factor, joint.variance_factor, 1e-9);
}

}  // namespace
}  // namespace posewise
