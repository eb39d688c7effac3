#include "suspicions.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/units.hpp"
#include "posewise/measurement/scalar_sensor.hpp"
#include "posewise/model/transforms.hpp"

namespace posewise::cli {
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

std::string describe(const Vector3d& normal, double offset) {
    return fmt::format("normal [{}, {}, {}] and offset {} mm", format_fixed(normal.x(), 3),
                       format_fixed(normal.y(), 3), format_fixed(normal.z(), 3),
                       format_mm(offset, 1));
}

// ---- Orientations ----

/// How an orientation may have been meant, from how it was read.
struct OtherSense {
    const char* advice;
    Matrix3d (*meant)(const Matrix3d& read);
};

Matrix3d inverted(const Matrix3d& read) { return read.transpose(); }

Matrix3d with_real_part_last(const Matrix3d& read) {
    const Eigen::Quaterniond q(read);
    return Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
}

constexpr std::array<OtherSense, 2> other_senses{{
    {"inverted: the quaternions look conjugate, turn round the signs of qx, qy and qz", inverted},
    {"with the last number of each quaternion as its real part: name the columns qx, qy, qz, qw",
     with_real_part_last},
}};

Measurements read_otherwise(const Measurements& measured, const OtherSense& sense) {
    Measurements other = measured;
    for (auto sample : other.observations.rowwise()) {
        const Matrix3d read = rotation_from_vector(sample.tail<3>());
        sample.tail<3>() = vector_from_rotation(sense.meant(read)).transpose();
    }
    return other;
}

}  // namespace

std::string suspect_planes(const Campaign& campaign, const Measurements& measured) {
    // Only a plane can be stated reversed, and only its sensor knows how the plane was stated.
    const auto* const sensor = dynamic_cast<const PlaneSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return "";
    const Campaign freed = with_unknown_planes(campaign, *sensor);
    const bool are_known = campaign.nominal.sensor.size() < freed.nominal.sensor.size();
    VectorXd fitted;
    try {
        fitted = register_base_and_targets(freed, measured).sensor;
    } catch (const InputError&) {
        return "";  // too few to tell
    }
    std::string text;
    Index next = sensor->targets().unknown_count();
    for (std::size_t k = 0; k < sensor->planes().size(); ++k, next += 3) {
        const auto& [normal, stated] = sensor->planes()[k];
        const bool is_reversed = std::cos(fitted.segment<2>(next).norm()) < 0;
        const double offset = fitted[next + 2];
        const bool is_opposite =
            are_known && std::abs(offset + stated) < 0.1 * std::abs(offset - stated);
        if (!is_reversed && !is_opposite) continue;
        text += fmt::format("{}plane {} looks reversed: stated with {}, measured at about {}",
                            text.empty() ? "" : "; ", k + 1, describe(normal, stated),
                            describe(is_reversed ? Vector3d(-normal) : normal, offset));
    }
    return text;
}

std::string suspect_orientations(const Campaign& campaign, const Measurements& measured,
                                 double tolerance) {
    for (const OtherSense& sense : other_senses) {
        const Measurements other = read_otherwise(measured, sense);
        double rms = tolerance;
        try {
            const Parameters fitted = register_base_and_targets(campaign, other);
            rms = make_metrics(residuals(campaign, fitted, other)).orientation_rms;
        } catch (const InputError&) {  // it was not that
            continue;
        }
        if (rms >= tolerance) continue;
        return fmt::format(", but by {} deg {}", format_short(to_degrees(rms), 2), sense.advice);
    }
    return "";
}

}  // namespace posewise::cli
