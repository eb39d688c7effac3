#include "plane_doubts.hpp"

#include <cmath>

#include "posewise/calibrator/identification.hpp"

namespace posewise {
namespace {

/// The campaign with the base as stated and nothing known of all planes.
Campaign with_unknown_planes(const Campaign& campaign, const PlaneSensor& sensor) {
    Campaign changed = campaign;
    changed.base_is_known.fill(true);
    std::vector<Plane> planes = sensor.planes();
    Index next = sensor.targets().unknown_count();
    changed.nominal.sensor.conservativeResize(next + 3 * std::ssize(planes));
    for (Plane& plane : planes) {
        plane.normal_is_known = plane.offset_is_known = false;
        changed.nominal.sensor.segment<3>(next) << 0, 0, plane.offset;
        next += 3;
    }
    changed.sensor = std::make_shared<PlaneSensor>(sensor.targets(), planes, sensor.sigma());
    return changed;
}

}  // namespace

std::vector<PlaneDoubt> find_plane_doubts(const Campaign& campaign, const Measurements& measured) {
    // Only a plane can be stated reversed, and only its sensor knows how the plane was stated.
    const auto* const sensor = dynamic_cast<const PlaneSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return {};
    const Campaign freed = with_unknown_planes(campaign, *sensor);
    const Registration registered = register_base_and_targets(freed, measured);
    if (!registered.is_determined()) return {};  // too few to tell
    const auto& free_sensor = static_cast<const PlaneSensor&>(*freed.sensor);
    std::vector<PlaneDoubt> doubts;
    for (Index k = 0; k < std::ssize(sensor->planes()); ++k) {
        const Plane& stated = sensor->planes()[static_cast<std::size_t>(k)];
        const Plane fitted = free_sensor.plane(k, registered.parameters.sensor);
        const bool is_reversed = fitted.normal.dot(stated.normal) < 0;
        const bool is_opposite =
            stated.offset_is_known &&
            std::abs(fitted.offset + stated.offset) < 0.1 * std::abs(fitted.offset - stated.offset);
        const bool is_turned = detail::is_turned(stated.normal, fitted.normal);
        if (!is_reversed && !is_opposite && !is_turned) continue;
        const Vector3d normal = is_turned     ? fitted.normal
                                : is_reversed ? Vector3d(-stated.normal)
                                              : stated.normal;
        doubts.push_back({k, stated, {normal, fitted.offset}});
    }
    return doubts;
}

bool detail::is_turned(const Vector3d& normal, const Vector3d& other) {
    constexpr double least_cosine = 0.7;  // 45 deg
    return std::abs(normal.dot(other)) < least_cosine;
}

std::vector<detail::TurnedPlane> detail::find_turned_planes(const Campaign& campaign,
                                                            const VectorXd& unknowns) {
    const auto* const sensor = dynamic_cast<const PlaneSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return {};
    std::vector<TurnedPlane> turned;
    for (Index k = 0; k < std::ssize(sensor->planes()); ++k) {
        const Vector3d& stated = sensor->planes()[static_cast<std::size_t>(k)].normal;
        const Vector3d found = sensor->plane(k, unknowns).normal;
        if (is_turned(stated, found)) turned.push_back({k, std::acos(stated.dot(found))});
    }
    return turned;
}

}  // namespace posewise
