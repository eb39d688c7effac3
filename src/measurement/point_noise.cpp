#include <cmath>

#include "noise_words.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise {
namespace {

constexpr double least_distance = 1e-3;  // m; no reflector is nearer

struct Check {
    void operator()(const IsotropicNoise& noise) const {
        detail::check_sigma("sigma", noise.sigma, "m");
    }
    void operator()(const PerAxisNoise& noise) const {
        detail::check_sigma("sigma in x", noise.sigma.x(), "m");
        detail::check_sigma("sigma in y", noise.sigma.y(), "m");
        detail::check_sigma("sigma in z", noise.sigma.z(), "m");
    }
    void operator()(const LaserTrackerNoise& noise) const {
        detail::check_sigma("range sigma", noise.range_sigma, "m");
        detail::check_sigma("angle sigma", noise.angle_sigma, "rad");
        if (noise.position.allFinite()) return;
        throw InputError("the laser tracker's position has a value that is not a finite number");
    }
};

/// Unit vector of the beam to a point, and the distance along it.
struct Beam {
    Vector3d u;
    double distance;
    bool is_clamped;

    Beam(const LaserTrackerNoise& noise, const Vector3d& point)
        : u(point - noise.position), distance(u.norm()), is_clamped(distance < least_distance) {
        u = distance > 0 ? Vector3d(u / distance) : Vector3d(Vector3d::UnitX());
        if (is_clamped) distance = least_distance;
    }
};

struct Covariance {
    const Vector3d& point;

    Matrix3d operator()(const IsotropicNoise& noise) const {
        return noise.sigma * noise.sigma * Matrix3d::Identity();
    }
    Matrix3d operator()(const PerAxisNoise& noise) const {
        return noise.sigma.cwiseAbs2().asDiagonal();
    }
    Matrix3d operator()(const LaserTrackerNoise& noise) const {
        const Beam beam(noise, point);
        const double along = std::pow(noise.range_sigma, 2);
        const double across = std::pow(noise.angle_sigma * beam.distance, 2);
        return across * Matrix3d::Identity() + (along - across) * beam.u * beam.u.transpose();
    }
};

struct CovarianceRate {
    const Vector3d& point;
    const Vector3d& velocity;

    template <typename Constant>
    Matrix3d operator()(const Constant&) const {
        return Matrix3d::Zero();
    }
    Matrix3d operator()(const LaserTrackerNoise& noise) const {
        const Beam beam(noise, point);
        if (beam.is_clamped) return Matrix3d::Zero();
        const double along = std::pow(noise.range_sigma, 2);
        const double across = std::pow(noise.angle_sigma * beam.distance, 2);
        const double receding = beam.u.dot(velocity);
        const double across_rate = 2 * across * receding / beam.distance;
        const Matrix3d turning =
            (velocity - receding * beam.u) / beam.distance * beam.u.transpose();
        return across_rate * (Matrix3d::Identity() - beam.u * beam.u.transpose()) +
               (along - across) * (turning + turning.transpose());
    }
};

}  // namespace

void check_noise(const PointNoise& noise) { std::visit(Check{}, noise); }

Matrix3d point_covariance(const PointNoise& noise, const Vector3d& point) {
    return std::visit(Covariance{point}, noise);
}

Matrix3d point_covariance_rate(const PointNoise& noise, const Vector3d& point,
                               const Vector3d& velocity) {
    return std::visit(CovarianceRate{point, velocity}, noise);
}

double coordinate_sigma(const PointNoise& noise, double distance) {
    const auto* const tracker = std::get_if<LaserTrackerNoise>(&noise);
    Vector3d point = Vector3d::UnitX() * distance;
    if (tracker != nullptr) point += tracker->position;
    return std::sqrt(point_covariance(noise, point).trace() / 3);
}

}  // namespace posewise
