#include "posewise/measurement/sensor.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "measurement/contact.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/chain.hpp"
#include "support/derivative_check.hpp"
#include "support/sensors.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

/// Parameters somewhere about nominal ones.
Parameters perturbed(const Campaign& campaign, RandomStream& stream, double magnitude) {
    Parameters parameters = campaign.nominal;
    parameters.robot = random_vector(stream, parameters.robot.size(), magnitude);
    parameters.sensor += random_vector(stream, parameters.sensor.size(), magnitude);
    return parameters;
}

TEST(EverySensor, HasTheJacobianOfItsPredictionAndOfItsPositions) {
    for (const auto& [name, campaign] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        const Sensor& sensor = *campaign.sensor;
        const Index L = parameter_count(campaign);
        for (Index item = 0; item < std::max<Index>(1, sweep_count() / 100); ++item) {
            RandomStream stream(41, static_cast<std::uint64_t>(item));
            for (const double magnitude : {0.0, 1e-9, 0.1}) {
                const Parameters at = perturbed(campaign, stream, magnitude);
                VectorXd q = random_vector(stream, 6, 3);
                if (sensor.has_view()) {  // not with a corner in the plane of the lens
                    q = detail::viewed_poses(campaign, at, 1, static_cast<std::uint64_t>(item))
                            .configurations.row(0)
                            .transpose();
                }
                FlangeMotion motion;
                differentiate_flange(campaign, at, q, motion);
                RowMatrixXd J = RowMatrixXd::Constant(sensor.row_count(), L, 99.0);
                sensor.differentiate(motion.world_from_flange, motion.twists, at.sensor, J);
                const VectorXd reference = sensor.predict(motion.world_from_flange, at.sensor);
                expect_is_jacobian(
                    J,
                    [&](const VectorXd& step) {
                        const Parameters moved = advance(campaign, at, step);
                        return sensor.deviation(
                            sensor.predict(world_from_flange(campaign, moved, q), moved.sensor),
                            reference);
                    },
                    VectorXd::Zero(L));

                RowMatrixXd J_positions = RowMatrixXd::Constant(3 * sensor.target_count(), L, 99.0);
                sensor.differentiate_positions(motion.world_from_flange, motion.twists, at.sensor,
                                               J_positions);
                const auto positions = [&](const VectorXd& step) {
                    const Parameters moved = advance(campaign, at, step);
                    const Isometry3d flange = world_from_flange(campaign, moved, q);
                    VectorXd all(3 * sensor.target_count());
                    for (Index j = 0; j < sensor.target_count(); ++j) {
                        all.segment<3>(3 * j) = flange * sensor.target_position(j, moved.sensor);
                    }
                    return all;
                };
                expect_is_jacobian(J_positions, positions, VectorXd::Zero(L));
            }
        }
    }
}

TEST(EverySensor, NamesItsNumbersAndUnknowns) {
    for (const auto& [name, campaign] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        const Sensor& sensor = *campaign.sensor;
        EXPECT_EQ(static_cast<Index>(sensor.observation_names().size()), sensor.row_count());
        EXPECT_EQ(static_cast<Index>(sensor.unknown_names().size()),
                  campaign.nominal.sensor.size());
        EXPECT_EQ(sensor.unknown_is_angle().size(), sensor.unknown_names().size());
        EXPECT_EQ(sensor.first_row(sensor.target_count()), sensor.row_count());
        for (Index row = 0; row < sensor.row_count(); ++row) {
            const Index target = sensor.target_of(row);
            EXPECT_GE(row, sensor.first_row(target));
            EXPECT_LT(row, sensor.first_row(target + 1));
            EXPECT_EQ(sensor.column_of(row) < sensor.lengths_per_target(), !sensor.is_angle(row));
        }
    }
}

TEST(EverySensor, DeviatesByWhatItDeviated) {
    for (const auto& [name, campaign] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        const Sensor& sensor = *campaign.sensor;
        RandomStream stream(43);
        const Isometry3d flange = random_pose(stream);
        const VectorXd expected = sensor.predict(flange, campaign.nominal.sensor);
        const VectorXd step = random_vector(stream, sensor.row_count(), 0.5);
        const VectorXd observed = sensor.deviate(expected, step);
        EXPECT_LT((sensor.deviation(observed, expected) - step).norm(),
                  1e-14 * (1 + expected.norm()));
        EXPECT_LT(sensor.deviation(expected, expected).norm(), 1e-14);
    }
}

