#include "camera_model.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/elementary.hpp"
#include "differences.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

using detail::Lens;

/// A direction (x/z, y/z) distorted, with derivatives by it and by the coefficients.
struct Bent {
    Vector2d place;
    Eigen::Matrix2d by_direction;
    detail::ByValues by_coefficients;
};

/// [OpenCV, calib3d]: (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3) with s = r^2, and
/// the tangential part by p1 and p2.
Bent bend_brown_conrady(const Lens& lens, const Vector2d& d) {
    const auto k = [&](Index i) { return lens.coefficient(i); };
    const double x = d.x(), y = d.y(), s = d.squaredNorm();
    const double above = 1 + s * (k(0) + s * (k(1) + s * k(4)));
    const double below = 1 + s * (k(5) + s * (k(6) + s * k(7)));
    const double above_rate = k(0) + s * (2 * k(1) + s * 3 * k(4));
    const double below_rate = k(5) + s * (2 * k(6) + s * 3 * k(7));
    const double radial = above / below;
    const double radial_rate = (above_rate - radial * below_rate) / below;
    const double p1 = k(2), p2 = k(3);
    Bent bent;
    const Vector2d by_p1(2 * x * y, s + 2 * y * y), by_p2(s + 2 * x * x, 2 * x * y);
    bent.place = radial * d + p1 * by_p1 + p2 * by_p2;
    bent.by_direction = radial * Eigen::Matrix2d::Identity() + 2 * radial_rate * d * d.transpose();
    bent.by_direction(0, 0) += 2 * p1 * y + 6 * p2 * x;
    bent.by_direction(0, 1) += 2 * p1 * x + 2 * p2 * y;
    bent.by_direction(1, 0) += 2 * p1 * x + 2 * p2 * y;
    bent.by_direction(1, 1) += 6 * p1 * y + 2 * p2 * x;
    bent.by_coefficients.resize(2, lens.count);
    Eigen::Matrix<double, 2, 8> all;
    all << s * d, s * s * d, by_p1, by_p2, s * s * s * d, -radial * s * d, -radial * s * s * d,
        -radial * s * s * s * d;
    all.leftCols<2>() /= below;
    all.col(4) /= below;
    all.rightCols<3>() /= below;
    bent.by_coefficients = all.leftCols(bent.by_coefficients.cols());
    return bent;
}

/// [OpenCV, fisheye]: t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) with t = atan r takes the place of
/// r.
Bent bend_fisheye(const Lens& lens, const Vector2d& d) {
    const double* const c = lens.values.data() + 4;
    Bent bent;
    bent.by_coefficients.setZero(2, 4);
    const double r = d.norm();
    if (r < 1e-9) {
        bent.place = d;
        bent.by_direction.setIdentity();
        return bent;
    }
    const double t = detail::arc_tangent(r, 1), s = t * t;
    const double bent_t = t * (1 + s * (c[0] + s * (c[1] + s * (c[2] + s * c[3]))));
    const double rate = 1 + s * (3 * c[0] + s * (5 * c[1] + s * (7 * c[2] + s * 9 * c[3])));
    const Vector2d u = d / r;
    const double by_r = rate / (1 + r * r);
    bent.place = bent_t * u;
    bent.by_direction =
        bent_t / r * (Eigen::Matrix2d::Identity() - u * u.transpose()) + by_r * u * u.transpose();
    double power = t;
    for (Index i = 0; i < 4; ++i) bent.by_coefficients.col(i) = (power *= s) * u;
    return bent;
}

/// How by_direction and by_coefficients of a Bent change while the direction moves.
struct BentRate {
    Eigen::Matrix2d by_direction = Eigen::Matrix2d::Zero();
    detail::ByValues by_coefficients;
};

