#include "measurement_columns.hpp"

namespace posewise::io {

std::vector<WantedColumn> wanted_columns(const Campaign& campaign) {
    std::vector<WantedColumn> wanted;
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        wanted.push_back({campaign.robot.joints()[static_cast<std::size_t>(j)].name, Role::Joint, j,
                          quantity_of(campaign.robot.joint_motion(j))});
    }
    Index k = 0;
    for (const std::string& name : campaign.sensor->observation_names()) {
        const Quantity quantity = campaign.sensor->is_angle(k) ? Quantity::Angle : Quantity::Length;
        wanted.push_back({name, Role::Observation, k++, quantity});
    }
    return wanted;
}

}  // namespace posewise::io