TEST(EverySensor, ChangesWithThePoseAsTheDifferencesSayThatAreTheDefault) {
    for (const auto& [name, campaign] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        const Sensor& sensor = *campaign.sensor;
        const VectorXd& unknowns = campaign.nominal.sensor;
        RandomStream stream(46);
        FlangeMotion motion;
        std::vector<FlangeMotionRate> rates;
        differentiate_flange_twice(campaign, campaign.nominal, random_vector(stream, 6, 1), motion,
                                   rates);
        const Isometry3d& flange = motion.world_from_flange;
        for (Index joint = 0; joint < 6; ++joint) {
            const Twist direction = motion.joint_twists.col(joint);
            const TwistMatrix& twist_rates = rates[static_cast<std::size_t>(joint)].twists;
            RowMatrixXd own(sensor.row_count(), parameter_count(campaign));
            RowMatrixXd by_differences = own;
            sensor.differentiate_along(flange, motion.twists, direction, twist_rates, unknowns,
                                       own);
            sensor.Sensor::differentiate_along(flange, motion.twists, direction, twist_rates,
                                               unknowns, by_differences);
            EXPECT_LE((own - by_differences).norm(), 1e-10 * own.norm());
            const MatrixXd rate = sensor.covariance_rate(flange, direction, unknowns);
            EXPECT_LE((rate - sensor.Sensor::covariance_rate(flange, direction, unknowns)).norm(),
                      1e-10 * sensor.covariance(flange, unknowns).norm());
        }
    }
}

TEST(EverySensor, SaysWhatItsNoiseIsAndWhatMessagesCallIt) {
    for (const auto& [name, campaign] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        const Sensor& sensor = *campaign.sensor;
        EXPECT_FALSE(sensor.noise_numbers().empty());
        for (const NoiseNumber& number : sensor.noise_numbers()) {
            EXPECT_TRUE(number.values.size() == 1 || number.values.size() == 3) << number.name;
        }
        const SensorWords words = sensor.words();
        for (const std::string& word :
             {words.readings, words.place, words.unknowns, words.key, words.sentence}) {
            EXPECT_FALSE(word.empty());
        }
        EXPECT_EQ(words.known.front(),
                  sensor.needs_first_guess() ? "base.known" : "sensor.known_sockets");
        EXPECT_EQ(sensor.observes_targets(), words.readings == "points" && !sensor.is_combined());
    }
}

