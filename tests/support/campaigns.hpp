#pragma once

#include <limits>
#include <memory>

#include "posewise/core/random.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/robots.hpp"

namespace posewise::testing {

/// A robot in front of an instrument (sigma 0.05 mm) that sees three unknown targets on the flange.
inline Campaign tracked_campaign(Chain robot) {
    Campaign campaign;
    campaign.name = "tracked";
    campaign.robot = std::move(robot);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 5e-5);
    campaign.nominal.world_from_base = Eigen::Translation3d(2.5, -1.0, 0.4) *
                                       Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized());
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    campaign.nominal.sensor.resize(9);
    campaign.nominal.sensor << 0.28, 0.05, -0.11, 0.30, -0.09, 0.06, 0.26, 0.08, 0.12;
    campaign.has_nominal_base = true;
    campaign.has_nominal_targets = true;
    return campaign;
}

/// Takes this share of all targets out of the samples, at random, and leaves NaN in their place.
inline void hide_at_random(Measurements& measurements, double share, std::uint64_t seed) {
    RandomStream stream(seed);
    const Index width = measurements.observations.cols() / measurements.is_seen.cols();
    for (Index sample = 0; sample < measurements.is_seen.rows(); ++sample) {
        for (Index target = 0; target < measurements.is_seen.cols(); ++target) {
            if (stream.uniform() >= share) continue;
            measurements.is_seen(sample, target) = false;
            measurements.observations.row(sample)
                .segment(width * target, width)
                .setConstant(std::numeric_limits<double>::quiet_NaN());
        }
    }
}

}  // namespace posewise::testing
