#include <algorithm>
#include <cmath>

#include "posewise/calibrator/identification.hpp"
#include "posewise/task/doubts.hpp"
#include "task/calibration/identify_anew.hpp"

namespace posewise {
namespace {

/// Of a campaign whose distances may be doubted: the sockets are unknown, and so is their place.
const SocketSensor* unknown_sockets(const Campaign& campaign) {
    const auto* const sensor = dynamic_cast<const SocketSensor*>(campaign.sensor.get());
    const bool is_open = sensor != nullptr && !campaign.prior &&
                         std::ssize(sensor->unknown_names()) > sensor->targets().unknown_count();
    return is_open ? sensor : nullptr;
}

/// The campaign with the distance of one socket unknown, too.
Campaign with_open_distance(const Campaign& campaign, const SocketSensor& sensor, Index open) {
    std::vector<Socket> sockets = sensor.sockets();
    sockets[static_cast<std::size_t>(open)].from = -1;
    Campaign changed = campaign;
    changed.sensor =
        std::make_shared<SocketSensor>(sensor.targets(), sockets, false, sensor.sigma());
    const VectorXd& before = campaign.nominal.sensor;
    VectorXd unknowns(before.size() + 1);
    Index next = sensor.targets().unknown_count();
    for (Index k = 0; k < open; ++k) next += sensor.has_distance(k) ? 2 : 3;
    unknowns << before.head(next), sensor.socket_position(open, before),
        before.tail(before.size() - next - 2);
    changed.nominal.sensor = unknowns;
    return changed;
}

double rms_of(const Campaign& campaign, const Measurements& measured, const Estimate& estimate) {
    return make_metrics(residuals(campaign, estimate.parameters, measured)).distance_rms;
}

bool sockets_lack_length(const Campaign& campaign) {
    const SocketSensor* const sensor = unknown_sockets(campaign);
    if (sensor == nullptr) return false;
    for (Index k = 0; k < sensor->target_count(); ++k) {
        if (sensor->has_distance(k)) return false;
    }
    return true;
}

bool planes_lack_length(const Campaign& campaign, const Measurements& measured) {
    constexpr double touched = 1e-3;  // m
    const auto* const sensor = dynamic_cast<const PlaneSensor*>(campaign.sensor.get());
    if (sensor == nullptr || campaign.prior) return false;
    if (std::ranges::any_of(sensor->planes(), &Plane::offset_is_known)) return false;
    for (Index i = 0; i < measured.observations.rows(); ++i) {
        for (Index k = 0; k < measured.is_seen.cols(); ++k) {
            if (measured.is_seen(i, k) && std::abs(measured.observations(i, k)) > touched) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace

std::optional<DistanceDoubt> find_distance_doubt(const Campaign& campaign,
                                                 const Measurements& measured,
                                                 const Estimate& estimate) {
    constexpr double as_stated = 5;  // of noise and model error
    const SocketSensor* const sensor = unknown_sockets(campaign);
    if (sensor == nullptr) return std::nullopt;
    // A wrong length under sizes that were learned is made up for by errors as large as it takes.
    Campaign expected = campaign;
    expected.spread.is_open = false;
    const auto under_expected =
        estimate.spread ? detail::identify_anew(expected, measured) : std::optional<Estimate>();
    const double left_over = rms_of(campaign, measured, under_expected.value_or(estimate));
    const double stated = std::sqrt(3.0) * std::hypot(sensor->sigma(), campaign.model_error);
    if (left_over <= as_stated * stated) return std::nullopt;
    std::optional<DistanceDoubt> doubt;
    double least = 0.5 * left_over;  // what is found otherwise is no accident
    for (Index k = 0; k < sensor->target_count(); ++k) {
        if (!sensor->has_distance(k)) continue;
        const Campaign open = with_open_distance(expected, *sensor, k);
        const Registration start = register_base_and_targets(open, measured);
        if (!start.is_determined()) continue;
        const Estimate found = identify(open, measured, start.parameters, {.iteration_limit = 30});
        if (!found.undetermined.empty()) continue;
        const double rms = rms_of(open, measured, found);
        if (!(rms < least)) continue;
        least = rms;
        const auto& places = static_cast<const SocketSensor&>(*open.sensor);
        const Socket& socket = sensor->sockets()[static_cast<std::size_t>(k)];
        const auto at = [&](Index i) { return places.socket_position(i, found.parameters.sensor); };
        doubt = DistanceDoubt{socket.name,
                              sensor->sockets()[static_cast<std::size_t>(socket.from)].name,
                              socket.distance, (at(k) - at(socket.from)).norm()};
    }
    return doubt;
}

bool lacks_length(const Campaign& campaign, const Measurements& measured) {
    const Targets& targets = campaign.sensor->targets();
    const bool is_open = sockets_lack_length(campaign) || planes_lack_length(campaign, measured);
    if (!is_open || targets.unknown_count() < 3 * targets.count()) return false;
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        if (campaign.robot.parameter_element(k).motion == Motion::Translation) return true;
    }
    return false;
}

}  // namespace posewise
