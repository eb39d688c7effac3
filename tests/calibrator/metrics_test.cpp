#include <gtest/gtest.h>

#include <cmath>

#include "posewise/calibrator/estimate.hpp"

namespace posewise {
namespace {

TEST(MakeMetrics, KnowsAFewPoints) {
    RowMatrixXd residuals(4, 3);  // lengths 3, 5, 0, 13
    residuals << 1, 2, 2, 0, -3, 4, 0, 0, 0, 12, 4, -3;
    const Metrics metrics = make_metrics(residuals);
    EXPECT_EQ(metrics.point_count, 4);
    EXPECT_DOUBLE_EQ(metrics.distance_rms, std::sqrt((9 + 25 + 0 + 169) / 4.0));
    EXPECT_DOUBLE_EQ(metrics.distance_max, 13);
    EXPECT_DOUBLE_EQ(metrics.distance_mean, 21 / 4.0);
    EXPECT_DOUBLE_EQ(metrics.distance_p95, 13);
    EXPECT_DOUBLE_EQ(metrics.coordinate_rms[0], std::sqrt(145 / 4.0));
    EXPECT_DOUBLE_EQ(metrics.coordinate_max[1], 4);
    EXPECT_DOUBLE_EQ(metrics.coordinate_max[2], 4);
}

TEST(MakeMetrics, TellOrientationsFromPositions) {
    RowMatrixXd residuals(2, 6);
    residuals << 1, 2, 2, 0, 3e-3, 4e-3, 0, 0, 0, 0, 0, 0;
    const Metrics metrics = make_metrics(residuals);
    EXPECT_EQ(metrics.point_count, 2);
    EXPECT_TRUE(metrics.has_orientation);
    EXPECT_DOUBLE_EQ(metrics.distance_max, 3);
    EXPECT_DOUBLE_EQ(metrics.orientation_max, 5e-3);
    EXPECT_DOUBLE_EQ(metrics.orientation_rms, 5e-3 / std::sqrt(2));
}

TEST(MakeMetrics, OfAnglesAloneHaveNoDistances) {
    const Metrics metrics = make_metrics(RowMatrixXd{{3e-3, 4e-3}, {0, 0}}, 0);
    EXPECT_EQ(metrics.coordinate_count, 0);
    EXPECT_TRUE(metrics.has_orientation);
    EXPECT_EQ(metrics.distance_max, 0);
    EXPECT_DOUBLE_EQ(metrics.orientation_max, 5e-3);
    EXPECT_DOUBLE_EQ(metrics.rms(), 5e-3 / std::sqrt(2));
}

TEST(MakeMetrics, OfLengthsHaveNoAxes) {
    const Metrics metrics = make_metrics(RowMatrixXd{{3}, {-4}});
    EXPECT_EQ(metrics.coordinate_count, 1);
    EXPECT_FALSE(metrics.has_orientation);
    EXPECT_DOUBLE_EQ(metrics.distance_rms, std::sqrt(12.5));
    EXPECT_DOUBLE_EQ(metrics.distance_max, 4);
}

TEST(MakeMetrics, OfNothingAreZero) {
    const Metrics metrics = make_metrics(RowMatrixXd(0, 3));
    EXPECT_EQ(metrics.point_count, 0);
    EXPECT_EQ(metrics.distance_rms, 0);
}

TEST(StrongestCorrelations, ComeStrongestFirst) {
    Estimate estimate;
    estimate.covariance.resize(3, 3);
    estimate.covariance << 4, 1, -1.8, 1, 1, 0.1, -1.8, 0.1, 1;
    const auto strongest = strongest_correlations(estimate, 2);
    ASSERT_EQ(strongest.size(), 2U);
    EXPECT_EQ(strongest[0].first, 0);
    EXPECT_EQ(strongest[0].second, 2);
    EXPECT_DOUBLE_EQ(strongest[0].coefficient, -0.9);
    EXPECT_DOUBLE_EQ(strongest[1].coefficient, 0.5);
    EXPECT_EQ(strongest_correlations(estimate, 10).size(), 3U);
}

}  // namespace
}  // namespace posewise
