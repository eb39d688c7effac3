#include "moved.hpp"

#include <algorithm>

#include "earlier_estimate.hpp"
#include "posewise/calibrator/identification.hpp"

namespace posewise::detail {
namespace {

/// What of a set-up may have moved, the least first; nothing where all is known.
std::vector<std::vector<std::string>> movable_parts(const Campaign& campaign) {
    const bool has_base = base_parameter_count(campaign) > 0;
    const bool has_targets = !campaign.sensor->unknown_names().empty();
    std::vector<std::vector<std::string>> parts;
    if (has_base) parts.push_back({"base"});
    if (has_targets) parts.push_back({"targets"});
    if (has_base && has_targets) parts.push_back({"base", "targets"});
    return parts;
}

Moved measure_moved(const Campaign& campaign, const Parameters& before, const Parameters& after,
                    const std::vector<std::string>& parts) {
    const Targets& targets = campaign.sensor->targets();
    Moved moved;
    moved.parts = parts;
    moved.base =
        (after.world_from_base.translation() - before.world_from_base.translation()).norm();
    for (Index k = 0; k < targets.count(); ++k) {
        const double distance =
            (targets.position(k, after.sensor) - targets.position(k, before.sensor)).norm();
        moved.targets = std::max(moved.targets, distance);
    }
    return moved;
}

}  // namespace

Estimate refit_parts(const Refitting& refitting, const Campaign& campaign, const Estimate& before,
                     const Measurements& others, const std::vector<std::string>& parts) {
    const KnownParameters known = known_parameters(campaign, parts);
    Campaign held = with_known(campaign, known, before.parameters);
    if (known.base && !held.has_nominal_targets) {  // these alone have to begin somewhere
        held.nominal.sensor = before.parameters.sensor;
        held.has_nominal_targets = true;
    }
    const Registration registration = register_base_and_targets(held, others);
    Estimate found;
    found.undetermined = registration.undetermined;
    if (!registration.is_determined()) return found;
    found = identify(held, others, registration.parameters, refitting.options);
    if (!found.undetermined.empty()) return found;
    if (!refitting.is_of_other_campaign) {
        return complete(campaign, before, known, held, others, found);
    }
    found.parameters = complete(known, before.parameters, found.parameters);
    return found;
}

std::optional<Moved> find_moved(const Refitting& refitting, const Campaign& campaign,
                                const Estimate& before, const Measurements& others) {
    constexpr double plain = 5;
    const double expected = expected_sample_error(campaign, before, others).total();
    const double off = make_metrics(campaign, before.parameters, others).rms();
    if (off <= plain * expected) return std::nullopt;
    for (const std::vector<std::string>& parts : movable_parts(campaign)) {
        const Estimate found = refit_parts(refitting, campaign, before, others, parts);
        if (!found.undetermined.empty()) continue;
        const double left = make_metrics(campaign, found.parameters, others).rms();
        if (plain * left > off) continue;
        if (left > plain * expected && parts.size() == 1) continue;
        return measure_moved(campaign, before.parameters, found.parameters, parts);
    }
    return std::nullopt;
}

}  // namespace posewise::detail
