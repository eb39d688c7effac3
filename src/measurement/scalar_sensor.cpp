#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "../core/format.hpp"
#include "noise_words.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/units.hpp"
#include "posewise/measurement/sensors.hpp"
#include "tilted_direction.hpp"

namespace posewise {

// ---- What distances and planes share ----

ScalarSensor::ScalarSensor(Targets targets, Index feature_count, bool are_known, std::string letter,
                           double sigma)
    : targets_(std::move(targets)),
      feature_count_(feature_count),
      are_known_(are_known),
      letter_(std::move(letter)),
      sigma_(sigma) {
    if (feature_count < 1) throw InputError("a sensor of lengths needs an anchor or a plane");
    detail::check_sigma("sigma", sigma, "m");
}

std::vector<std::string> ScalarSensor::observation_names() const {
    std::vector<std::string> names;
    for (Index j = 0; j < targets_.count(); ++j) {
        for (Index feature = 0; feature < feature_count_; ++feature) {
            names.push_back("p" + std::to_string(j + 1) + '_' + letter_ +
                            std::to_string(feature + 1));
        }
    }
    return names;
}

VectorXd ScalarSensor::predict(const Isometry3d& world_from_flange,
                               const VectorXd& unknowns) const {
    VectorXd lengths(row_count());
    for (Index row = 0; row < row_count(); ++row) {
        const Vector3d x = world_from_flange * target_position(row, unknowns);
        lengths[row] = measure(x, row % feature_count_, unknowns).value;
    }
    return lengths;
}

void ScalarSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    RowMatrixXd J(3 * targets_.count(), J_measured_parameters.cols());
    targets_.differentiate(world_from_flange, twists, unknowns, J);
    const bool has_own = !are_known_ && J.cols() > twists.cols();
    for (Index row = 0; row < row_count(); ++row) {
        const Vector3d x = world_from_flange * target_position(row, unknowns);
        const Index feature = row % feature_count_;
        const Length length = measure(x, feature, unknowns);
        const Index target = row / feature_count_;
        J_measured_parameters.row(row) = length.gradient.transpose() * J.middleRows<3>(3 * target);
        if (!has_own) continue;
        J_measured_parameters.row(row).segment<3>(twists.cols() + unknown_index(feature)) =
            length.by_feature.transpose();
    }
}

void ScalarSensor::differentiate_along(const Isometry3d& world_from_flange,
                                       const TwistMatrix& twists, const Twist& direction,
                                       const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                       Eigen::Ref<RowMatrixXd> J_rate) const {
    RowMatrixXd J(3 * targets_.count(), J_rate.cols());
    RowMatrixXd rate(J.rows(), J.cols());
    targets_.differentiate(world_from_flange, twists, unknowns, J);
    targets_.differentiate_along(world_from_flange, twists, direction, twist_rates, unknowns, rate);
    const bool has_own = !are_known_ && J.cols() > twists.cols();
    for (Index row = 0; row < row_count(); ++row) {
        const Vector3d x = world_from_flange * target_position(row, unknowns);
        const Vector3d velocity = velocity_of(x, direction);
        const Index feature = row % feature_count_;
        const Length length = measure(x, feature, unknowns);
        const Index first = 3 * (row / feature_count_);
        J_rate.row(row) = length.gradient.transpose() * rate.middleRows<3>(first) +
                          (length.gradient_by_x * velocity).transpose() * J.middleRows<3>(first);
        if (!has_own) continue;
        J_rate.row(row).segment<3>(twists.cols() + unknown_index(feature)) =
            (length.feature_by_x * velocity).transpose();
    }
}

MatrixXd ScalarSensor::covariance(const Isometry3d&, const VectorXd&) const {
    return sigma_ * sigma_ * MatrixXd::Identity(row_count(), row_count());
}

SensorWords ScalarSensor::words() const {
    SensorWords words;
    words.readings = "lengths";
    words.unknowns += ", " + features();
    if (!are_known_) words.known.push_back(known_key());
    words.sentence = fmt::format("{} lengths a pose at {}, sigma {} mm", row_count(),
                                 describe(targets_), detail::format_short(mm_per_m * sigma_));
    return words;
}

