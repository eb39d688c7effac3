#pragma once

#include "posewise/measurement/campaign.hpp"

namespace posewise::testing {

/// Estimated minus true parameters as advance() takes them, nothing of the base known.
inline VectorXd error_of(const Parameters& estimate, const Parameters& truth) {
    VectorXd error(6 + truth.robot.size() + truth.sensor.size());
    const Eigen::AngleAxisd turn(
        Matrix3d(estimate.world_from_base.linear() * truth.world_from_base.linear().transpose()));
    error << estimate.world_from_base.translation() - truth.world_from_base.translation(),
        turn.angle() * turn.axis(), estimate.robot - truth.robot, estimate.sensor - truth.sensor;
    return error;
}

}  // namespace posewise::testing
