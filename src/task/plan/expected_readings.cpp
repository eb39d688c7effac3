#include "posewise/measurement/measurements.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {

Measurements expected_readings(const Campaign& campaign, const Plan& plan) {
    const Sensor& sensor = *campaign.sensor;
    const Index count = std::ssize(plan.poses);
    Measurements expected;
    expected.observations.resize(count, sensor.row_count());
    expected.is_seen = all_seen(count, sensor.target_count());
    for (const PlannedPose& pose : plan.poses) {
        const Index i = std::ssize(expected.ids);
        if (i == 0) expected.configurations.resize(count, pose.configuration.size());
        expected.configurations.row(i) = pose.configuration.transpose();
        expected.observations.row(i) =
            sensor
                .predict(world_from_flange(campaign, campaign.nominal, pose.configuration),
                         campaign.nominal.sensor)
                .transpose();
        if (!pose.targets.empty()) {
            expected.is_seen.row(i) = seen_targets(pose.targets, sensor.target_count());
        }
        expected.ids.push_back(pose.id);
        expected.first_sample.push_back(i + 1);
    }
    return expected;
}

}  // namespace posewise
