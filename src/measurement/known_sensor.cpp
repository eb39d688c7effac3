#include "known_sensor.hpp"

#include "posewise/measurement/sensors.hpp"

namespace posewise::detail {
namespace {

Targets known_targets(const Targets& targets, const VectorXd& unknowns) {
    std::vector<std::optional<Vector3d>> positions;
    for (Index j = 0; j < targets.count(); ++j) positions.push_back(targets.position(j, unknowns));
    return Targets(positions);
}

/// Each part with its unknowns known, where its frame is, too.
std::shared_ptr<const Sensor> known_parts(const CombinedSensor& combined,
                                          const VectorXd& unknowns) {
    std::vector<SensorPart> parts;
    for (Index k = 0; k < combined.part_count(); ++k) {
        std::shared_ptr<const Sensor> sensor = combined.part(k).sensor;
        const VectorXd own = combined.unknowns_of(k, unknowns);
        if (own.size() > 0) sensor = std::make_shared<KnownSensor>(sensor, own);
        parts.push_back({std::move(sensor), combined.frame(k, unknowns)});
    }
    return std::make_shared<CombinedSensor>(std::move(parts));
}

}  // namespace

KnownSensor::KnownSensor(std::shared_ptr<const Sensor> sensor, VectorXd unknowns)
    : sensor_(std::move(sensor)),
      unknowns_(std::move(unknowns)),
      targets_(known_targets(sensor_->targets(), unknowns_)) {}

SensorWords KnownSensor::words() const {
    SensorWords words = sensor_->words();
    const std::pair<std::string, std::string> changes[] = {
        {describe(sensor_->targets()), describe(targets_)},
        {"(to be identified)", "(known)"},
        {"(known in part)", "(known)"}};
    for (const auto& [open, known] : changes) {
        const auto place = words.sentence.find(open);
        if (place != std::string::npos) words.sentence.replace(place, open.size(), known);
    }
    return words;
}

std::optional<ObservedPoints> KnownSensor::observed_points() const {
    const std::optional<ObservedPoints> observed = sensor_->observed_points();
    if (!observed) return std::nullopt;
    // Where they are in the flange is what would be observed with the flange in the world's origin.
    const VectorXd in_flange =
        observed->in_flange
            ? observed->in_flange(unknowns_)
            : observed->positions(sensor_->predict(Isometry3d::Identity(), unknowns_),
                                  SeenTargets::Constant(target_count(), true));
    std::vector<std::optional<Vector3d>> points;
    for (Index k = 0; k < observed->points.count(); ++k) {
        points.emplace_back(in_flange.segment<3>(3 * k));
    }
    return ObservedPoints{Targets(points),
                          observed->positions,
                          [](const VectorXd& coordinates) { return coordinates; },
                          {}};
}

Campaign with_known_sensor(Campaign campaign, const VectorXd& unknowns) {
    if (unknowns.size() == 0) return campaign;
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    campaign.sensor = combined != nullptr
                          ? known_parts(*combined, unknowns)
                          : std::make_shared<KnownSensor>(campaign.sensor, unknowns);
    campaign.nominal.sensor.resize(0);
    campaign.has_nominal_targets = true;
    return campaign;
}

}  // namespace posewise::detail
