#include "part_alone.hpp"

namespace posewise::detail {

PartAlone take_part(const Campaign& campaign, const CombinedSensor& combined, Index part,
                    const Measurements& measurements, const Parameters& registered) {
    const SensorPart& stated = combined.part(part);
    PartAlone alone{campaign, measurements, combined.parameters_of(part, registered), part};
    alone.campaign.sensor = stated.sensor;
    alone.campaign.prior.reset();
    alone.campaign.nominal = combined.parameters_of(part, campaign.nominal);
    alone.campaign.has_nominal_targets = stated.has_nominal_unknowns;
    const bool is_same =
        stated.known_frame && stated.known_frame->isApprox(Isometry3d::Identity(), 0);
    if (!is_same) alone.campaign.base_is_known.fill(false);
    Measurements& measured = alone.measured;
    measured.observations = RowMatrixXd(measurements.observations.middleCols(
        combined.first_row_of(part), stated.sensor->row_count()));
    measured.is_seen = Seen(measurements.is_seen.middleCols(combined.first_target(part),
                                                            stated.sensor->target_count()));
    std::vector<Index> shown;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const Index first = measured.first_sample[static_cast<std::size_t>(i)];
        if (measured.is_seen.middleRows(first, measured.sample_count(i)).any()) shown.push_back(i);
    }
    measured = take(measured, shown);
    return alone;
}

PartAlone telling_part(const Campaign& campaign, const Measurements& measurements,
                       const Parameters& registered) {
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    for (const bool takes_pixels : {false, true}) {
        for (Index k = 0; combined != nullptr && k < combined->part_count(); ++k) {
            const Sensor& sensor = *combined->part(k).sensor;
            if (sensor.has_pixels() != takes_pixels || !sensor.observed_points()) continue;
            PartAlone alone = take_part(campaign, *combined, k, measurements, registered);
            if (alone.measured.configuration_count() > 0) return alone;
        }
    }
    return {campaign, measurements, registered};
}

std::vector<PartAlone> parts_alone(const Campaign& campaign, const Measurements& measurements,
                                   const Parameters& registered) {
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    if (combined == nullptr) return {{campaign, measurements, registered}};
    std::vector<PartAlone> parts;
    for (Index k = 0; k < combined->part_count(); ++k) {
        PartAlone alone = take_part(campaign, *combined, k, measurements, registered);
        if (alone.measured.configuration_count() > 0) parts.push_back(std::move(alone));
    }
    return parts;
}

}  // namespace posewise::detail
