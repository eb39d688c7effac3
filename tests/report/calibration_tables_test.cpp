#include "posewise/report/calibration_tables.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/campaigns.hpp"

namespace posewise {
namespace {

using Row = std::vector<std::string>;

TEST(MetricsTable, PrintsTheTenNumbersInMillimetresSideBySide) {
    Metrics metrics;
    metrics.point_count = 5;
    metrics.distance_rms = 1.607e-4;
    metrics.distance_max = 3.27e-4;
    metrics.coordinate_max = {1e-3, 2e-3, 3e-3};
    const Table table = metrics_table({{"calibrated", metrics}, {"held out", Metrics{}}});
    EXPECT_EQ(table.header, (Row{"error/mm", "calibrated", "held out"}));
    ASSERT_EQ(table.rows.size(), 10u);
    EXPECT_EQ(table.rows[0], (Row{"distance RMS", "0.1607", "-"}));
    EXPECT_EQ(table.rows[1], (Row{"distance max", "0.3270", "-"}));
    EXPECT_EQ(table.rows[9], (Row{"z max", "3.0000", "-"}));
}

Estimate example_estimate(const Campaign& campaign) {
    Estimate estimate;
    estimate.parameters = campaign.nominal;
    estimate.parameters.world_from_base =
        Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ());
    estimate.parameters.robot[0] = 5e-4;
    estimate.names = parameter_names(campaign);
    const Index count = parameter_count(campaign);
    estimate.covariance = MatrixXd::Identity(count, count) * 1e-8;
    estimate.covariance(0, 6) = estimate.covariance(6, 0) = -0.5e-8;
    return estimate;
}

TEST(ParameterTable, PrintsValuesWithStandardDeviations) {
    const Campaign campaign = testing::tracked_campaign(testing::planar_arm({1, 0.5}));
    const Table table = parameter_table(campaign, example_estimate(campaign));
    ASSERT_EQ(table.rows.size(), 19u);
    EXPECT_EQ(table.rows[1], (Row{"base.y", "2000.0000", "mm", "0.1000", "mm"}));
    EXPECT_EQ(table.rows[5], (Row{"base.rz", "90.0000", "deg", "0.1000", "mrad"}));
    EXPECT_EQ(table.rows[6], (Row{"dq1", "0.5000", "mrad", "0.1000", "mrad"}));
    EXPECT_EQ(table.rows[10], (Row{"target1.x", "280.0000", "mm", "0.1000", "mm"}));
}

TEST(CorrelationTable, NamesTheStrongest) {
    const Campaign campaign = testing::tracked_campaign(testing::planar_arm({1, 0.5}));
    const Table table = correlation_table(example_estimate(campaign), 1);
    ASSERT_EQ(table.rows.size(), 1u);
    EXPECT_EQ(table.rows[0], (Row{"base.x", "dq1", "-0.500"}));
}

}  // namespace
}  // namespace posewise
