#include <cmath>

#include "campaign_sections.hpp"
#include "text.hpp"

namespace posewise::io {
namespace {

/// Places for targets that the file does not state: a spiral about the flange's x axis, 0.2 to
/// 0.3 m away, no three of them in line.
Vector3d generic_target(std::size_t index) {
    constexpr double golden_angle = 2.399963229728653;
    const auto turns = static_cast<double>(index);
    const double along = 0.15 + 0.1 * std::fmod(0.618 * turns, 1.0);
    return {along, 0.15 * std::cos(golden_angle * turns), 0.15 * std::sin(golden_angle * turns)};
}

std::vector<Vector3d> generic_targets(const YamlValue& count) {
    constexpr std::uint64_t most = 1000;
    const std::uint64_t number = count.natural_number();
    if (number < 1 || number > most) {
        throw count.error("is " + std::to_string(number) + "; must be from 1 to 1000");
    }
    std::vector<Vector3d> targets;
    while (targets.size() < number) targets.push_back(generic_target(targets.size()));
    return targets;
}

std::vector<Vector3d> stated_targets(const YamlMeasure& positions) {
    std::vector<Vector3d> targets;
    for (const YamlValue& item : positions.value.list()) {
        targets.push_back(YamlMeasure{item, positions.unit}.vector_to_si());
    }
    if (targets.empty()) throw positions.value.error("is empty; must list at least one target");
    return targets;
}

/// `sigma_mm`, one number or one for each axis, or `noise`, a laser tracker's.
PointNoise read_noise(const YamlValue& value, const YamlMap& sensor) {
    const auto noise = sensor.find("noise");
    const auto sigma = sensor.find_measure("sigma");
    if (noise.has_value() == sigma.has_value()) {
        throw value.error("must have either sigma_mm or noise");
    }
    if (noise) {
        const YamlMap tracker(*noise, {"range_<length>", "angle_<angle>"});
        return LaserTrackerNoise{read_positive(tracker.require_measure("range")),
                                 read_positive(tracker.require_measure("angle"))};
    }
    if (!sigma->value.is_list()) return IsotropicNoise{read_positive(*sigma)};
    PerAxisNoise axes;
    const std::vector<YamlValue> items = sigma->value.list();
    if (items.size() != 3) throw sigma->value.error("must be one number, or three for x, y and z");
    for (std::size_t k = 0; k < 3; ++k) {
        axes.sigma[static_cast<Index>(k)] = read_positive({items[k], sigma->unit});
    }
    return axes;
}

}  // namespace

SensorSection read_sensor(const YamlValue& value) {
    const YamlMap sensor(value, {"kind", "sigma_<length>", "noise", "targets"});
    const YamlValue kind = sensor.require("kind");
    if (kind.text() != "points") {
        throw kind.error("is " + quote(kind.text()) + "; " + suggest(kind.text(), {"points"}));
    }
    const PointNoise noise = read_noise(value, sensor);
    const YamlValue targets_value = sensor.require("targets");
    const YamlMap targets(targets_value, {"count", "position_<length>", "known"});
    const auto positions = targets.find_measure("position");
    const auto count = targets.find("count");
    if (positions.has_value() == count.has_value()) {
        throw targets_value.error("must have either count or position_mm");
    }
    const auto known = targets.find("known");
    const bool are_known = known && known->boolean();
    if (are_known && !positions) throw known->error("is true; needs position_mm, not count");

    const std::vector<Vector3d> nominal =
        positions ? stated_targets(*positions) : generic_targets(*count);
    SensorSection section;
    section.has_positions = positions.has_value();
    if (are_known) {
        section.sensor = std::make_shared<PointSensor>(
            std::vector<std::optional<Vector3d>>(nominal.begin(), nominal.end()), noise);
        return section;
    }
    section.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(nominal.size()), noise);
    section.unknowns.resize(3 * static_cast<Index>(nominal.size()));
    for (std::size_t j = 0; j < nominal.size(); ++j) {
        section.unknowns.segment<3>(3 * static_cast<Index>(j)) = nominal[j];
    }
    return section;
}

}  // namespace posewise::io
