#pragma once

#include "../../src/model/halton.hpp"
#include "posewise/planner/planning.hpp"
#include "support/campaigns.hpp"

/// The planning problem of the FANUC's first campaign: 33 parameters, 24 poses.
namespace posewise::testing {

/// The robot with the ranges the campaign's workspace has.
inline Chain fanuc_in_workspace() {
    const double reach[6][2] = {{-90, 90},   {-50, 60},   {-80, 60},
                                {-180, 180}, {-110, 110}, {-180, 180}};
    const Chain robot = fanuc();
    std::vector<Joint> joints = robot.joints();
    for (std::size_t j = 0; j < 6; ++j) {
        joints[j].lower = reach[j][0] * degree;
        joints[j].upper = reach[j][1] * degree;
    }
    return Chain(joints, robot.elements());
}

/// Targets and base as registered, the noise of one observation, no model error.
inline Campaign fanuc_planning_campaign() {
    Campaign campaign = tracked_campaign(fanuc_in_workspace());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), 0.05185e-3);
    campaign.model_error = 0;
    campaign.nominal.world_from_base.setIdentity();
    campaign.nominal.world_from_base.translation() << -0.5576, -0.5632, 0.5614;
    campaign.nominal.sensor << 0.4163, -0.0170, 0.0596, 0.4201, 0.0569, -0.0161, 0.4198, -0.0440,
        -0.0425;
    return campaign;
}

inline RowMatrixXd fanuc_workspace(Index count = 500) {
    return detail::halton_configurations(fanuc_in_workspace(), count,
                                         {{17, 19, 23, 29, 31, 37}, 201, std::nullopt});
}

inline RowMatrixXd fanuc_pool(Index count) {
    return detail::halton_configurations(fanuc_in_workspace(), count,
                                         {{2, 3, 5, 7, 11, 13}, 1, std::nullopt});
}

}  // namespace posewise::testing
