#include "posewise/calibrator/identification.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/parameter_error.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::error_of;
using testing::tracked_campaign;

Campaign with_sigma(double sigma) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.model_error = 0;
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), sigma);
    return campaign;
}

Estimate calibrate(const Campaign& campaign, const Measurements& measurements) {
    return identify(campaign, measurements,
                    register_base_and_targets(campaign, measurements).parameters);
}

TEST(Identify, RecoversTheTruthFromExactMeasurements) {
    const Simulation simulated = simulate(with_sigma(1e-14), {24, 1, 7, 8});
    const Estimate estimate = calibrate(with_sigma(5e-5), simulated.measurements);
    EXPECT_EQ(estimate.ending, Ending::Converged);
    EXPECT_LT(error_of(estimate.parameters, simulated.truth).norm(), 1e-10);
    EXPECT_LT(estimate.fit.distance_max, 1e-11);
}

TEST(Identify, HoldsOnPosesItHasNotSeen) {
    const Campaign campaign = with_sigma(5e-5);
    const Simulation simulated = simulate(campaign, {30, 1, 7, 8});
    const Estimate estimate = calibrate(campaign, simulated.measurements);
    const auto fresh = simulate_measurements(campaign, simulated.truth,
                                             random_configurations(campaign.robot, 200, 99), 1, 98);
    const double noise_alone = std::sqrt(3.0) * 5e-5;
    const double held_out =
        make_metrics(residuals(campaign, estimate.parameters, fresh)).distance_rms;
    const double nominal =
        make_metrics(
            residuals(campaign,
                      register_base_and_targets(campaign, simulated.measurements).parameters,
                      fresh))
            .distance_rms;
    EXPECT_GT(held_out, noise_alone);
    EXPECT_LT(held_out, 1.5 * noise_alone);
    EXPECT_GT(nominal, 10 * held_out);
}

TEST(Identify, CovarianceIsThatOfManySimulatedCalibrations) {
    const Campaign campaign = with_sigma(5e-5);
    const Parameters truth = draw_truth(campaign, 3);
    const auto configurations = random_configurations(campaign.robot, 20, 4);
    const int runs = 300;
    double mahalanobis = 0;
    double variance_factor = 0;
    for (int run = 0; run < runs; ++run) {
        const auto measurements = simulate_measurements(campaign, truth, configurations, 1,
                                                        1000 + static_cast<std::uint64_t>(run));
        const Estimate estimate = identify(campaign, measurements, truth);
        const MatrixXd covariance = estimate.covariance / estimate.variance_factor;
        const VectorXd error = error_of(estimate.parameters, truth);
        mahalanobis += error.dot(covariance.ldlt().solve(error));
        variance_factor += estimate.variance_factor;
    }
    // chi^2 with 33 degrees of freedom: mean 33, standard deviation sqrt(66) a run.
    EXPECT_NEAR(mahalanobis / runs, 33, 4 * std::sqrt(66.0 / runs));
    const double freedom = 20 * 9 - 33;
    EXPECT_NEAR(variance_factor / runs, 1, 4 * std::sqrt(2 / freedom / runs));
}

TEST(Identify, CovarianceShrinksWithRepeatsAsOneOverTheirNumber) {
    const Campaign campaign = with_sigma(5e-5);
    const Parameters truth = draw_truth(campaign, 3);
    const auto configurations = random_configurations(campaign.robot, 20, 4);
    const auto one = simulate_measurements(campaign, truth, configurations, 1, 5);
    Measurements four = one;  // the same mean, claimed to be of four observations
    four.observations.resize(80, 9);
    four.is_seen.setConstant(80, 3, true);
    four.first_sample = {0};
    for (Index i = 0; i < 20; ++i) {
        for (Index k = 0; k < 4; ++k) four.observations.row(4 * i + k) = one.observations.row(i);
        four.first_sample.push_back(4 * (i + 1));
    }
    const Estimate a = identify(campaign, one, truth);
    const Estimate b = identify(campaign, four, truth);
    EXPECT_LT((a.covariance / a.variance_factor - 4 * b.covariance / b.variance_factor).norm(),
              1e-6 * a.covariance.norm());
}

