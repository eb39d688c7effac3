#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "../../src/calibrator/loss.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/parameter_error.hpp"

/// Calibration by robust losses, of measurements with gross errors and without.
namespace posewise {
namespace {

using namespace detail;

using testing::error_of;
using testing::tracked_campaign;

constexpr LossKind robust_kinds[] = {LossKind::Huber, LossKind::Cauchy};

LevenbergMarquardtOptions with_loss(LossKind kind, double width = 0) {
    LevenbergMarquardtOptions options;
    options.loss = {kind, width};
    return options;
}

using Places = std::vector<std::pair<Index, Index>>;

/// Moves this share of the targets of configurations, in all their samples, by 5 mm somewhere.
Places spoil(Measurements& measurements, double share, std::uint64_t seed) {
    RandomStream stream(seed, 77);
    Places spoiled;
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        for (Index j = 0; j < measurements.is_seen.cols(); ++j) {
            if (stream.uniform() >= share) continue;
            spoiled.emplace_back(i, j);
            const Vector3d shift =
                5e-3 * Vector3d(stream.normal(), stream.normal(), stream.normal()).normalized();
            measurements.observations
                .block(measurements.first_sample[static_cast<std::size_t>(i)], 3 * j,
                       measurements.sample_count(i), 3)
                .rowwise() += shift.transpose();
        }
    }
    return spoiled;
}

Places places_of(const std::vector<Outlier>& outliers) {
    Places places;
    for (const Outlier& outlier : outliers) {
        places.emplace_back(outlier.configuration, outlier.target);
    }
    return places;
}

Measurements simulate_with(const Campaign& campaign, const Parameters& truth, std::uint64_t seed) {
    return simulate_measurements(campaign, truth, random_configurations(campaign.robot, 30, 4), 2,
                                 seed);
}

/// Integral of g times the density of the length of `rows` standard normal numbers, up to `end`.
double mean_over_lengths(Index rows, const std::function<double(double)>& g, double end = 14) {
    const auto p = static_cast<double>(rows);
    const double factor = std::pow(2.0, 1 - p / 2) / std::tgamma(p / 2);
    constexpr int steps = 100000;
    double sum = 0;
    for (int k = 0; k < steps; ++k) {
        const double s = end * (k + 0.5) / steps;
        sum += g(s) * factor * std::pow(s, p - 1) * std::exp(-s * s / 2);
    }
    return sum * end / steps;
}

TEST(Loss, DefaultWidthKeeps95PercentOfTheEfficiency) {
    for (const LossKind kind : robust_kinds) {
        for (Index rows = 1; rows <= 6; ++rows) {
            const Loss loss{kind, default_width(kind, rows)};
            const auto p = static_cast<double>(rows);
            const double rate = mean_over_lengths(rows, [&](double s) {
                return (loss.influence_rate(s) + (p - 1) * loss.weight(s)) / p;
            });
            const double variance = mean_over_lengths(
                rows, [&](double s) { return std::pow(loss.weight(s) * s, 2) / p; });
            EXPECT_NEAR(rate * rate / variance, 0.95, 2e-4) << loss_name(kind) << rows;
        }
    }
}

TEST(Loss, LengthsAreQuantiles) {
    for (Index rows = 1; rows <= 6; ++rows) {
        const auto below = [&](double end) {
            return mean_over_lengths(
                rows, [](double) { return 1.0; }, end);
        };
        EXPECT_NEAR(below(median_length(rows)), 0.5, 2e-4) << rows;
        EXPECT_GT(1 - below(outlier_length(rows)), 0.8e-5) << rows;  // a normal beyond 4: 3.2e-5
        EXPECT_LT(1 - below(outlier_length(rows)), 4e-5) << rows;
    }
}

TEST(Loss, WeightsAreThoseOfItsGradient) {
    constexpr double h = 1e-6;
    for (const LossKind kind : {LossKind::Squares, LossKind::Huber, LossKind::Cauchy}) {
        const Loss loss{kind, 1.7};
        for (const double u : {0.3, 1.0, 1.69, 1.71, 4.0, 50.0}) {
            const double slope = (loss.value(u + h) - loss.value(u - h)) / (2 * h);
            EXPECT_NEAR(loss.weight(u), slope / (2 * u), 1e-6) << loss_name(kind) << u;
            const double rate =
                (loss.weight(u + h) * (u + h) - loss.weight(u - h) * (u - h)) / (2 * h);
            EXPECT_NEAR(loss.influence_rate(u), rate, 1e-6) << loss_name(kind) << u;
        }
        EXPECT_NEAR(loss.value(1e-4), 1e-8, 1e-15);
        EXPECT_EQ(loss.weight(0), 1);
    }
}

TEST(RobustIdentify, OfCleanMeasurementsStaysWithinItsCovarianceAndListsNothing) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Parameters truth = draw_truth(campaign, 3);
    for (const LossKind kind : robust_kinds) {
        const int runs = 200;
        double mahalanobis = 0;
        double variance_factor = 0;
        std::size_t outliers = 0;
        for (int run = 0; run < runs; ++run) {
            const Measurements measurements =
                simulate_with(campaign, truth, 1000 + static_cast<std::uint64_t>(run));
            const Estimate estimate = identify(campaign, measurements, truth, with_loss(kind));
            EXPECT_EQ(estimate.ending, Ending::Converged);
            const VectorXd error = error_of(estimate.parameters, truth);
            mahalanobis += error.dot(estimate.covariance.ldlt().solve(error)) / runs;
            variance_factor += estimate.variance_factor / runs;
            outliers += estimate.outliers.size();
        }
        // 33 if the covariance is right; that it is estimated, too, adds some per cent.
        EXPECT_NEAR(mahalanobis, 33, 3) << loss_name(kind);
        EXPECT_NEAR(variance_factor, 1, 0.05) << loss_name(kind);
        EXPECT_LE(outliers, 5U) << loss_name(kind);  // of 18 000
    }
}

