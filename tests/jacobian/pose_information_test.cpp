#include "../../src/jacobian/pose_information.hpp"

#include <gtest/gtest.h>

#include "../../src/measurement/noise.hpp"
#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaigns.hpp"
#include "support/derivative_check.hpp"
#include "support/sensors.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

/// Both motions about and along every axis, driven, coupled and fixed, each with a parameter.
Chain every_element() {
    const auto T = Motion::Translation;
    const auto R = Motion::Rotation;
    return Chain({{"q1", -3, 3}, {"q2", -3, 3}, {"q3", -3, 3}, {"x", -1, 1}, {"y", -1, 1}},
                 {driven(R, Axis::Z, 0, "a"),
                  translation(Axis::X, 0.7, "b"),
                  driven(T, Axis::X, 3, "c"),
                  driven(R, Axis::Y, 1, "d"),
                  translation(Axis::Y, 0.4, "e"),
                  {R, Axis::X, 0.1, {{2, 1}, {1, -1}}, "f"},
                  driven(T, Axis::Y, 4, "g", -1),
                  rotation(Axis::Z, 0.3, "h"),
                  driven(T, Axis::Z, 4, "i", 0.5),
                  rotation(Axis::X, 0.2, "j"),
                  translation(Axis::Z, 0.3, "k"),
                  rotation(Axis::Y, -0.4, "l")});
}

std::vector<Campaign> campaigns_of_every_noise(const Chain& chain) {
    const std::vector<PointNoise> noises{
        IsotropicNoise{5e-5}, PerAxisNoise{Vector3d(2e-5, 5e-5, 9e-5)},
        LaserTrackerNoise{1e-5, 4e-5}, LaserTrackerNoise{4e-5, 1e-5, Vector3d(-4, 0.3, 1)}};
    std::vector<Campaign> campaigns;
    for (const PointNoise& noise : noises) {
        Campaign campaign = tracked_campaign(chain);
        campaign.sensor = std::make_shared<PointSensor>(
            std::vector<std::optional<Vector3d>>{std::nullopt, Vector3d(0.1, 0.2, -0.1),
                                                 std::nullopt},
            noise);
        campaign.nominal.sensor.conservativeResize(6);
        campaigns.push_back(campaign);
        campaign.joint_repeatability = VectorXd::LinSpaced(chain.joint_count(), 2e-5, 7e-5);
        campaigns.push_back(campaign);
    }
    return campaigns;
}

MatrixXd random_symmetric(RandomStream& stream, Index size) {
    const MatrixXd A = random_vector(stream, size * size, 1).reshaped(size, size);
    return A + A.transpose();
}

TEST(PoseInformation, IsThatOfItsBlock) {
    for (const Campaign& campaign : campaigns_of_every_noise(fanuc())) {
        const RowMatrixXd poses = random_configurations(campaign.robot, 3, 81);
        const Blocks blocks = make_blocks(campaign, campaign.nominal, poses, 4);
        const PoseInformation pose(campaign, campaign.nominal, 4);
        MatrixXd sum = MatrixXd::Zero(pose.parameter_count(), pose.parameter_count());
        for (Index i = 0; i < 3; ++i) sum += pose.evaluate(poses.row(i).transpose());
        EXPECT_TRUE(sum.isApprox(information(blocks), 1e-13));
    }
}

TEST(PoseInformation, DerivativeAgreesWithDifferencesForEveryElementAndNoise) {
    const Chain with_terms = with_harmonics(with_gravity_terms(fanuc()), {1, 2});
    for (const Chain& chain :
         {fanuc(), every_element(), complete_model(gantry_with_wrist()), with_terms}) {
        for (const Campaign& campaign : campaigns_of_every_noise(chain)) {
            const PoseInformation pose(campaign, campaign.nominal, 3);
            for (std::uint64_t item = 0; item < static_cast<std::uint64_t>(sweep_count() / 200);
                 ++item) {
                RandomStream stream(82, item);
                const VectorXd q = random_vector(stream, pose.joint_count(), 1);
                const MatrixXd Z = random_symmetric(stream, pose.parameter_count());
                const auto trace = [&](const VectorXd& joints) -> VectorXd {
                    return VectorXd::Constant(1, Z.cwiseProduct(pose.evaluate(joints)).sum());
                };
                // The gradient as one column, since a single small component has no digits left.
                const VectorXd gradient = pose.differentiate(q, Z);
                const VectorXd expected = numerical_jacobian(trace, q).transpose();
                EXPECT_LE((gradient - expected).norm(), 1e-8 * expected.norm());
            }
        }
    }
}