TEST(PoseSensor, NamesEachOfItsNoiseNumbers) {
    const PoseSensor sensor(std::nullopt, LaserTrackerNoise{1e-5, 2e-5, Vector3d(1, 2, 3)}, 1e-4);
    std::vector<std::string> names;
    for (const NoiseNumber& number : sensor.noise_numbers()) names.push_back(number.name);
    EXPECT_EQ(names, (std::vector<std::string>{"range_sigma_m", "angle_sigma_rad",
                                               "tracker_position_m", "sigma_orientation_rad"}));
    EXPECT_EQ(sensor.noise_numbers()[2].values, (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(sensor.words().sentence,
              "poses of a tool (to be identified), laser tracker with sigma 10 um in range and 20 "
              "urad in angle and 0.1 mrad in orientation");
}

TEST(PoseSensor, ObservesToolsPositionAndRotationVector) {
    Isometry3d tool(Eigen::AngleAxisd(0.5, Vector3d::UnitX()));
    tool.translation() = Vector3d(0, 0, 0.1);
    const PoseSensor sensor(tool, IsotropicNoise{1e-5}, 1e-4);
    Isometry3d flange(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()));
    flange.translation() = Vector3d(1, 2, 3);
    VectorXd expected(6);
    expected << 1, 1.9, 3, std::numbers::pi / 2 + 0.5, 0, 0;
    EXPECT_TRUE(sensor.predict(flange, VectorXd()).isApprox(expected, 1e-14));
}

TEST(PoseSensor, HasTheNoiseOfACameraOnTheFlange) {
    const Vector3d sigma(2e-4, 3e-4, 9e-4);
    const double sigma_orientation = 7e-4;
    const PoseSensor sensor(std::nullopt, PerAxisNoise{sigma}, sigma_orientation, {true, true});
    Isometry3d flange(rotation_from_vector(Vector3d(0.4, -1.1, 0.7)));
    flange.translation() = Vector3d(0.5, -0.2, 0.9);
    VectorXd tool(6);
    tool << 0.03, 0.05, 0.06, 0.2, -0.1, 0.4;
    const VectorXd observation = sensor.predict(flange, tool);
    RowMatrixXd seen = observation.transpose();
    invert_poses(seen);
    // Errors of what the camera sees, along its axes, and what they make of the observation.
    const auto observe = [&](const VectorXd& error) -> VectorXd {
        RowMatrixXd pose = seen;
        pose.row(0).head<3>() += error.head<3>().transpose();
        pose.row(0).tail<3>() =
            vector_from_rotation(rotation_from_vector(error.tail<3>()) *
                                 rotation_from_vector(seen.row(0).tail<3>().transpose()))
                .transpose();
        invert_poses(pose);
        return sensor.deviation(pose.row(0).transpose(), observation);
    };
    MatrixXd J(6, 6);
    for (Index k = 0; k < 6; ++k) {
        const VectorXd step = 1e-5 * VectorXd::Unit(6, k);
        J.col(k) = (observe(step) - observe(-step)) / 2e-5;
    }
    VectorXd variances(6);
    variances << sigma.cwiseAbs2(), Vector3d::Constant(sigma_orientation * sigma_orientation);
    const MatrixXd expected = J * variances.asDiagonal() * J.transpose();
    EXPECT_LT((sensor.covariance(flange, tool) - expected).norm(), 1e-8 * expected.norm());
    EXPECT_THROW(PoseSensor(std::nullopt, LaserTrackerNoise{1e-5, 2e-5}, 1e-4, {true, true}),
                 InputError);
}

TEST(PoseSensor, InvertsPosesThereAndBack) {
    RowMatrixXd poses(2, 6);
    poses << 1, 2, 3, 0.1, 0.2, -3, -4, 0, 0.5, 0, 0, 0;
    RowMatrixXd inverted(2, 6);
    inverted = poses;
    invert_poses(inverted);
    EXPECT_EQ(inverted.row(1).head<3>(), -poses.row(1).head<3>());
    EXPECT_EQ(inverted.rightCols<3>(), -poses.rightCols<3>());
    invert_poses(inverted);
    EXPECT_LT((inverted - poses).norm(), 1e-14);
}

TEST(PoseSensor, MeasuresTheShortWayRoundAtHalfATurn) {
    const PoseSensor sensor(std::nullopt, IsotropicNoise{1e-5}, 1e-4);
    VectorXd a = VectorXd::Zero(6);
    VectorXd b = a;
    a[5] = std::numbers::pi - 1e-3;
    b[5] = -std::numbers::pi + 1e-3;
    EXPECT_NEAR(sensor.deviation(b, a)[5], 2e-3, 1e-12);
}

TEST(PoseSensor, AveragesOrientationsAcrossHalfATurn) {
    const PoseSensor sensor(std::nullopt, IsotropicNoise{1e-5}, 1e-4);
    Measurements measurements;
    measurements.configurations = RowMatrixXd::Zero(1, 1);
    measurements.ids = {"a"};
    measurements.first_sample = {0, 2};
    measurements.observations = RowMatrixXd::Zero(2, 6);
    measurements.observations(0, 0) = 2e-3;
    measurements.observations(0, 5) = std::numbers::pi - 1e-3;
    measurements.observations(1, 5) = -std::numbers::pi + 3e-3;
    measurements.is_seen.setConstant(2, 1, true);
    const auto means = mean_measurements(sensor, measurements);
    EXPECT_NEAR(means.observations(0, 0), 1e-3, 1e-15);
    EXPECT_NEAR(std::abs(means.observations(0, 5)), std::numbers::pi - 1e-3, 1e-12);
    const auto spread = repeatability(sensor, measurements);
    ASSERT_TRUE(spread.has_value());
    EXPECT_NEAR(spread->length, std::sqrt(2e-6 / 3), 1e-12);
    EXPECT_NEAR(spread->orientation, std::sqrt(8e-6 / 3), 1e-9);
}

TEST(DistanceSensor, MeasuresFromItsAnchor) {
    const DistanceSensor sensor(Targets({Vector3d(0, 0, 0)}), {Vector3d(1, 0, 0), {0, 0, 5}}, true,
                                1e-5);
    Isometry3d flange = Isometry3d::Identity();
    flange.translation() = Vector3d(1, 3, 4);
    EXPECT_TRUE(sensor.predict(flange, VectorXd()).isApprox(Eigen::Vector2d(5, std::sqrt(11))));
    EXPECT_EQ(sensor.observation_names(), (std::vector<std::string>{"p1_a1", "p1_a2"}));
}

TEST(PlaneSensor, IsPositiveWhereTheNormalPoints) {
    const PlaneSensor sensor(Targets({Vector3d(0, 0, 0.5)}), {{{0, 0, 2}, 1, true, true}}, 1e-5);
    Isometry3d flange = Isometry3d::Identity();
    flange.translation() = Vector3d(1, 3, 4);
    EXPECT_DOUBLE_EQ(sensor.predict(flange, VectorXd())[0], 3.5);
}

TEST(PlaneSensor, LeavesUnknownWhatIsNotKnownOfEachPlane) {
    const PlaneSensor sensor(
        Targets({Vector3d(0, 0, 0.5)}),
        {{{0, 0, 2}, 1, true, false}, {{1, 0, 0}, 2, false, true}, {{0, 1, 0}, 3}}, 1e-5);
    EXPECT_EQ(sensor.unknown_names(),
              (std::vector<std::string>{"plane1.offset", "plane2.tilt1", "plane2.tilt2",
                                        "plane3.tilt1", "plane3.tilt2", "plane3.offset"}));
    EXPECT_EQ(sensor.unknown_is_angle(), (std::vector<bool>{false, true, true, true, true, false}));
    VectorXd unknowns(6);
    unknowns << 1.5, 0, 0, 0.1, 0, 2.5;
    const Plane first = sensor.plane(0, unknowns);
    EXPECT_EQ(first.normal, Vector3d::UnitZ());
    EXPECT_EQ(first.offset, 1.5);
    EXPECT_EQ(sensor.plane(1, unknowns).offset, 2);
    EXPECT_NEAR(sensor.plane(2, unknowns).normal.dot(Vector3d::UnitY()), std::cos(0.1), 1e-15);
    EXPECT_NE(sensor.words().sentence.find("3 planes (known in part)"), std::string::npos)
        << sensor.words().sentence;
}

TEST(Sensors, RefuseWhatIsNoSensor) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Targets one({std::nullopt});
    EXPECT_THROW(PoseSensor(std::nullopt, IsotropicNoise{1e-5}, 0), InputError);
    EXPECT_THROW(PoseSensor(std::nullopt, IsotropicNoise{nan}, 1e-4), InputError);
    EXPECT_THROW(DistanceSensor(one, {}, true, 1e-5), InputError);
    EXPECT_THROW(DistanceSensor(one, {Vector3d(0, nan, 0)}, true, 1e-5), InputError);
    EXPECT_THROW(DistanceSensor(one, {Vector3d::Zero()}, true, nan), InputError);
    EXPECT_THROW(PlaneSensor(one, {{Vector3d::Zero(), 0}}, 1e-5), InputError);
    EXPECT_THROW(PlaneSensor(one, {{Vector3d::UnitZ(), nan}}, 1e-5), InputError);
    EXPECT_THROW(PlaneSensor(one, {}, 1e-5), InputError);
}

TEST(RotationVectors, AreThereAndBack) {
    RandomStream stream(44);
    for (Index i = 0; i < sweep_count(); ++i) {
        const Matrix3d R = random_pose(stream).linear();
        const Vector3d vector = vector_from_rotation(R);
        EXPECT_LE(vector.norm(), std::numbers::pi);
        EXPECT_LT((rotation_from_vector(vector) - R).norm(), 1e-14);
        const Vector3d step = random_vector(stream, 3, 1e-6);
        const Vector3d turned =
            vector_from_rotation(rotation_from_vector(vector + step) * R.transpose());
        EXPECT_LT((turned - rotation_vector_rate(vector) * step).norm(), 1e-11);
    }
}

}  // namespace
}  // namespace posewise
