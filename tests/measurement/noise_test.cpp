#include "../../src/measurement/noise.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "support/campaigns.hpp"
#include "support/derivative_check.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;

Campaign one_target_campaign(double sigma, double model_error) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>{Vector3d(0.1, 0, 0)}, sigma);
    campaign.model_error = model_error;
    return campaign;
}

FlangeMotion motion_at(const Campaign& campaign, const VectorXd& q,
                       std::vector<FlangeMotionRate>& rates) {
    FlangeMotion motion;
    campaign.robot.differentiate_twice(campaign.nominal.world_from_base, q, campaign.nominal.robot,
                                       motion, rates);
    return motion;
}

/// FANUC, three targets, a laser tracker and joints that do not repeat exactly.
Campaign noisy_campaign() {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{1e-5, 8e-6});
    campaign.joint_repeatability = VectorXd::LinSpaced(6, 1e-5, 6e-5);
    campaign.model_error_common = 0.9;
    return campaign;
}

TEST(MeanCovariance, IsNoiseOverRepeatsAndModelErrorInQuadrature) {
    const auto covariance = [](double sigma, double model_error, double repeats) {
        FlangeMotion motion;
        motion.world_from_flange.setIdentity();
        return mean_covariance(one_target_campaign(sigma, model_error), motion, VectorXd(),
                               repeats);
    };
    const MatrixXd I = MatrixXd::Identity(3, 3);
    EXPECT_TRUE(covariance(3e-5, 4e-5, 1).isApprox(25e-10 * I, 1e-14));
    EXPECT_TRUE(covariance(3e-5, 0, 9).isApprox(1e-10 * I, 1e-14));
    EXPECT_TRUE(covariance(3e-5, 4e-5, 9).isApprox(17e-10 * I, 1e-14));
}

TEST(MeanCovariance, JointErrorsCorrelateTheTargetsAndRepeatsDoNotReduceThem) {
    Campaign campaign = noisy_campaign();
    const VectorXd q = VectorXd::LinSpaced(6, -0.5, 0.7);
    std::vector<FlangeMotionRate> rates;
    const FlangeMotion motion = motion_at(campaign, q, rates);
    const VectorXd& targets = campaign.nominal.sensor;
    const VectorXd s = campaign.joint_repeatability;
    const auto predict = [&](const VectorXd& joints) {
        return campaign.sensor->predict(world_from_flange(campaign, campaign.nominal, joints),
                                        targets);
    };
    const MatrixXd effect = testing::numerical_jacobian(predict, q) * s.asDiagonal();
    const MatrixXd with = mean_covariance(campaign, motion, targets, 5);
    campaign.joint_repeatability.resize(0);
    const MatrixXd without = mean_covariance(campaign, motion, targets, 5);
    EXPECT_TRUE((with - without).isApprox(effect * effect.transpose(), 1e-8));
}

