#include <gtest/gtest.h>

#include <limits>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/derivative_check.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

const LaserTrackerNoise tracker{1e-5, 5e-6, Vector3d(0.5, -0.2, 1)};

TEST(PointCovariance, OfALaserTrackerIsRangeAlongTheBeamAndAngleTimesDistanceAcross) {
    const Matrix3d S = point_covariance(tracker, tracker.position + Vector3d(0, 4, 0));
    EXPECT_TRUE(S.isApprox(Vector3d(4e-10, 1e-10, 4e-10).asDiagonal().toDenseMatrix(), 1e-14));
    // Turning everything about the tracker turns the covariance.
    const Matrix3d R = Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    const Matrix3d turned = point_covariance(tracker, tracker.position + R * Vector3d(0, 4, 0));
    EXPECT_TRUE(turned.isApprox(R * S * R.transpose(), 1e-13));
}

TEST(PointCovariance, OfSimpleNoiseIsTheSameEverywhere) {
    const Vector3d sigma(1e-5, 2e-5, 3e-5);
    for (const Vector3d& point : {Vector3d(0, 0, 0), Vector3d(1, 2, 3)}) {
        EXPECT_TRUE(point_covariance(IsotropicNoise{2e-5}, point)
                        .isApprox(4e-10 * Matrix3d::Identity(), 1e-15));
        EXPECT_EQ(point_covariance(PerAxisNoise{sigma}, point),
                  Matrix3d(sigma.cwiseAbs2().asDiagonal()));
        EXPECT_EQ(point_covariance_rate(PerAxisNoise{sigma}, point, Vector3d::Ones()),
                  Matrix3d(Matrix3d::Zero()));
    }
}

TEST(PointCovariance, RateOfALaserTrackerAgreesWithDifferences) {
    for (std::uint64_t item = 0; item < static_cast<std::uint64_t>(sweep_count() / 10); ++item) {
        RandomStream stream(71, item);
        const Vector3d point = tracker.position + random_vector(stream, 3, 3);
        const Vector3d velocity = random_vector(stream, 3, 1);
        const double far = (point - tracker.position).norm();
        if (far < 0.2) continue;  // differences need room
        const auto covariance = [&](const VectorXd& t) -> VectorXd {
            return 1e10 * point_covariance(tracker, point + 0.1 * far * t[0] * velocity).reshaped();
        };
        const Matrix3d rate = point_covariance_rate(tracker, point, 0.1 * far * velocity);
        expect_is_jacobian(1e10 * rate.reshaped(), covariance, VectorXd::Zero(1));
    }
}

TEST(PointCovariance, StaysPositiveDefiniteAtTheTrackerItself) {
    const Matrix3d S = point_covariance(tracker, tracker.position);
    EXPECT_TRUE(S.allFinite());
    EXPECT_GT(S.determinant(), 0);
    EXPECT_TRUE(point_covariance_rate(tracker, tracker.position, Vector3d::Ones()).allFinite());
}

TEST(CheckNoise, RefusesSigmasThatAreNotPositive) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check_noise(LaserTrackerNoise{0, 1e-6}), InputError);
    EXPECT_THROW(check_noise(LaserTrackerNoise{1e-6, -1e-6}), InputError);
    EXPECT_THROW(check_noise(LaserTrackerNoise{1e-6, 1e-6, Vector3d(0, nan, 0)}), InputError);
    EXPECT_THROW(check_noise(PerAxisNoise{Vector3d(1e-5, 0, 1e-5)}), InputError);
    EXPECT_THROW(check_noise(IsotropicNoise{nan}), InputError);
    EXPECT_NO_THROW(check_noise(tracker));
}

TEST(CoordinateSigma, IsTheRootMeanSquareOverTheAxes) {
    EXPECT_DOUBLE_EQ(coordinate_sigma(IsotropicNoise{3e-5}, 10), 3e-5);
    EXPECT_DOUBLE_EQ(coordinate_sigma(PerAxisNoise{Vector3d(1e-5, 1e-5, 5e-5)}, 10), 3e-5);
    EXPECT_DOUBLE_EQ(coordinate_sigma(tracker, 2), 1e-5);
}

}  // namespace
}  // namespace posewise