BentRate brown_conrady_rate(const Lens& lens, const Vector2d& d, const Vector2d& d_rate) {
    const auto k = [&](Index i) { return lens.coefficient(i); };
    const double s = d.squaredNorm(), s_rate = 2 * d.dot(d_rate);
    const double above = 1 + s * (k(0) + s * (k(1) + s * k(4)));
    const double below = 1 + s * (k(5) + s * (k(6) + s * k(7)));
    const double above_1 = k(0) + s * (2 * k(1) + s * 3 * k(4));  // by s
    const double below_1 = k(5) + s * (2 * k(6) + s * 3 * k(7));
    const double above_2 = 2 * k(1) + s * 6 * k(4);
    const double below_2 = 2 * k(6) + s * 6 * k(7);
    const double radial = above / below;
    const double radial_1 = (above_1 - radial * below_1) / below;
    const double radial_2 = (above_2 - 2 * radial_1 * below_1 - radial * below_2) / below;
    const Eigen::Matrix2d outer = d * d_rate.transpose();
    const double p1 = k(2), p2 = k(3);
    const double x = d_rate.x(), y = d_rate.y();
    Eigen::Matrix2d tangential;
    tangential << 2 * p1 * y + 6 * p2 * x, 2 * p1 * x + 2 * p2 * y, 2 * p1 * x + 2 * p2 * y,
        6 * p1 * y + 2 * p2 * x;
    BentRate rate;
    rate.by_direction = radial_1 * s_rate * Eigen::Matrix2d::Identity() +
                        2 * radial_2 * s_rate * d * d.transpose() +
                        2 * radial_1 * (outer + outer.transpose()) + tangential;
    Eigen::Matrix<double, 2, 8> all;
    // Of f(s) d, where f is s^n / below or -radial s^n / below.
    const auto set = [&](Index column, int n, double factor, double factor_1) {
        const double power = std::pow(s, n), power_1 = n * std::pow(s, n - 1);
        const double f = factor * power / below;
        const double f_1 = (factor_1 * power + factor * power_1 - f * below_1) / below;
        all.col(column) = f_1 * s_rate * d + f * d_rate;
    };
    for (int n = 1; n <= 3; ++n) {
        set(n == 3 ? 4 : n - 1, n, 1, 0);
        set(4 + n, n, -radial, -radial_1);
    }
    all.col(2) << 2 * (x * d.y() + d.x() * y), s_rate + 4 * d.y() * y;
    all.col(3) << s_rate + 4 * d.x() * x, 2 * (x * d.y() + d.x() * y);
    rate.by_coefficients = all.leftCols(lens.count);
    return rate;
}

/// Of g(r) d with g = (bent t) / r, and of t^(2 i + 1) / r d for the coefficients.
BentRate fisheye_rate(const Lens& lens, const Vector2d& d, const Vector2d& d_rate) {
    const double* const c = lens.values.data() + 4;
    BentRate rate;
    rate.by_coefficients.setZero(2, 4);
    const double r = d.norm();
    if (r < 1e-9) return rate;
    const double r_rate = d.dot(d_rate) / r;
    const double t = detail::arc_tangent(r, 1), s = t * t, t_1 = 1 / (1 + r * r);
    const double bent_t = t * (1 + s * (c[0] + s * (c[1] + s * (c[2] + s * c[3]))));
    const double by_t = 1 + s * (3 * c[0] + s * (5 * c[1] + s * (7 * c[2] + s * 9 * c[3])));
    const double by_t_1 = t * (6 * c[0] + s * (20 * c[1] + s * (42 * c[2] + s * 72 * c[3])));
    const double bent_1 = by_t * t_1;  // by r
    const double bent_2 = (by_t_1 - 2 * r * by_t) * t_1 * t_1;
    const double g = bent_t / r;
    const double g_1 = (bent_1 - g) / r;
    const double g_2 = (bent_2 - 2 * g_1) / r;
    const Eigen::Matrix2d outer = d * d_rate.transpose();
    rate.by_direction = g_1 * r_rate * Eigen::Matrix2d::Identity() +
                        (g_2 - g_1 / r) / r * r_rate * d * d.transpose() +
                        g_1 / r * (outer + outer.transpose());
    double power = t;
    for (Index i = 0; i < 4; ++i) {
        power *= s;
        const double f = power / r;
        const double f_1 = (static_cast<double>(2 * i + 3) * power / t * t_1 - f) / r;
        rate.by_coefficients.col(i) = f_1 * r_rate * d + f * d_rate;
    }
    return rate;
}

Bent bend_inside(const Lens& lens, const Vector2d& direction) {
    switch (lens.distortion) {
        case Distortion::BrownConrady:
            return bend_brown_conrady(lens, direction);
        case Distortion::Fisheye:
            return bend_fisheye(lens, direction);
        case Distortion::None:
            break;
    }
    return {direction, Eigen::Matrix2d::Identity(), detail::ByValues(2, 0)};
}

/// Beyond the widest direction the polynomial of a lens says nothing; its image goes on outwards
/// from there, in proportion.
Bent bend(const Lens& lens, const Vector2d& direction) {
    const double r = direction.norm();
    if (!(r > lens.widest)) return bend_inside(lens, direction);
    const Vector2d u = direction / r;
    Bent bent = bend_inside(lens, lens.widest * u);
    bent.by_direction = bent.place / lens.widest * u.transpose() +
                        bent.by_direction * (Eigen::Matrix2d::Identity() - u * u.transpose());
    bent.place *= r / lens.widest;
    bent.by_coefficients *= r / lens.widest;
    return bent;
}