TEST(MeanCovariance, HasTheMotionOfTheFlangeThatTheModelErrorIs) {
    Campaign campaign = noisy_campaign();
    campaign.model_error = 3e-4;
    const VectorXd q = VectorXd::LinSpaced(6, -0.5, 0.7);
    std::vector<FlangeMotionRate> rates;
    const FlangeMotion motion = motion_at(campaign, q, rates);
    const VectorXd& targets = campaign.nominal.sensor;
    // By a translation of the flange and a rotation about the middle of the targets, along the
    // world's axes.
    const auto target = [&](Index j) {
        return Vector3d(motion.world_from_flange * campaign.sensor->target_position(j, targets));
    };
    const Vector3d middle = (target(0) + target(1) + target(2)) / 3;
    double levers = 0;
    for (Index j = 0; j < 3; ++j) levers += (target(j) - middle).squaredNorm() / 3;
    const auto predict = [&](const VectorXd& moved) {
        Isometry3d turn = Isometry3d::Identity();
        turn.linear() = rotation_from_vector(moved.tail<3>());
        const Isometry3d about_middle =
            Eigen::Translation3d(middle + moved.head<3>()) * turn * Eigen::Translation3d(-middle);
        return campaign.sensor->predict(about_middle * motion.world_from_flange, targets);
    };
    const MatrixXd effect = testing::numerical_jacobian(predict, VectorXd::Zero(6));
    VectorXd variances(6);
    variances << 0.45 * 9e-8 * VectorXd::Ones(3), 0.45 * 9e-8 * 1.5 / levers * VectorXd::Ones(3);
    const MatrixXd moved = effect * variances.asDiagonal() * effect.transpose() +
                           0.1 * 9e-8 * MatrixXd::Identity(9, 9);
    // As large as if each target had it by itself.
    EXPECT_NEAR(moved.trace(), 9 * 9e-8, 1e-14);
    const MatrixXd with = mean_covariance(campaign, motion, targets, 5);
    campaign.model_error = 0;
    const MatrixXd without = mean_covariance(campaign, motion, targets, 5);
    EXPECT_TRUE((with - without).isApprox(moved, 1e-7));
}

TEST(MeanCovariance, SharesNothingWhereOneTargetIsShown) {
    Campaign campaign = one_target_campaign(3e-5, 4e-5);
    EXPECT_EQ(common_part(campaign), 0);
    EXPECT_TRUE(has_constant_noise(campaign));
    EXPECT_EQ(common_part(noisy_campaign()), 0.9);
    EXPECT_FALSE(has_constant_noise(noisy_campaign()));
    campaign = noisy_campaign();
    campaign.model_error_common.reset();
    EXPECT_EQ(common_part(campaign), 0);  // without priors
    campaign.spread.is_prior = true;
    EXPECT_EQ(common_part(campaign), usual_model_error_common);
}

TEST(MeanCovariance, DividesEachTargetByItsOwnRepeatsAndLeavesOutThoseNotSeen) {
    const Campaign campaign = noisy_campaign();
    std::vector<FlangeMotionRate> rates;
    const FlangeMotion motion = motion_at(campaign, VectorXd::LinSpaced(6, -0.5, 0.7), rates);
    const auto covariance = [&](const auto& repeats) {
        return mean_covariance(campaign, motion, campaign.nominal.sensor, repeats);
    };
    const MatrixXd some = covariance(VectorXd(Vector3d(7, 0, 2)));
    ASSERT_EQ(some.rows(), 6);
    EXPECT_TRUE(some.topLeftCorner(3, 3).isApprox(covariance(7.0).topLeftCorner(3, 3), 1e-12));
    EXPECT_TRUE(
        some.bottomRightCorner(3, 3).isApprox(covariance(2.0).bottomRightCorner(3, 3), 1e-12));
    const MatrixXd joint_errors = covariance(1.0).topRightCorner(3, 3);
    EXPECT_TRUE(some.topRightCorner(3, 3).isApprox(joint_errors, 1e-12));
    EXPECT_GT(joint_errors.norm(), 0);
    EXPECT_TRUE(some.isApprox(some.transpose(), 1e-12));
    EXPECT_EQ(covariance(VectorXd(Vector3d(4, 4, 4))), covariance(4.0));
}

TEST(FlangeCovariance, IsWhatTheReadingsShare) {
    Campaign campaign = noisy_campaign();
    std::vector<FlangeMotionRate> rates;
    const FlangeMotion motion = motion_at(campaign, VectorXd::LinSpaced(6, -0.5, 0.7), rates);
    const VectorXd& targets = campaign.nominal.sensor;
    RowMatrixXd A(9, 6 + targets.size());
    campaign.sensor->differentiate(motion.world_from_flange, TwistMatrix::Identity(6, 6), targets,
                                   A);
    PoseNoise noise(campaign);
    const VectorXd repeats = VectorXd::Constant(3, 5);
    const MatrixXd own = noise.own_covariance(motion, targets, repeats);
    const MatrixXd shared = A.leftCols<6>() * flange_covariance(campaign, motion, targets) *
                            A.leftCols<6>().transpose();
    EXPECT_TRUE(mean_covariance(campaign, motion, targets, 5).isApprox(own + shared, 1e-12));
    EXPECT_GT(shared.norm(), own.norm() / 10);
}

