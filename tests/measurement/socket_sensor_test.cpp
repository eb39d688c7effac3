#include <gtest/gtest.h>

#include <cmath>

#include "../../src/measurement/contact.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

using testing::campaigns_of_every_sensor;
using testing::fanuc;

Campaign with_sockets(const std::string& name) {
    for (const auto& [sensor, campaign] : campaigns_of_every_sensor(fanuc())) {
        if (sensor == name) return campaign;
    }
    throw InputError("no such campaign: " + name);
}

const SocketSensor& sensor_of(const Campaign& campaign) {
    return dynamic_cast<const SocketSensor&>(*campaign.sensor);
}

TEST(SocketSensor, HasThreeUnknownsASocketAndTwoWhereADistanceIsKnown) {
    EXPECT_EQ(with_sockets("unknown sockets").sensor->unknown_names(),
              (std::vector<std::string>{"target1.x", "target1.y", "target1.z", "socket.s0.x",
                                        "socket.s0.y", "socket.s0.z", "socket.s1.x", "socket.s1.y",
                                        "socket.s1.z", "socket.s2.tilt1", "socket.s2.tilt2"}));
    EXPECT_EQ(with_sockets("known sockets").sensor->unknown_names().size(), 3U);
}

TEST(SocketSensor, KeepsTheDistanceWhateverTheTilts) {
    const Campaign campaign = with_sockets("unknown sockets");
    const SocketSensor& sensor = sensor_of(campaign);
    for (const double tilt : {0.0, 0.7, -2.5}) {
        VectorXd unknowns = campaign.nominal.sensor;
        unknowns.tail<2>() << tilt, 0.4;
        EXPECT_NEAR(
            (sensor.socket_position(2, unknowns) - sensor.socket_position(1, unknowns)).norm(), 0.3,
            1e-15);
    }
}

TEST(SocketSensor, RefusesWhatCannotBe) {
    const Targets ball(std::vector<std::optional<Vector3d>>{std::nullopt});
    const Targets two(std::vector<std::optional<Vector3d>>(2));
    const Socket a{"a", Vector3d(1, 0, 0)};
    const auto make = [](const Targets& targets, const std::vector<Socket>& sockets) {
        return SocketSensor(targets, sockets, false, 1e-4);
    };
    EXPECT_NO_THROW(make(ball, {a, {"b", Vector3d(1, 1, 0), 0, 0.2}}));
    EXPECT_THROW(make(two, {a}), InputError);
    EXPECT_THROW(make(ball, {}), InputError);
    EXPECT_THROW(make(ball, {a, a}), InputError);
    EXPECT_THROW(make(ball, {{""}}), InputError);
    EXPECT_THROW(make(ball, {a, {"b", Vector3d(1, 0, 0), 0, 0.2}}), InputError);
    EXPECT_THROW(make(ball, {a, {"b", Vector3d(1, 1, 0), 1, 0.2}}), InputError);
    EXPECT_THROW(make(ball, {a, {"b", Vector3d(1, 1, 0), 0, 0}}), InputError);
    EXPECT_THROW(SocketSensor(ball, {a}, false, 0), InputError);
}

TEST(Contact, IsReachedByRandomPosesWithinTheLimits) {
    for (const std::string name : {"known sockets", "unknown sockets"}) {
        const Campaign campaign = with_sockets(name);
        const auto poses = detail::random_poses(campaign, campaign.nominal, 60, 3);
        ASSERT_EQ(poses.configurations.rows(), 60);
        for (Index i = 0; i < 60; ++i) {
            const VectorXd q = poses.configurations.row(i).transpose();
            ASSERT_EQ(poses.is_seen.row(i).count(), 1);
            const Index socket = targets_seen(poses.is_seen.row(i)).front();
            const VectorXd readings = campaign.sensor->predict(
                world_from_flange(campaign, campaign.nominal, q), campaign.nominal.sensor);
            EXPECT_LT(readings.segment<3>(3 * socket).norm(), 1e-11);
            for (Index j = 0; j < 6; ++j) {
                const Joint& joint = campaign.robot.joints()[static_cast<std::size_t>(j)];
                EXPECT_GE(q[j], joint.lower);
                EXPECT_LE(q[j], joint.upper);
            }
        }
        EXPECT_TRUE((poses.is_seen.colwise().count() > 5).all());
    }
}

TEST(Contact, OutOfReachIsSaid) {
    Campaign campaign = with_sockets("unknown sockets");
    campaign.nominal.sensor[3] += 50;
    campaign.nominal.sensor[6] += 50;
    EXPECT_THROW(detail::random_poses(campaign, campaign.nominal, 10, 3), InputError);
}

TEST(Contact, IsSimulatedByTheJointsThatTouch) {
    Campaign campaign = with_sockets("unknown sockets");
    campaign.model_error = 0;
    const Simulation simulated = simulate(campaign, {.pose_count = 400, .truth_seed = 2});
    EXPECT_TRUE(simulated.measurements.observations.isZero(0));
    EXPECT_TRUE((simulated.measurements.is_seen.rowwise().count() == 1).all());
    double squares = 0;
    for (Index i = 0; i < 400; ++i) {
        const Isometry3d flange = world_from_flange(
            campaign, simulated.truth, simulated.measurements.configurations.row(i).transpose());
        const VectorXd readings = campaign.sensor->predict(flange, simulated.truth.sensor);
        const Index socket = targets_seen(simulated.measurements.is_seen.row(i)).front();
        squares += readings.segment<3>(3 * socket).squaredNorm();
    }
    EXPECT_NEAR(std::sqrt(squares / 1200), 5e-5, 4e-6);
    EXPECT_THROW(simulate(campaign, {.pose_count = 5, .repeats = 2}), InputError);
}

}  // namespace
}  // namespace posewise
