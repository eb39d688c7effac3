#include "posewise/measurement/point_sensor.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "posewise/core/errors.hpp"
#include "support/campaigns.hpp"
#include "support/derivative_check.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

PointSensor partly_known() {
    return PointSensor({std::nullopt, Vector3d(0.1, 0.2, 0.3), std::nullopt}, 5e-5);
}

/// The sensor's whole identification Jacobian behind the FANUC against differences.
void expect_right_jacobian(const PointSensor& sensor, double magnitude, std::uint64_t item) {
    RandomStream stream(41, item);
    Campaign campaign = tracked_campaign(fanuc());
    campaign.sensor = std::make_shared<PointSensor>(sensor);
    campaign.nominal.sensor =
        random_vector(stream, static_cast<Index>(sensor.unknown_names().size()), magnitude);
    campaign.nominal.robot = random_vector(stream, 18, magnitude);
    const VectorXd q = random_vector(stream, 6, 3);

    FlangeMotion motion;
    campaign.robot.differentiate(campaign.nominal.world_from_base, q, campaign.nominal.robot,
                                 motion);
    RowMatrixXd J = RowMatrixXd::Constant(sensor.row_count(), parameter_count(campaign), 99.0);
    sensor.differentiate(motion.world_from_flange, motion.twists, campaign.nominal.sensor, J);
    const auto predict = [&](const VectorXd& step) {
        const Parameters moved = advance(campaign.nominal, step);
        return sensor.predict(world_from_flange(campaign, moved, q), moved.sensor);
    };
    expect_is_jacobian(J, predict, VectorXd::Zero(parameter_count(campaign)));
}

TEST(PointSensor, JacobianAgreesWithDifferences) {
    const PointSensor unknown({std::nullopt, std::nullopt, std::nullopt}, 5e-5);
    const PointSensor known({Vector3d(0.1, -0.2, 0.3)}, 5e-5);
    for (std::uint64_t item = 0; item < static_cast<std::uint64_t>(sweep_count() / 50); ++item) {
        for (const double magnitude : {0.0, 1e-9, 0.3}) {
            expect_right_jacobian(unknown, magnitude, item);
            expect_right_jacobian(known, magnitude, item);
            expect_right_jacobian(partly_known(), magnitude, item);
        }
    }
}

TEST(PointSensor, PredictsTargetsInTheWorld) {
    Isometry3d flange(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()));
    flange.translation() = Vector3d(1, 2, 3);
    VectorXd unknowns(6);
    unknowns << 0.5, 0, 0, 0, 0, 0.7;
    VectorXd expected(9);
    expected << 1, 2.5, 3, 0.8, 2.1, 3.3, 1, 2, 3.7;
    EXPECT_TRUE(partly_known().predict(flange, unknowns).isApprox(expected, 1e-15));
}

TEST(PointSensor, NamesOnlyUnknownTargets) {
    const PointSensor sensor = partly_known();
    EXPECT_EQ(sensor.unknown_names(),
              (std::vector<std::string>{"target1.x", "target1.y", "target1.z",  //
                                        "target3.x", "target3.y", "target3.z"}));
    EXPECT_EQ(sensor.observation_names().size(), 9U);
    EXPECT_EQ(sensor.observation_names()[4], "p2_y");
    EXPECT_TRUE(sensor.is_known(1));
    EXPECT_EQ(sensor.unknown_offset(1), -1);
    EXPECT_EQ(sensor.unknown_offset(2), 3);
}

TEST(PointSensor, RefusesNoTargetsAndSenselessSigma) {
    EXPECT_THROW(PointSensor({}, 1e-5), InputError);
    for (const double sigma : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(PointSensor({std::nullopt}, sigma), InputError) << sigma;
    }
    const Vector3d nowhere(0, std::numeric_limits<double>::quiet_NaN(), 0);
    EXPECT_THROW(PointSensor({nowhere}, 1e-5), InputError);
}

}  // namespace
}  // namespace posewise
