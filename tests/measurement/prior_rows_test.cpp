#include "../../src/measurement/prior_rows.hpp"

#include <gtest/gtest.h>

#include "support/campaigns.hpp"

namespace posewise {
namespace {

TEST(PriorInformation, IsTheInverseOfTheCovarianceInUnitsOfTheSpread) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.spread.is_prior = true;
    const VectorXd scale = parameter_scale(campaign);
    const Index L = parameter_count(campaign);
    const MatrixXd root = MatrixXd::Identity(L, L) + 0.1 * MatrixXd::Ones(L, L);
    // What has this covariance in units of the spread.
    const MatrixXd covariance = root * root;
    campaign.prior = Prior{campaign.nominal, true, true,
                           scale.asDiagonal() * covariance * MatrixXd(scale.asDiagonal())};
    EXPECT_TRUE(prior_information(campaign).isApprox(covariance.inverse(), 1e-10));
}

TEST(PriorInformation, OfASpreadIsOnePerParameterOfTheRobot) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.spread.is_prior = true;
    const Index L = parameter_count(campaign);
    MatrixXd expected = MatrixXd::Zero(L, L);
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) expected(6 + k, 6 + k) = 1;
    EXPECT_EQ(prior_information(campaign), expected);
}

}  // namespace
}  // namespace posewise
