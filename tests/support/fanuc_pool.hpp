#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "../../src/model/sampling.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/robots.hpp"

namespace posewise::testing {

/// Random poses of the FANUC robot with three targets: 9 rows, 33 parameters each.
inline Blocks fanuc_pool(Index count, std::uint64_t seed) {
    Campaign campaign;
    campaign.robot = fanuc();
    campaign.sensor = std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3), 5e-5);
    campaign.nominal.world_from_base.translation() = Vector3d(2, -1, 0.3);
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    campaign.nominal.sensor.resize(9);
    campaign.nominal.sensor << 0.28, 0.05, 0.1, 0.2, -0.15, 0.08, 0.15, 0.1, -0.2;
    return make_blocks(campaign, campaign.nominal,
                       detail::random_configurations(campaign.robot, count, seed));
}

}  // namespace posewise::testing
