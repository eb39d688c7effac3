#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "core/text.hpp"
#include "noise_words.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/sensors.hpp"
#include "tilted_direction.hpp"

namespace posewise {

// ---- What distances and planes share ----

ScalarSensor::ScalarSensor(Targets targets, std::vector<Vector3d> stated,
                           const std::vector<std::array<bool, 3>>& is_known,
                           FeatureWords feature_words, double sigma)
    : targets_(std::move(targets)),
      stated_(std::move(stated)),
      feature_words_(std::move(feature_words)),
      sigma_(sigma) {
    if (stated_.empty()) throw InputError("a sensor of lengths needs an anchor or a plane");
    Index next = targets_.unknown_count();
    for (std::size_t k = 0; k < stated_.size(); ++k) {
        std::array<Index, 3> indices{-1, -1, -1};
        for (std::size_t value = 0; value < 3; ++value) {
            if (!is_known[k][value]) {
                indices[value] = next++;
            } else if (!std::isfinite(stated_[k][static_cast<Index>(value)])) {
                throw InputError(fmt::format("what is known of {} {} must be finite",
                                             feature_words_.name, k + 1));
            }
        }
        unknown_index_.push_back(indices);
    }
    detail::check_sigma("sigma", sigma, "m");
}

Vector3d ScalarSensor::feature_values(Index feature, const VectorXd& unknowns) const {
    Vector3d values = stated_[static_cast<std::size_t>(feature)];
    for (Index value = 0; value < 3; ++value) {
        if (!is_known(feature, value)) values[value] = unknowns[unknown_index(feature, value)];
    }
    return values;
}

std::vector<std::string> ScalarSensor::unknown_names() const {
    std::vector<std::string> names = targets_.unknown_names();
    for (Index feature = 0; feature < feature_count(); ++feature) {
        for (Index value = 0; value < 3; ++value) {
            if (is_known(feature, value)) continue;
            names.push_back(fmt::format("{}{}.{}", feature_words_.name, feature + 1,
                                        feature_words_.values[static_cast<std::size_t>(value)]));
        }
    }
    return names;
}

std::vector<bool> ScalarSensor::unknown_is_angle() const {
    std::vector<bool> is_angle(static_cast<std::size_t>(targets_.unknown_count()), false);
    for (Index feature = 0; feature < feature_count(); ++feature) {
        for (Index value = 0; value < 3; ++value) {
            if (is_known(feature, value)) continue;
            is_angle.push_back(feature_words_.value_is_angle[static_cast<std::size_t>(value)]);
        }
    }
    return is_angle;
}

std::vector<std::string> ScalarSensor::observation_names() const {
    std::vector<std::string> names;
    for (Index j = 0; j < targets_.count(); ++j) {
        for (Index feature = 0; feature < feature_count(); ++feature) {
            names.push_back("p" + std::to_string(j + 1) + '_' + feature_words_.letter +
                            std::to_string(feature + 1));
        }
    }
    return names;
}

void ScalarSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                           Eigen::Ref<VectorXd> observation) const {
    for (Index row = 0; row < row_count(); ++row) {
        const Vector3d x = world_from_flange * target_position(row, unknowns);
        const Index feature = row % feature_count();
        observation[row] = measure(x, feature, feature_values(feature, unknowns)).value;
    }
}

void ScalarSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto J_unknowns = J_measured_parameters.rightCols(J_measured_parameters.cols() - twists.cols());
    J_unknowns.setZero();
    const bool has_own = J_unknowns.cols() > 0;
    for (Index row = 0; row < row_count(); ++row) {
        const Vector3d x = world_from_flange * target_position(row, unknowns);
        const Index feature = row % feature_count();
        const Length length = measure(x, feature, feature_values(feature, unknowns));
        Twist wrench;  // what a twist does to the length
        wrench << x.cross(length.gradient), length.gradient;
        for (Index k = 0; k < twists.cols(); ++k) {
            J_measured_parameters(row, k) = wrench.dot(twists.col(k));
        }
        const Vector3d in_flange = world_from_flange.linear().transpose() * length.gradient;
        for (Index axis = 0; axis < 3 && has_own; ++axis) {
            const Index index = targets_.unknown_index(row / feature_count(), axis);
            if (index >= 0) J_unknowns(row, index) = in_flange[axis];
        }
        for (Index value = 0; value < 3 && has_own; ++value) {
            if (is_known(feature, value)) continue;
            J_unknowns(row, unknown_index(feature, value)) = length.by_feature[value];
        }
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
    const bool has_own = J.cols() > twists.cols();
    for (Index row = 0; row < row_count(); ++row) {
        const Vector3d x = world_from_flange * target_position(row, unknowns);
        const Vector3d velocity = velocity_of(x, direction);
        const Index feature = row % feature_count();
        const Length length = measure(x, feature, feature_values(feature, unknowns));
        const Index first = 3 * (row / feature_count());
        J_rate.row(row) = length.gradient.transpose() * rate.middleRows<3>(first) +
                          (length.gradient_by_x * velocity).transpose() * J.middleRows<3>(first);
        for (Index value = 0; value < 3 && has_own; ++value) {
            if (is_known(feature, value)) continue;
            J_rate(row, twists.cols() + unknown_index(feature, value)) =
                length.feature_by_x.row(value).dot(velocity);
        }
    }
}

