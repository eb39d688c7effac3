#include "../../src/report/calibration_tables.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "posewise/measurement/sensors.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

using namespace detail;

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

TEST(ValueTable, IsTheParameterTableWithoutDeviations) {
    const Campaign campaign = testing::tracked_campaign(testing::planar_arm({1, 0.5}));
    const Table table = value_table(campaign, example_estimate(campaign).parameters);
    ASSERT_EQ(table.rows.size(), 19u);
    EXPECT_EQ(table.rows[5], (Row{"base.rz", "90.0000", "deg"}));
    EXPECT_EQ(table.rows[6], (Row{"dq1", "0.5000", "mrad"}));
}

TEST(CorrelationTable, NamesTheStrongest) {
    const Campaign campaign = testing::tracked_campaign(testing::planar_arm({1, 0.5}));
    const Table table = correlation_table(example_estimate(campaign), 1);
    ASSERT_EQ(table.rows.size(), 1u);
    EXPECT_EQ(table.rows[0], (Row{"base.x", "dq1", "-0.500"}));
}

TEST(OutlierTable, ShowsTheFarthestFirst) {
    Estimate estimate;
    estimate.outliers = {{3, "left", 0, 1e-3, 6.04, 0.5}, {9, "up", 2, 5e-3, 50, 0.01}};
    Campaign campaign = testing::tracked_campaign(testing::planar_arm({1, 0.5}));
    const Table table = outlier_table(campaign, estimate, 5);
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(table.rows[0], (Row{"up", "3", "5.0000", "50.0", "0.010"}));
    EXPECT_EQ(table.rows[1], (Row{"left", "1", "1.0000", "6.0", "0.500"}));
    EXPECT_EQ(outlier_table(campaign, estimate, 1).rows.size(), 1u);
    campaign.sensor = std::make_shared<SocketSensor>(
        Targets({std::nullopt}), std::vector<Socket>{{"s0"}, {"s1"}, {"left"}}, false, 1e-4);
    const Table of_sockets = outlier_table(campaign, estimate, 5);
    EXPECT_EQ(of_sockets.header[1], "socket");
    EXPECT_EQ(of_sockets.rows[0][1], "left");
}

TEST(ModelTable, MarksTheBestAndTheRecommended) {
    ModelSelection selection;
    selection.trials = {{{"base and targets", {}}, 15, 6e-4, 7e-4, 9e-5},
                        {{"+ joint offsets", {}}, 19, 3e-4, 4e-4, 1e-4},
                        {{"+ lengths", {}}, 27, 0, 0, 0, "too few"},
                        {{"+ harmonics", {}}, 30, 2e-4, 3.5e-4, 1e-4}};
    selection.recommended = 1;
    selection.best = 3;
    const Table table = model_table(selection);
    EXPECT_EQ(table.rows[0], (Row{"base and targets", "15", "0.6000", "0.7000", "0.0900", ""}));
    EXPECT_EQ(table.rows[1][5], "recommended");
    EXPECT_EQ(table.rows[2], (Row{"+ lengths", "27", "-", "-", "-", ""}));
    EXPECT_EQ(table.rows[3][5], "best");
    selection.recommended = 3;
    EXPECT_EQ(model_table(selection).rows[3][5], "recommended, best");
}

}  // namespace
}  // namespace posewise