// ---- Distances ----

DistanceSensor::DistanceSensor(Targets targets, std::vector<Vector3d> anchors, bool are_known,
                               double sigma)
    : ScalarSensor(std::move(targets), static_cast<Index>(anchors.size()), are_known, "a", sigma),
      anchors_(std::move(anchors)) {
    for (const Vector3d& anchor : anchors_) {
        if (!are_known || anchor.allFinite()) continue;
        throw InputError("an anchor's position has a value that is not a finite number");
    }
}

std::vector<std::string> DistanceSensor::unknown_names() const {
    std::vector<std::string> names = targets().unknown_names();
    for (Index anchor = 0; anchor < feature_count() && !are_known(); ++anchor) {
        for (const char axis : {'x', 'y', 'z'}) {
            names.push_back("anchor" + std::to_string(anchor + 1) + '.' + axis);
        }
    }
    return names;
}

ScalarSensor::Length DistanceSensor::measure(const Vector3d& x, Index anchor,
                                             const VectorXd& unknowns) const {
    constexpr double least = 1e-6;  // m; nearer, the direction means nothing
    const Vector3d away = x - (are_known() ? anchors_[static_cast<std::size_t>(anchor)]
                                           : Vector3d(unknowns.segment<3>(unknown_index(anchor))));
    const double distance = away.norm();
    const Vector3d u = away / std::max(distance, least);
    const Matrix3d across = (Matrix3d::Identity() - u * u.transpose()) / std::max(distance, least);
    return {distance, u, across, -u, -across};
}

// ---- Planes ----

PlaneSensor::PlaneSensor(Targets targets, std::vector<Plane> planes, bool are_known, double sigma)
    : ScalarSensor(std::move(targets), static_cast<Index>(planes.size()), are_known, "plane",
                   sigma),
      planes_(std::move(planes)) {
    for (Plane& plane : planes_) {
        const double norm = plane.normal.norm();
        if (!std::isfinite(norm) || !std::isfinite(plane.offset) || norm < 1e-9) {
            throw InputError("a plane must have a finite offset and a normal that is not zero");
        }
        plane.normal /= norm;
    }
}

std::vector<std::string> PlaneSensor::unknown_names() const {
    std::vector<std::string> names = targets().unknown_names();
    for (Index plane = 0; plane < feature_count() && !are_known(); ++plane) {
        for (const char* const part : {"tilt1", "tilt2", "offset"}) {
            names.push_back("plane" + std::to_string(plane + 1) + '.' + part);
        }
    }
    return names;
}

std::vector<bool> PlaneSensor::unknown_is_angle() const {
    std::vector<bool> is_angle(static_cast<std::size_t>(targets().unknown_count()), false);
    for (Index plane = 0; plane < feature_count() && !are_known(); ++plane) {
        is_angle.insert(is_angle.end(), {true, true, false});
    }
    return is_angle;
}

ScalarSensor::Length PlaneSensor::measure(const Vector3d& x, Index plane,
                                          const VectorXd& unknowns) const {
    const auto& [stated, offset] = planes_[static_cast<std::size_t>(plane)];
    if (are_known()) {
        return {stated.dot(x) - offset, stated, Matrix3d::Zero(), Vector3d::Zero(),
                Matrix3d::Zero()};
    }
    const Vector3d own = unknowns.segment<3>(unknown_index(plane));
    const auto [n, n_by_tilt1, n_by_tilt2] = detail::tilt(stated, own[0], own[1]);
    Matrix3d feature_by_x = Matrix3d::Zero();
    feature_by_x.row(0) = n_by_tilt1.transpose();
    feature_by_x.row(1) = n_by_tilt2.transpose();
    return {n.dot(x) - own[2],
            n,
            Matrix3d::Zero(),
            {n_by_tilt1.dot(x), n_by_tilt2.dot(x), -1},
            feature_by_x};
}

}  // namespace posewise
