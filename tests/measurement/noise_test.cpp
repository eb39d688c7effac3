#include "posewise/measurement/noise.hpp"

#include <gtest/gtest.h>

#include "support/campaigns.hpp"

namespace posewise {
namespace {

Campaign one_target_campaign(double sigma, double model_error) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>{Vector3d(0.1, 0, 0)}, sigma);
    campaign.model_error = model_error;
    return campaign;
}

TEST(MeanCovariance, IsNoiseOverRepeatsAndModelErrorInQuadrature) {
    const auto covariance = [](double sigma, double model_error, double repeats) {
        return mean_covariance(one_target_campaign(sigma, model_error), Isometry3d::Identity(),
                               VectorXd(), repeats);
    };
    const MatrixXd I = MatrixXd::Identity(3, 3);
    EXPECT_TRUE(covariance(3e-5, 4e-5, 1).isApprox(25e-10 * I, 1e-14));
    EXPECT_TRUE(covariance(3e-5, 0, 9).isApprox(1e-10 * I, 1e-14));
    EXPECT_TRUE(covariance(3e-5, 4e-5, 9).isApprox(17e-10 * I, 1e-14));
}

TEST(Whiten, MakesCorrelatedErrorsIndependent) {
    MatrixXd covariance(3, 3);
    covariance << 4, 1, 0.5, 1, 3, -0.2, 0.5, -0.2, 2;
    RowMatrixXd rows = cholesky_factor(covariance);
    EXPECT_TRUE((rows * rows.transpose()).isApprox(covariance, 1e-14));
    whiten(covariance, rows);
    EXPECT_TRUE(rows.isApprox(RowMatrixXd::Identity(3, 3), 1e-14));
}

}  // namespace
}  // namespace posewise
