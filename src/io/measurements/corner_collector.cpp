#include "corner_collector.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/text.hpp"
#include "measurement_columns.hpp"

namespace posewise::detail {
namespace {

/// "7", or of several cameras "7 of camera 2", of several sensors "7 of sensor 2".
std::string name_of_corner(const Sensor& sensor, Index target) {
    const auto sensors = corner_sensors(sensor);
    const std::size_t of = sensor_of(sensors, target);
    const CornerSensor& one = sensors[of];
    const Index own = target - one.first_target;
    std::string name = std::to_string(first_corner(*one.sensor) + own % one.corners());
    if (one.cameras() > 1) name += fmt::format(" of camera {}", own / one.corners() + 1);
    if (sensors.size() > 1) name += fmt::format(" of sensor {}", of + 1);
    return name;
}

}  // namespace

void CornerCollector::add(const Corner& corner) {
    const auto [found, is_new] = index_of_.emplace(corner.id + '\n' + corner.name, samples_.size());
    if (is_new) {
        const Sensor& sensor = *campaign_.sensor;
        samples_.push_back({corner.id, corner.name, corner.joints,
                            VectorXd::Zero(sensor.row_count()),
                            SeenTargets::Constant(sensor.target_count(), false)});
        locations_.push_back(corner.locations);
    }
    Sample& sample = samples_[found->second];
    constexpr double tolerance = 1e-6;  // rad or m
    Index joint = 0;
    if ((corner.joints - sample.joints).cwiseAbs().maxCoeff(&joint) > tolerance) {
        throw input_error_at(
            corner.locations[static_cast<std::size_t>(joint)],
            fmt::format("configuration {} has other joint values in line {}; corners of one view "
                        "must have the same, within 1e-6 (rad or m)",
                        quote(corner.id), locations_[found->second].front().line));
    }
    if (sample.is_seen[corner.number]) {
        throw input_error_at(
            corner.locations.front(),
            fmt::format("corner {} of configuration {} occurs twice{}; keep one",
                        name_of_corner(*campaign_.sensor, corner.number), quote(corner.id),
                        corner.name.empty() ? " (views of one pose need a column sample)"
                                            : " in sample " + quote(corner.name)));
    }
    sample.is_seen[corner.number] = true;
    sample.observation.segment<2>(2 * corner.number) = corner.place;
}

void CornerCollector::add_to(SampleCollector& samples) const {
    for (std::size_t k = 0; k < samples_.size(); ++k) {
        samples.add(samples_[k],
                    [&](Index joint) { return locations_[k][static_cast<std::size_t>(joint)]; });
    }
}

}  // namespace posewise::detail