BentRate bend_rate(const Lens& lens, const Vector2d& direction, const Vector2d& rate) {
    if (direction.norm() > lens.widest) {
        BentRate outside;
        outside.by_coefficients.setZero(2, lens.count);
        if (rate.isZero(0)) return outside;
        const double step = 1e-3 * direction.norm() / rate.norm();
        const MatrixXd slope = detail::slope_at_zero(step, [&](double time) -> MatrixXd {
            const Bent bent = bend(lens, direction + time * rate);
            MatrixXd both(2, 2 + lens.count);
            both << bent.by_direction, bent.by_coefficients;
            return both;
        });
        outside.by_direction = slope.leftCols<2>();
        outside.by_coefficients = slope.rightCols(lens.count);
        return outside;
    }
    switch (lens.distortion) {
        case Distortion::BrownConrady:
            return brown_conrady_rate(lens, direction, rate);
        case Distortion::Fisheye:
            return fisheye_rate(lens, direction, rate);
        case Distortion::None:
            break;
    }
    return {Eigen::Matrix2d::Zero(), detail::ByValues(2, 0)};
}

Vector2d focal_of(const Lens& lens) { return {lens.values[0], lens.values[1]}; }
Vector2d centre_of(const Lens& lens) { return {lens.values[2], lens.values[3]}; }

/// Behind the camera z is negative, in its plane 1 um.
double depth_of(const Vector3d& point) {
    constexpr double least = 1e-6;  // m
    if (std::abs(point.z()) >= least) return point.z();
    return point.z() < 0 ? -least : least;
}

bool has_count(const Intrinsics& intrinsics) {
    const std::size_t count = intrinsics.coefficients.size();
    switch (intrinsics.distortion) {
        case Distortion::BrownConrady:
            return count == 4 || count == 5 || count == 8;
        case Distortion::Fisheye:
            return count == 4;
        case Distortion::None:
            break;
    }
    return count == 0;
}

}  // namespace

VectorXd Intrinsics::values() const {
    VectorXd values(4 + std::ssize(coefficients));
    values.head<4>() = detail::kpx_per_px * Eigen::Vector4d(fx, fy, cx, cy);
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        values[static_cast<Index>(4 + k)] = coefficients[k];
    }
    return values;
}

Intrinsics Intrinsics::with(const VectorXd& values) const {
    Intrinsics other = *this;
    other.fx = values[0] / detail::kpx_per_px;
    other.fy = values[1] / detail::kpx_per_px;
    other.cx = values[2] / detail::kpx_per_px;
    other.cy = values[3] / detail::kpx_per_px;
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        other.coefficients[k] = values[static_cast<Index>(4 + k)];
    }
    return other;
}

std::vector<std::string> Intrinsics::names() const {
    static const std::vector<std::string> brown_conrady{"k1", "k2", "p1", "p2",
                                                        "k3", "k4", "k5", "k6"};
    std::vector<std::string> names{"fx", "fy", "cx", "cy"};
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        names.push_back(distortion == Distortion::Fisheye ? "k" + std::to_string(k + 1)
                                                          : brown_conrady[k]);
    }
    return names;
}

void check_intrinsics(const Intrinsics& intrinsics) {
    if (!has_count(intrinsics)) {
        throw InputError(fmt::format(
            "the distortion has {} coefficients; must be 4, 5 or 8 of brown_conrady, 4 of fisheye",
            intrinsics.coefficients.size()));
    }
    if (!intrinsics.values().allFinite()) {
        throw InputError("the intrinsic parameters have a value that is not a finite number");
    }
    if (intrinsics.fx > 0 && intrinsics.fy > 0) return;
    throw InputError(
        fmt::format("fx is {:g} px and fy {:g} px, must be above 0", intrinsics.fx, intrinsics.fy));
}

detail::Lens detail::lens_of(const Intrinsics& intrinsics) {
    Lens lens{intrinsics.distortion, std::ssize(intrinsics.coefficients)};
    lens.values = {kpx_per_px * intrinsics.fx, kpx_per_px * intrinsics.fy,
                   kpx_per_px * intrinsics.cx, kpx_per_px * intrinsics.cy};
    std::ranges::copy(intrinsics.coefficients, lens.values.begin() + 4);
    return lens;
}

