#pragma once

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "support/campaigns.hpp"

/// A robot calibrated before, for what an earlier estimate tells.
namespace posewise::testing {

inline Campaign held_campaign() {
    const Chain bare = without_parameters(fanuc());
    Campaign campaign = with_robot(tracked_campaign(bare), detail::complete_model(bare));
    campaign.spread = population_spread(bare);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 5e-5);
    return campaign;
}

inline Measurements measure_at_random(const Campaign& campaign, const Parameters& truth,
                                      Index count, std::uint64_t seed) {
    return simulate_measurements(
        campaign, truth, detail::random_configurations(campaign.robot, count, seed), 1, seed);
}

inline CalibrationOptions without_folds() {
    CalibrationOptions options;
    options.folds = 0;
    return options;
}

}  // namespace posewise::testing
