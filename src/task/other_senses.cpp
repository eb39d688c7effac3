#include "other_senses.hpp"

#include <cmath>

#include "posewise/calibrator/registration.hpp"
#include "posewise/model/transforms.hpp"

namespace posewise {
namespace {

// ---- Planes ----

/// The campaign with the base as stated and all planes unknown.
Campaign with_unknown_planes(const Campaign& campaign, const PlaneSensor& sensor) {
    Campaign changed = campaign;
    changed.base_is_known.fill(true);
    changed.sensor =
        std::make_shared<PlaneSensor>(sensor.targets(), sensor.planes(), false, sensor.sigma());
    Index next = sensor.targets().unknown_count();
    changed.nominal.sensor.conservativeResize(
        static_cast<Index>(changed.sensor->unknown_names().size()));
    for (const Plane& plane : sensor.planes()) {
        changed.nominal.sensor.segment<3>(next) << 0, 0, plane.offset;
        next += 3;
    }
    return changed;
}

// ---- Orientations ----

Matrix3d inverted(const Matrix3d& read) { return read.transpose(); }

Matrix3d with_real_part_last(const Matrix3d& read) {
    const Eigen::Quaterniond q(read);
    return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
}

Measurements read_otherwise(const Measurements& measured, OrientationSense sense) {
    Measurements other = measured;
    for (auto sample : other.observations.rowwise()) {
        const Matrix3d read = rotation_from_vector(sample.tail<3>());
        const Matrix3d meant =
            sense == OrientationSense::Inverted ? inverted(read) : with_real_part_last(read);
        sample.tail<3>() = vector_from_rotation(meant).transpose();
    }
    return other;
}

}  // namespace

std::vector<PlaneDoubt> find_plane_doubts(const Campaign& campaign, const Measurements& measured) {
    // Only a plane can be stated reversed, and only its sensor knows how the plane was stated.
    const auto* const sensor = dynamic_cast<const PlaneSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return {};
    const Campaign freed = with_unknown_planes(campaign, *sensor);
    const bool are_known = campaign.nominal.sensor.size() < freed.nominal.sensor.size();
    const Registration registered = register_base_and_targets(freed, measured);
    if (!registered.is_determined()) return {};  // too few to tell
    const VectorXd& fitted = registered.parameters.sensor;
    std::vector<PlaneDoubt> doubts;
    Index next = sensor->targets().unknown_count();
    for (std::size_t k = 0; k < sensor->planes().size(); ++k, next += 3) {
        const Plane& stated = sensor->planes()[k];
        const bool is_reversed = std::cos(fitted.segment<2>(next).norm()) < 0;
        const double offset = fitted[next + 2];
        const bool is_opposite =
            are_known && std::abs(offset + stated.offset) < 0.1 * std::abs(offset - stated.offset);
        if (!is_reversed && !is_opposite) continue;
        const Vector3d normal = is_reversed ? Vector3d(-stated.normal) : stated.normal;
        doubts.push_back({static_cast<Index>(k), stated, {normal, offset}});
    }
    return doubts;
}

std::vector<detail::TurnedPlane> detail::find_turned_planes(const Campaign& campaign,
                                                            const VectorXd& unknowns) {
    constexpr double least_cosine = 0.7;  // 45 deg, from the normal or what is opposite to it
    const auto* const sensor = dynamic_cast<const PlaneSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return {};
    std::vector<TurnedPlane> turned;
    const Index first = sensor->targets().unknown_count();
    for (Index next = first; next < unknowns.size(); next += 3) {
        const double tilt = unknowns.segment<2>(next).norm();
        if (std::abs(std::cos(tilt)) >= least_cosine) continue;
        turned.push_back({(next - first) / 3, std::acos(std::cos(tilt))});
    }
    return turned;
}

void detail::find_other_sense(const Campaign& campaign, const Measurements& measured,
                              double tolerance, OrientationDoubt& doubt) {
    for (const auto sense : {OrientationSense::Inverted, OrientationSense::RealPartLast}) {
        const Measurements other = read_otherwise(measured, sense);
        const Registration fitted = register_base_and_targets(campaign, other);
        if (!fitted.is_determined()) continue;  // it was not that
        const double rms =
            make_metrics(residuals(campaign, fitted.parameters, other)).orientation_rms;
        if (rms >= tolerance) continue;
        doubt.sense = sense;
        doubt.rms_in_sense = rms;
        return;
    }
}

}  // namespace posewise