void detail::differentiate_projection(const Lens& lens, const Vector3d& point,
                                      Projection& projection) {
    const double z = depth_of(point);
    const Vector2d direction = point.head<2>() / z;
    const Bent bent = bend(lens, direction);
    const Vector2d focal = focal_of(lens);
    projection.place = focal.cwiseProduct(bent.place) + centre_of(lens);
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << Eigen::Matrix2d::Identity() / z, -direction / z;
    const Eigen::Matrix2d by_direction = focal.asDiagonal() * bent.by_direction;
    projection.by_point = by_direction * by_point;
    projection.by_values.setZero(2, 4 + lens.count);
    projection.by_values.leftCols<2>() = bent.place.asDiagonal();
    projection.by_values.middleCols<2>(2).setIdentity();
    for (Index k = 0; k < lens.count; ++k) {
        projection.by_values.col(4 + k) = focal.cwiseProduct(bent.by_coefficients.col(k));
    }
}

void detail::differentiate_projection_along(const Lens& lens, const Vector3d& point,
                                            const Vector3d& velocity, Projection& projection,
                                            ProjectionRate& rate) {
    differentiate_projection(lens, point, projection);
    const double z = depth_of(point);
    const double z_rate = z == point.z() ? velocity.z() : 0;
    const Vector2d direction = point.head<2>() / z;
    const Vector2d direction_rate = (velocity.head<2>() - z_rate * direction) / z;
    const BentRate bent_rate = bend_rate(lens, direction, direction_rate);
    const Vector2d focal = focal_of(lens);
    const Eigen::Matrix2d by_direction = z * projection.by_point.leftCols<2>();
    const Eigen::Matrix2d by_direction_rate = focal.asDiagonal() * bent_rate.by_direction;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << Eigen::Matrix2d::Identity() / z, -direction / z;
    rate.by_point = by_direction_rate * by_point - z_rate / z * projection.by_point;
    rate.by_point.col(2) -= by_direction * direction_rate / z;
    rate.by_values.setZero(2, 4 + lens.count);
    rate.by_values.leftCols<2>() =
        (by_direction * direction_rate).cwiseQuotient(focal).asDiagonal();
    rate.by_values.rightCols(lens.count) = focal.asDiagonal() * bent_rate.by_coefficients;
}

Vector2d detail::place_of(const Lens& lens, const Vector3d& point) {
    const Vector2d place = bend(lens, point.head<2>() / depth_of(point)).place;
    return focal_of(lens).cwiseProduct(place) + centre_of(lens);
}

double detail::widest_tangent(Lens lens) {
    constexpr double most = 1e3;
    lens.widest = most;
    if (lens.distortion == Distortion::None) return most;
    if (lens.distortion == Distortion::BrownConrady) lens.values[6] = lens.values[7] = 0;
    double last = 0;
    for (double angle = 0.01; angle < std::atan(most); angle += 0.01) {
        const double tangent = std::tan(angle);
        const double reached = bend(lens, {tangent, 0}).place.x();
        if (!(reached > last)) return std::tan(angle - 0.01);
        last = reached;
    }
    return most;
}

Vector2d project(const Intrinsics& intrinsics, const Vector3d& point) {
    return detail::place_of(detail::lens_of(intrinsics), point) / detail::kpx_per_px;
}

std::optional<Vector2d> undistort(const Intrinsics& intrinsics, const Vector2d& pixel) {
    const Lens lens = detail::lens_of(intrinsics);
    const Vector2d wanted =
        (detail::kpx_per_px * pixel - centre_of(lens)).cwiseQuotient(focal_of(lens));
    constexpr double least = 1e-9;
    Vector2d direction = wanted;
    if (lens.distortion == Distortion::Fisheye) {  // about where an undistorted one is
        constexpr double most_angle = 1.5;
        const double t = std::min(wanted.norm(), most_angle);
        if (t > least) direction = std::tan(t) / t * wanted;
    }
    Bent bent = bend(lens, direction);
    for (int step = 0; step < 50; ++step) {  // Newton's method, with steps halved until they help
        const Vector2d miss = wanted - bent.place;
        if (miss.norm() < 1e-14) break;
        const Vector2d change = bent.by_direction.inverse() * miss;
        if (!change.allFinite()) return std::nullopt;
        double part = 1;
        Bent next = bend(lens, direction + change);
        while (part > 1e-4 && !((wanted - next.place).norm() < miss.norm())) {
            part /= 2;
            next = bend(lens, direction + part * change);
        }
        if (part <= 1e-4) break;
        direction += part * change;
        bent = std::move(next);
    }
    if (!((wanted - bent.place).norm() < least) || !direction.allFinite()) return std::nullopt;
    return direction;
}

}  // namespace posewise
