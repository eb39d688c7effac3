#include "measurement_columns.hpp"

#include <fmt/format.h>

#include <iterator>
#include <numbers>

namespace posewise::io {
namespace {

bool turns(const Campaign& campaign, Index joint) {
    return campaign.robot.joint_motion(joint) == Motion::Rotation;
}

}  // namespace

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

double for_people(const Campaign& campaign, Index joint, double value) {
    return turns(campaign, joint) ? value * 180 / std::numbers::pi : 1e3 * value;
}

std::string joint_header(const Campaign& campaign) {
    std::string text;
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        fmt::format_to(std::back_inserter(text), ",{}{}",
                       campaign.robot.joints()[static_cast<std::size_t>(j)].name,
                       turns(campaign, j) ? "_deg" : "_mm");
    }
    return text;
}

std::string joint_cells(const Campaign& campaign, const VectorXd& q) {
    std::string text;
    for (Index j = 0; j < q.size(); ++j) {
        fmt::format_to(std::back_inserter(text), ",{}", for_people(campaign, j, q[j]));
    }
    return text;
}

}  // namespace posewise::io
