#include "posewise/measurement/point_sensor.hpp"

#include <cmath>

#include "posewise/core/errors.hpp"

namespace posewise {

PointSensor::PointSensor(std::vector<std::optional<Vector3d>> known_targets, double sigma)
    : known_targets_(std::move(known_targets)), sigma_(sigma) {
    if (known_targets_.empty()) throw InputError("a point sensor needs at least one target");
    if (!(sigma >= 1e-15) || !std::isfinite(sigma)) {
        throw InputError("sigma is " + std::to_string(sigma) +
                         " m, must be finite and at least 1e-15 m");
    }
    Index offset = 0;
    for (const auto& target : known_targets_) {
        if (target && !target->allFinite()) {
            throw InputError("a known target's position has a value that is not a finite number");
        }
        unknown_offset_.push_back(target ? -1 : offset);
        if (!target) offset += 3;
    }
}

bool PointSensor::is_known(Index target) const { return unknown_offset(target) < 0; }

Vector3d PointSensor::target(Index target, const VectorXd& unknowns) const {
    const auto& known = known_targets_[static_cast<std::size_t>(target)];
    return known ? *known : Vector3d(unknowns.segment<3>(unknown_offset(target)));
}

Index PointSensor::unknown_offset(Index target) const {
    return unknown_offset_[static_cast<std::size_t>(target)];
}

std::vector<std::string> PointSensor::observation_names() const {
    std::vector<std::string> names;
    for (Index j = 0; j < target_count(); ++j) {
        for (const char axis : {'x', 'y', 'z'}) {
            names.push_back("p" + std::to_string(j + 1) + "_" + axis);
        }
    }
    return names;
}

std::vector<std::string> PointSensor::unknown_names() const {
    std::vector<std::string> names;
    for (Index j = 0; j < target_count(); ++j) {
        if (is_known(j)) continue;
        for (const char axis : {'x', 'y', 'z'}) {
            names.push_back("target" + std::to_string(j + 1) + "." + axis);
        }
    }
    return names;
}

VectorXd PointSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const {
    VectorXd points(row_count());
    for (Index j = 0; j < target_count(); ++j) {
        points.segment<3>(3 * j) = world_from_flange * target(j, unknowns);
    }
    return points;
}

void PointSensor::differentiate(const FlangeMotion& motion, const VectorXd& unknowns,
                                Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    const Index twist_count = motion.twists.cols();
    auto J_targets = J_measured_parameters.rightCols(J_measured_parameters.cols() - twist_count);
    J_targets.setZero();
    for (Index j = 0; j < target_count(); ++j) {
        const Vector3d x = motion.world_from_flange * target(j, unknowns);
        double* const row_x = &J_measured_parameters(3 * j, 0);
        double* const row_y = &J_measured_parameters(3 * j + 1, 0);
        double* const row_z = &J_measured_parameters(3 * j + 2, 0);
        for (Index k = 0; k < twist_count; ++k) {  // v + w cross x, row by row
            const double* const t = &motion.twists(0, k);
            row_x[k] = t[3] + t[1] * x.z() - t[2] * x.y();
            row_y[k] = t[4] + t[2] * x.x() - t[0] * x.z();
            row_z[k] = t[5] + t[0] * x.y() - t[1] * x.x();
        }
        if (!is_known(j)) {
            J_targets.block<3, 3>(3 * j, unknown_offset(j)) = motion.world_from_flange.linear();
        }
    }
}

MatrixXd PointSensor::covariance(const Isometry3d& /*world_from_flange*/,
                                 const VectorXd& /*unknowns*/) const {
    return sigma_ * sigma_ * MatrixXd::Identity(row_count(), row_count());
}

}  // namespace posewise
