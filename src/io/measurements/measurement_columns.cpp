#include "measurement_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {
namespace {

const Joint& joint_of(const Chain& robot, const MeasuredTorque& torque) {
    return robot.joints()[static_cast<std::size_t>(torque.joint)];
}

}  // namespace

std::string WantedColumn::example() const {
    switch (quantity) {
        case Quantity::Angle:
            return stem + "_rad";
        case Quantity::Length:
            return stem + "_mm";
        case Quantity::Pixel:
            return stem + "_px";
        case Quantity::Torque:
            break;
    }
    return stem + "_Nm";
}

std::string torque_stem(const Joint& joint) { return "tau_" + joint.name; }

Quantity quantity_of_row(const Sensor& sensor, Index row) {
    if (!sensor.is_angle(row)) return Quantity::Length;
    return sensor.has_pixels() ? Quantity::Pixel : Quantity::Angle;
}

std::vector<WantedColumn> wanted_columns(const Campaign& campaign, Form form) {
    const Chain& robot = campaign.robot;
    std::vector<WantedColumn> wanted;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        wanted.push_back({robot.joints()[static_cast<std::size_t>(j)].name, Role::Joint, j,
                          quantity_of(robot.joint(j).motion)});
    }
    Index next = robot.joint_count();
    for (const MeasuredTorque& torque : robot.torques()) {
        wanted.push_back(
            {torque_stem(joint_of(robot, torque)), Role::Joint, next++, Quantity::Torque});
    }
    if (campaign.sensor->has_contacts()) return wanted;
    if (form == Form::RowEachCorner) {
        wanted.push_back({"u", Role::Observation, 0, Quantity::Pixel});
        wanted.push_back({"v", Role::Observation, 1, Quantity::Pixel});
        return wanted;
    }
    Index k = 0;
    for (const std::string& name : campaign.sensor->observation_names()) {
        wanted.push_back({name, Role::Observation, k, quantity_of_row(*campaign.sensor, k)});
        ++k;
    }
    return wanted;
}

std::vector<CornerSensor> corner_sensors(const Sensor& sensor) {
    const auto* const combined = dynamic_cast<const CombinedSensor*>(&sensor);
    if (combined == nullptr) return {{&sensor, 0}};
    std::vector<CornerSensor> sensors;
    for (Index k = 0; k < combined->part_count(); ++k) {
        sensors.push_back({combined->part(k).sensor.get(), combined->first_target(k)});
    }
    return sensors;
}

std::size_t sensor_of(const std::vector<CornerSensor>& sensors, Index target) {
    std::size_t of = sensors.size() - 1;
    while (sensors[of].first_target > target) --of;
    return of;
}

std::vector<std::string_view> corner_columns(const Sensor& sensor) {
    const auto sensors = corner_sensors(sensor);
    std::vector<std::string_view> names{point_column};
    const auto has_several = [](const CornerSensor& one) { return one.cameras() > 1; };
    if (std::ranges::any_of(sensors, has_several)) names.push_back(camera_column);
    if (sensors.size() > 1) names.push_back(sensor_column);
    return names;
}

double for_people(const Campaign& campaign, Index joint, double value) {
    if (joint >= campaign.robot.joint_count()) return value;
    return units_of(campaign.robot.joint(joint).motion).to_reading(value);
}

std::vector<std::string> reading_columns(const Campaign& campaign) {
    std::vector<std::string> names;
    for (const WantedColumn& column : wanted_columns(campaign)) {
        if (column.role != Role::Joint) continue;
        names.push_back(column.quantity == Quantity::Angle ? column.stem + "_deg"
                                                           : column.example());
    }
    return names;
}

std::string joint_header(const Campaign& campaign) {
    std::string text;
    for (const std::string& name : reading_columns(campaign)) text += ',' + name;
    return text;
}

std::string joint_cells(const Campaign& campaign, const VectorXd& q) {
    std::string text;
    for (Index j = 0; j < q.size(); ++j) {
        fmt::format_to(std::back_inserter(text), ",{:.12g}", for_people(campaign, j, q[j]));
    }
    return text;
}

std::string_view seen_header(const Campaign& campaign) {
    return campaign.sensor->has_contacts() ? contact : visible_targets;
}

std::string seen_cell(const Campaign& campaign, const SeenTargets& is_seen) {
    const std::vector<std::string> names = campaign.sensor->contact_names();
    if (names.empty()) return target_numbers(is_seen);
    return names[static_cast<std::size_t>(targets_seen(is_seen).front())];
}

}  // namespace posewise::detail