TEST(Identify, DoesNotDependOnTheOrderOfConfigurations) {
    const Campaign campaign = with_sigma(5e-5);
    const Simulation simulated = simulate(campaign, {12, 3, 1, 2});
    const auto reversed = take(simulated.measurements, {11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0});
    const Estimate a = calibrate(campaign, simulated.measurements);
    const Estimate b = calibrate(campaign, reversed);
    EXPECT_LT(error_of(a.parameters, b.parameters).norm(), 1e-9);
    EXPECT_NEAR(a.fit.distance_rms, b.fit.distance_rms, 1e-12);
}

TEST(Identify, NamesParametersThatCannotBeToldApart) {
    Campaign campaign = with_sigma(5e-5);
    std::vector<Element> elements = campaign.robot.elements();
    elements.insert(elements.begin() + 5, testing::translation(Axis::X, 0, "Tx2"));
    campaign = with_robot(campaign, Chain(campaign.robot.joints(), elements));
    const auto measurements = simulate(campaign, {24, 1, 7, 8}).measurements;
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    for (const Estimate& estimate : {identify(campaign, measurements, start),
                                     identify_two_step(campaign, measurements, start)}) {
        EXPECT_EQ(estimate.ending, Ending::NotIdentifiable);
        for (const char* name : {"dq2", "dq3", "Tx2"}) {
            EXPECT_NE(estimate.undetermined.find(name), std::string::npos) << estimate.undetermined;
        }
    }
}

TEST(Identify, WithAPriorStaysWithinItsCovarianceOnFewerEquationsThanParameters) {
    Campaign campaign = with_sigma(5e-5);
    campaign.spread.is_prior = true;
    campaign.spread.is_open = false;
    constexpr int runs = 300;
    double mahalanobis = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
        const Parameters truth = draw_truth(campaign, run);  // errors as large as the prior says
        const auto measurements = simulate_measurements(
            campaign, truth, random_configurations(campaign.robot, 3, 500 + run), 1, 900 + run);
        const Estimate estimate = identify(campaign, measurements, truth);
        const VectorXd error = error_of(estimate.parameters, truth);
        mahalanobis += error.dot(estimate.covariance.ldlt().solve(error));
    }
    EXPECT_NEAR(mahalanobis / runs, 33, 4 * std::sqrt(66.0 / runs));
}

TEST(Identify, WithAPriorTellsRedundantParametersApart) {
    Campaign campaign = with_sigma(5e-5);
    std::vector<Element> elements = campaign.robot.elements();
    elements.insert(elements.begin() + 5, testing::translation(Axis::X, 0, "Tx2"));
    const Measurements measurements = simulate(campaign, {24, 1, 7, 8}).measurements;
    const double without = calibrate(campaign, measurements).fit.distance_rms;
    campaign = with_robot(campaign, Chain(campaign.robot.joints(), elements));
    campaign.spread.is_prior = true;
    const Estimate estimate = calibrate(campaign, measurements);
    EXPECT_EQ(estimate.ending, Ending::Converged);
    EXPECT_NEAR(estimate.fit.distance_rms, without, 0.02 * without);
}

TEST(Identify, IsNotPossibleWithFewerEquationsThanParameters) {
    const Campaign campaign = with_sigma(5e-5);
    const auto measurements = simulate(campaign, {3, 1, 7, 8}).measurements;
    const Estimate estimate = identify(campaign, measurements, campaign.nominal);
    EXPECT_EQ(estimate.ending, Ending::NotIdentifiable);
    EXPECT_EQ(estimate.undetermined,
              "3 configurations give 27 equations, 33 parameters need at least as many");
}

TEST(Identify, SaysWhenIterationsRanOut) {
    const Campaign campaign = with_sigma(5e-5);
    const Simulation simulated = simulate(campaign, {12, 1, 7, 8});
    const Parameters start = register_base_and_targets(campaign, simulated.measurements).parameters;
    EXPECT_EQ(identify(campaign, simulated.measurements, start, {0, 1e-12}).ending,
              Ending::IterationLimit);
}