void ScalarSensor::covariance(const Isometry3d&, const VectorXd&,
                              Eigen::Ref<MatrixXd> covariance) const {
    covariance = sigma_ * sigma_ * MatrixXd::Identity(row_count(), row_count());
}

SensorWords ScalarSensor::words() const {
    const Index own = std::ssize(unknown_names()) - targets_.unknown_count();
    const std::string features = feature_words_.name + 's';
    SensorWords words;
    words.readings = "lengths";
    words.unknowns += ", " + features;
    if (own > 0) words.known.push_back(feature_words_.known_key);
    words.sentence =
        fmt::format("{} lengths a pose at {}, {} ({}), sigma {} mm", row_count(),
                    describe(targets_), detail::count_of(feature_count(), feature_words_.name),
                    own == 0                     ? "known"
                    : own == 3 * feature_count() ? "to be identified"
                                                 : "known in part",
                    detail::format_short(mm_per_m * sigma_));
    return words;
}

// ---- Distances ----

DistanceSensor::DistanceSensor(Targets targets, std::vector<Vector3d> anchors, bool are_known,
                               double sigma)
    : ScalarSensor(std::move(targets), anchors,
                   {anchors.size(), std::array<bool, 3>{are_known, are_known, are_known}},
                   {"anchor", "a", {"x", "y", "z"}, {}, "sensor.anchors.known"}, sigma) {}

ScalarSensor::Length DistanceSensor::measure(const Vector3d& x, Index,
                                             const Vector3d& position) const {
    constexpr double least = 1e-6;  // m; nearer, the direction means nothing
    const Vector3d away = x - position;
    const double distance = away.norm();
    const Vector3d u = away / std::max(distance, least);
    const Matrix3d across = (Matrix3d::Identity() - u * u.transpose()) / std::max(distance, least);
    return {distance, u, across, -u, -across};
}

// ---- Planes ----

namespace {

std::vector<Vector3d> stated_values(const std::vector<Plane>& planes) {
    std::vector<Vector3d> values;
    for (const Plane& plane : planes) values.emplace_back(0, 0, plane.offset);
    return values;
}

std::vector<std::array<bool, 3>> known_values(const std::vector<Plane>& planes) {
    std::vector<std::array<bool, 3>> known;
    for (const Plane& plane : planes) {
        known.push_back({plane.normal_is_known, plane.normal_is_known, plane.offset_is_known});
    }
    return known;
}

}  // namespace

PlaneSensor::PlaneSensor(Targets targets, std::vector<Plane> planes, double sigma)
    : ScalarSensor(std::move(targets), stated_values(planes), known_values(planes),
                   {"plane",
                    "plane",
                    {"tilt1", "tilt2", "offset"},
                    {true, true, false},
                    "sensor.known_planes"},
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

Plane PlaneSensor::plane(Index plane, const VectorXd& unknowns) const {
    Plane found = planes_[static_cast<std::size_t>(plane)];
    const Vector3d values = feature_values(plane, unknowns);
    if (!found.normal_is_known) {
        found.normal = detail::tilt(found.normal, values[0], values[1]).value;
    }
    found.offset = values[2];
    return found;
}

ScalarSensor::Length PlaneSensor::measure(const Vector3d& x, Index plane,
                                          const Vector3d& tilts_and_offset) const {
    const Plane& stated = planes_[static_cast<std::size_t>(plane)];
    const double offset = tilts_and_offset[2];
    if (stated.normal_is_known) {
        return {stated.normal.dot(x) - offset,
                stated.normal,
                Matrix3d::Zero(),
                {0, 0, -1},
                Matrix3d::Zero()};
    }
    const auto [n, n_by_tilt1, n_by_tilt2] =
        detail::tilt(stated.normal, tilts_and_offset[0], tilts_and_offset[1]);
    Matrix3d feature_by_x = Matrix3d::Zero();
    feature_by_x.row(0) = n_by_tilt1.transpose();
    feature_by_x.row(1) = n_by_tilt2.transpose();
    return {n.dot(x) - offset,
            n,
            Matrix3d::Zero(),
            {n_by_tilt1.dot(x), n_by_tilt2.dot(x), -1},
            feature_by_x};
}

}  // namespace posewise
