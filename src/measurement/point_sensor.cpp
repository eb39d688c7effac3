#include "posewise/measurement/point_sensor.hpp"

#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

Vector3d velocity_of(const Vector3d& point, const Twist& twist) {
    return twist.tail<3>() + twist.head<3>().cross(point);
}

/// The three rows of one target, filled through plain pointers because this is the hot loop of
/// planning. A twist is six numbers: w, v.
struct PointRows {
    double* x;
    double* y;
    double* z;

    PointRows(Eigen::Ref<RowMatrixXd> J, Index target)
        : x(&J(3 * target, 0)), y(&J(3 * target + 1, 0)), z(&J(3 * target + 2, 0)) {}

    /// Column k becomes v + w cross point.
    void set(Index k, const double* twist, const Vector3d& point) {
        x[k] = twist[3];
        y[k] = twist[4];
        z[k] = twist[5];
        add_turn(k, twist, point);
    }
    /// Adds w cross point to column k.
    void add_turn(Index k, const double* twist, const Vector3d& point) {
        x[k] += twist[1] * point.z() - twist[2] * point.y();
        y[k] += twist[2] * point.x() - twist[0] * point.z();
        z[k] += twist[0] * point.y() - twist[1] * point.x();
    }
};

}  // namespace

PointSensor::PointSensor(std::vector<std::optional<Vector3d>> known_targets, double sigma)
    : PointSensor(std::move(known_targets), IsotropicNoise{sigma}) {}

PointSensor::PointSensor(std::vector<std::optional<Vector3d>> known_targets, PointNoise noise)
    : known_targets_(std::move(known_targets)), noise_(noise) {
    if (known_targets_.empty()) throw InputError("a point sensor needs at least one target");
    check_noise(noise_);
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

void PointSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                const VectorXd& unknowns,
                                Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto J_targets = J_measured_parameters.rightCols(J_measured_parameters.cols() - twists.cols());
    J_targets.setZero();
    for (Index j = 0; j < target_count(); ++j) {
        const Vector3d x = world_from_flange * target(j, unknowns);
        PointRows rows(J_measured_parameters, j);
        for (Index k = 0; k < twists.cols(); ++k) rows.set(k, &twists(0, k), x);
        if (J_targets.cols() > 0 && !is_known(j)) {
            J_targets.block<3, 3>(3 * j, unknown_offset(j)) = world_from_flange.linear();
        }
    }
}

void PointSensor::differentiate_along(const Isometry3d& world_from_flange,
                                      const TwistMatrix& twists, const Twist& direction,
                                      const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                      Eigen::Ref<RowMatrixXd> J_rate) const {
    auto J_targets = J_rate.rightCols(J_rate.cols() - twists.cols());
    J_targets.setZero();
    const Vector3d w = direction.head<3>();
    for (Index j = 0; j < target_count(); ++j) {
        const Vector3d x = world_from_flange * target(j, unknowns);
        const Vector3d velocity = velocity_of(x, direction);
        PointRows rows(J_rate, j);
        for (Index k = 0; k < twists.cols(); ++k) {
            rows.set(k, &twist_rates(0, k), x);
            rows.add_turn(k, &twists(0, k), velocity);
        }
        if (J_targets.cols() > 0 && !is_known(j)) {
            auto J_target = J_targets.block<3, 3>(3 * j, unknown_offset(j));
            for (Index a = 0; a < 3; ++a)
                J_target.col(a) = w.cross(world_from_flange.linear().col(a));
        }
    }
}

MatrixXd PointSensor::covariance(const Isometry3d& world_from_flange,
                                 const VectorXd& unknowns) const {
    MatrixXd covariance = MatrixXd::Zero(row_count(), row_count());
    for (Index j = 0; j < target_count(); ++j) {
        covariance.block<3, 3>(3 * j, 3 * j) =
            point_covariance(noise_, world_from_flange * target(j, unknowns));
    }
    return covariance;
}

MatrixXd PointSensor::covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                      const VectorXd& unknowns) const {
    MatrixXd rate = MatrixXd::Zero(row_count(), row_count());
    for (Index j = 0; j < target_count(); ++j) {
        const Vector3d x = world_from_flange * target(j, unknowns);
        rate.block<3, 3>(3 * j, 3 * j) =
            point_covariance_rate(noise_, x, velocity_of(x, direction));
    }
    return rate;
}

bool PointSensor::has_constant_covariance() const {
    return !std::holds_alternative<LaserTrackerNoise>(noise_);
}

}  // namespace posewise