TEST(PoseInformation, DerivativeAgreesWithDifferencesForEverySensor) {
    for (const auto& [name, plain] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        for (const double repeatability : {0.0, 5e-5}) {
            Campaign campaign = plain;
            campaign.joint_repeatability = VectorXd::Constant(6, repeatability);
            const PoseInformation pose(campaign, campaign.nominal, 3);
            for (std::uint64_t item = 0; item < 5; ++item) {
                RandomStream stream(84, item);
                const VectorXd q = random_vector(stream, pose.joint_count(), 1);
                const MatrixXd Z = random_symmetric(stream, pose.parameter_count());
                const auto trace = [&](const VectorXd& joints) -> VectorXd {
                    return VectorXd::Constant(1, Z.cwiseProduct(pose.evaluate(joints)).sum());
                };
                const VectorXd expected = numerical_jacobian(trace, q).transpose();
                EXPECT_LE((pose.differentiate(q, Z) - expected).norm(), 1e-8 * expected.norm());
            }
        }
    }
}

/// A single reading, whose covariance is one number.
TEST(PoseInformation, OfOneDistanceHasItsDerivative) {
    Campaign campaign = tracked_campaign(fanuc());
    for (const auto& [name, one] : campaigns_of_every_sensor(fanuc())) {
        if (one.sensor->rows_per_target() == 1) campaign = one;
    }
    ASSERT_EQ(campaign.sensor->rows_per_target(), 1);
    campaign.joint_repeatability = VectorXd::Constant(6, 5e-4);
    const SeenTargets seen = seen_targets({0}, campaign.sensor->target_count());
    const PoseInformation pose(campaign, campaign.nominal);
    RandomStream stream(85);
    const VectorXd q = random_vector(stream, 6, 1);
    const MatrixXd Z = random_symmetric(stream, pose.parameter_count());
    const auto trace = [&](const VectorXd& joints) -> VectorXd {
        return VectorXd::Constant(1, Z.cwiseProduct(pose.evaluate(joints, seen)).sum());
    };
    const VectorXd expected = numerical_jacobian(trace, q).transpose();
    EXPECT_LE((pose.differentiate(q, Z, seen) - expected).norm(), 1e-8 * expected.norm());
}

TEST(PoseInformation, CountsOnlyTheTargetsThatAreSeen) {
    const SeenTargets seen = seen_targets({0, 2}, 3);
    for (const Campaign& campaign : campaigns_of_every_noise(fanuc())) {
        // Unseen rows as if they were measured infinitely badly.
        const PoseInformation pose(campaign, campaign.nominal);
        const VectorXd q = VectorXd::LinSpaced(6, -0.4, 0.9);
        FlangeMotion motion;
        RowMatrixXd J(9, pose.parameter_count());
        differentiate_pose(campaign, campaign.nominal, q, motion, J);
        MatrixXd S = mean_covariance(campaign, motion, campaign.nominal.sensor, 1);
        S.diagonal().segment<3>(3).array() += 1e6;
        whiten(S, J);
        J *= parameter_scale(campaign).asDiagonal();
        const MatrixXd M = pose.evaluate(q, seen);
        EXPECT_LE((M - J.transpose() * J).norm(), 1e-12 * M.norm());

        RandomStream stream(83);
        const MatrixXd Z = random_symmetric(stream, pose.parameter_count());
        const auto trace = [&](const VectorXd& joints) -> VectorXd {
            return VectorXd::Constant(1, Z.cwiseProduct(pose.evaluate(joints, seen)).sum());
        };
        const VectorXd expected = numerical_jacobian(trace, q).transpose();
        EXPECT_LE((pose.differentiate(q, Z, seen) - expected).norm(), 1e-8 * expected.norm());
    }
}

TEST(PoseInformation, IsNothingWhereNoTargetIsSeen) {
    const Campaign campaign = tracked_campaign(fanuc());
    const PoseInformation pose(campaign, campaign.nominal);
    const SeenTargets none = seen_targets({}, 3);
    const VectorXd q = VectorXd::Constant(6, 0.3);
    EXPECT_EQ(pose.evaluate(q, none), MatrixXd::Zero(33, 33));
    EXPECT_EQ(pose.differentiate(q, MatrixXd::Identity(33, 33), none), VectorXd::Zero(6));
}

TEST(PoseInformation, RefusesRepeatsThatAreNotPositive) {
    const Campaign campaign = tracked_campaign(fanuc());
    EXPECT_THROW(PoseInformation(campaign, campaign.nominal, 0), InputError);
    EXPECT_THROW(PoseInformation(campaign, campaign.nominal, -2), InputError);
}

}  // namespace
}  // namespace posewise