TEST(FlangeCovarianceRate, AgreesWithDifferences) {
    const Campaign campaign = noisy_campaign();
    const VectorXd& targets = campaign.nominal.sensor;
    std::vector<FlangeMotionRate> rates;
    std::vector<FlangeMotionRate> ignored;
    for (std::uint64_t item = 0; item < static_cast<std::uint64_t>(testing::sweep_count() / 50);
         ++item) {
        RandomStream stream(72, item);
        const VectorXd q = testing::random_vector(stream, 6, 2);
        const FlangeMotion motion = motion_at(campaign, q, rates);
        MatrixXd J(36, 6);
        for (Index j = 0; j < 6; ++j) {
            J.col(j) = 1e8 * flange_covariance_rate(campaign, motion, j,
                                                    rates[static_cast<std::size_t>(j)], targets)
                                 .reshaped();
        }
        const auto covariance = [&](const VectorXd& joints) -> VectorXd {
            return 1e8 * flange_covariance(campaign, motion_at(campaign, joints, ignored), targets)
                             .reshaped();
        };
        testing::expect_is_jacobian(J, covariance, q);
    }
}

TEST(CheckNoise, RefusesJointRepeatabilityThatDoesNotFit) {
    Campaign campaign = noisy_campaign();
    EXPECT_NO_THROW(check_noise(campaign));
    campaign.joint_repeatability[2] = -1e-5;
    EXPECT_THROW(check_noise(campaign), InputError);
    campaign.joint_repeatability.resize(5);
    campaign.joint_repeatability.setConstant(1e-5);
    EXPECT_THROW(check_noise(campaign), InputError);
}

TEST(Whiten, RefusesANoiseThatIsNotPositiveDefinite) {
    MatrixXd correlated(2, 2);
    correlated << 1, 2, 2, 1;
    const MatrixXd without_noise = Vector3d(1, 0, 1).asDiagonal();
    MatrixXd not_a_number = MatrixXd::Identity(2, 2);
    not_a_number(0, 0) = std::numeric_limits<double>::quiet_NaN();
    RowMatrixXd rows = RowMatrixXd::Identity(2, 2);
    EXPECT_EQ(testing::input_error_of([&] { whiten(correlated, rows); }),
              "the covariance of the observation's noise (2 x 2) has the least eigenvalue -1 where "
              "the largest is 3, must be positive definite");
    EXPECT_THROW(cholesky_factor(correlated), InputError);
    EXPECT_THROW(whiten(not_a_number, rows), InputError);
    rows = RowMatrixXd::Identity(3, 3);
    EXPECT_THROW(whiten(without_noise, rows), InputError);
}

TEST(Whiten, MakesCorrelatedErrorsIndependent) {
    MatrixXd covariance(3, 3);
    covariance << 4, 1, 0.5, 1, 3, -0.2, 0.5, -0.2, 2;
    RowMatrixXd rows = cholesky_factor(covariance);
    EXPECT_TRUE((rows * rows.transpose()).isApprox(covariance, 1e-14));
    whiten(covariance, rows);
    EXPECT_TRUE(rows.isApprox(RowMatrixXd::Identity(3, 3), 1e-14));

    const MatrixXd diagonal = Vector3d(4, 9, 0.25).asDiagonal();
    rows = cholesky_factor(diagonal);
    whiten(diagonal, rows);
    EXPECT_TRUE(rows.isApprox(RowMatrixXd::Identity(3, 3), 1e-14));
}

}  // namespace
}  // namespace posewise