TEST(RobustIdentify, WithstandsGrossErrorsAndListsThem) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Parameters truth = draw_truth(campaign, 3);
    const int runs = 40;
    for (const LossKind kind : robust_kinds) {
        double mahalanobis = 0;
        double worse = 0;
        for (std::uint64_t run = 0; run < runs; ++run) {
            Measurements measurements = simulate_with(campaign, truth, 1000 + run);
            const double clean =
                error_of(identify(campaign, measurements, truth).parameters, truth).norm();
            const Places spoiled = spoil(measurements, 0.08, run);
            const Parameters start = register_base_and_targets(campaign, measurements).parameters;
            const Estimate estimate = identify(campaign, measurements, start, with_loss(kind));
            const VectorXd error = error_of(estimate.parameters, truth);
            mahalanobis += error.dot(estimate.covariance.ldlt().solve(error)) / runs;
            worse += error.norm() / clean / runs;
            EXPECT_EQ(estimate.ending, Ending::Converged);
            const Places found = places_of(estimate.outliers);
            EXPECT_TRUE(std::includes(found.begin(), found.end(), spoiled.begin(), spoiled.end()));
            EXPECT_LE(found.size(), spoiled.size() + 1);
            for (const Outlier& outlier : estimate.outliers) EXPECT_LT(outlier.weight, 0.5);

            const Estimate squares = identify(campaign, measurements, start);
            EXPECT_TRUE(squares.outliers.empty());
            EXPECT_GT(error_of(squares.parameters, truth).norm(), 2 * error.norm());
        }
        EXPECT_NEAR(mahalanobis, 33, kind == LossKind::Cauchy ? 6 : 9) << loss_name(kind);
        EXPECT_LT(worse, 1.8) << loss_name(kind);
    }
}

TEST(RobustIdentify, DoesNotDependOnHowLargeTheNoiseIsSaidToBe) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    Measurements measurements = simulate_with(campaign, draw_truth(campaign, 3), 5);
    const Places spoiled = spoil(measurements, 0.08, 5);
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const Estimate right = identify(campaign, measurements, start, with_loss(LossKind::Cauchy));
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 5e-7);
    campaign.model_error = 1e-6;
    const Estimate wrong = identify(campaign, measurements, start, with_loss(LossKind::Cauchy));
    EXPECT_LT(error_of(wrong.parameters, right.parameters).norm(), 1e-9);
    EXPECT_NEAR(wrong.variance_factor / right.variance_factor, 1e4, 1e-5 * 1e4);
    EXPECT_LT((wrong.covariance - right.covariance).norm(), 1e-5 * right.covariance.norm());
    EXPECT_EQ(places_of(right.outliers), spoiled);
    EXPECT_EQ(places_of(wrong.outliers), spoiled);
}

TEST(RobustIdentify, WithAVeryLargeWidthIsLeastSquares) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate_with(campaign, draw_truth(campaign, 3), 5);
    const Parameters start = register_base_and_targets(campaign, measurements).parameters;
    const Estimate squares = identify(campaign, measurements, start);
    for (const LossKind kind : robust_kinds) {
        const Estimate robust = identify(campaign, measurements, start, with_loss(kind, 1e6));
        EXPECT_LT(error_of(robust.parameters, squares.parameters).norm(), 1e-9);
        EXPECT_LT((robust.covariance - squares.covariance).norm(),
                  1e-6 * squares.covariance.norm());
    }
}

TEST(RobustIdentify, KeepsAPriorsCovarianceAsStated) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.spread.is_prior = true;
    campaign.model_error_common = 0;  // as a robust loss takes it
    constexpr int runs = 100;
    double mahalanobis = 0;
    for (std::uint64_t run = 0; run < runs; ++run) {
        const Parameters truth = draw_truth(campaign, run);
        Measurements measurements = simulate_with(campaign, truth, 900 + run);
        spoil(measurements, 0.05, run);
        const Estimate estimate =
            identify(campaign, measurements, truth, with_loss(LossKind::Cauchy));
        const VectorXd error = error_of(estimate.parameters, truth);
        mahalanobis += error.dot(estimate.covariance.ldlt().solve(error)) / runs;
    }
    EXPECT_NEAR(mahalanobis, 33, 6);
}

TEST(RobustIdentify, RefusesAWidthThatIsNone) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate_with(campaign, campaign.nominal, 5);
    for (const double width : {-1.0, std::nan(""), 1.0 / 0.0}) {
        EXPECT_THROW(
            identify(campaign, measurements, campaign.nominal, with_loss(LossKind::Huber, width)),
            InputError);
    }
}

}  // namespace
}  // namespace posewise