TEST(Identify, ConvergesWhereNoiseDependsOnThePoseAndOnePointIsGrosslyWrong) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{1e-5, 1.5e-5});
    Measurements measured = simulate(campaign, {20, 1, 7, 8}).measurements;
    for (const double error : {3e-3, 3e-2, 0.1}) {
        measured.observations(4, 1) += error;
        const Estimate estimate = calibrate(campaign, measured);
        EXPECT_EQ(estimate.ending, Ending::Converged) << error;
        const Estimate again = identify(campaign, measured, estimate.parameters);
        EXPECT_EQ(again.ending, Ending::Converged) << error;
        EXPECT_LT(error_of(again.parameters, estimate.parameters).norm(), 1e-9) << error;
    }
}

TEST(IdentifyTwoStep, HeadsToTheJointOptimumAndSaysIfItGotThere) {
    const Campaign campaign = with_sigma(5e-5);
    const auto measurements = simulate(campaign, {24, 1, 7, 8}).measurements;
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const double optimum = identify(campaign, measurements, start).fit_means.distance_rms;
    double previous = make_metrics(mean_residuals(campaign, start, measurements)).distance_rms;
    for (const Index cycles : {1, 3, 10}) {
        const Estimate estimate = identify_two_step(campaign, measurements, start, {cycles});
        EXPECT_EQ(estimate.ending, Ending::IterationLimit);
        EXPECT_LT(estimate.fit_means.distance_rms, previous);
        EXPECT_GE(estimate.fit_means.distance_rms, optimum * (1 - 1e-9));
        previous = estimate.fit_means.distance_rms;
    }
    const Estimate patient = identify_two_step(campaign, measurements, start, {20000, 1, 1e-7});
    EXPECT_EQ(patient.ending, Ending::Converged);
    EXPECT_LT(patient.fit_means.distance_rms, 1.01 * optimum);
}

TEST(IdentifyTwoStep, ReportsTheJointCovariance) {
    const Campaign campaign = with_sigma(5e-5);
    const auto measurements = simulate(campaign, {24, 1, 7, 8}).measurements;
    const Parameters start = identify(campaign, measurements, campaign.nominal).parameters;
    const Estimate joint = identify(campaign, measurements, start);
    const Estimate two_step = identify_two_step(campaign, measurements, start);
    EXPECT_LT((joint.covariance - two_step.covariance).norm(), 1e-6 * joint.covariance.norm());
}

TEST(Identify, OfNothingUnknownJudgesTheStatedModel) {
    Campaign campaign = with_sigma(5e-5);
    campaign.robot = without_parameters(campaign.robot);
    campaign.nominal.robot.resize(0);
    std::vector<std::optional<Vector3d>> targets;
    for (Index j = 0; j < 3; ++j) {
        targets.emplace_back(Vector3d(campaign.nominal.sensor.segment<3>(3 * j)));
    }
    campaign.sensor = std::make_shared<PointSensor>(targets, 5e-5);
    campaign.nominal.sensor.resize(0);
    campaign.base_is_known.fill(true);
    ASSERT_EQ(parameter_count(campaign), 0);
    const auto measurements = simulate_measurements(
        campaign, campaign.nominal, random_configurations(campaign.robot, 30, 1), 1, 2);
    const Estimate estimate = identify(campaign, measurements, campaign.nominal);
    EXPECT_EQ(estimate.ending, Ending::Converged);
    EXPECT_EQ(estimate.degrees_of_freedom, 270);
    EXPECT_NEAR(estimate.variance_factor, 1, 0.3);
    EXPECT_EQ(estimate.covariance.size(), 0);
}

TEST(IdentifyTwoStep, RefusesAStepSizeOutsideZeroToOne) {
    const Campaign campaign = with_sigma(5e-5);
    const auto measurements = simulate(campaign, {24, 1, 7, 8}).measurements;
    for (const double alpha : {0.0, -1.0, 1.5, std::nan("")}) {
        EXPECT_THROW(identify_two_step(campaign, measurements, campaign.nominal, {10, alpha}),
                     InputError);
    }
}

}  // namespace
}  // namespace posewise
