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
namespace {

void check_names(const std::vector<Socket>& sockets) {
    for (std::size_t k = 0; k < sockets.size(); ++k) {
        const std::string& name = sockets[k].name;
        if (name.empty()) throw InputError(fmt::format("socket {} has no name", k + 1));
        const auto is_same = [&name](const Socket& other) { return other.name == name; };
        if (std::none_of(sockets.begin(), sockets.begin() + static_cast<std::ptrdiff_t>(k),
                         is_same)) {
            continue;
        }
        throw InputError(fmt::format("two sockets are called {}", detail::quote(name)));
    }
}

void check_distances(const std::vector<Socket>& sockets) {
    for (Index k = 0; k < std::ssize(sockets); ++k) {
        const Socket& socket = sockets[static_cast<std::size_t>(k)];
        if (!socket.position.allFinite()) {
            throw InputError(
                fmt::format("the position of socket {} is not finite", detail::quote(socket.name)));
        }
        if (socket.from < 0) continue;
        if (socket.from >= k) {
            throw InputError(
                fmt::format("socket {} is at a distance from one that is not before it",
                            detail::quote(socket.name)));
        }
        const Socket& other = sockets[static_cast<std::size_t>(socket.from)];
        if (!(std::isfinite(socket.distance) && socket.distance > 0) ||
            (socket.position - other.position).norm() <= 0) {
            throw InputError(
                fmt::format("sockets {} and {} must be at two places, their distance above 0",
                            detail::quote(other.name), detail::quote(socket.name)));
        }
    }
}

/// Of a socket from the one that its distance is known from.
detail::TiltedDirection direction_to(const Socket& socket, const std::vector<Socket>& sockets,
                                     const Eigen::Vector2d& tilts) {
    const Socket& from = sockets[static_cast<std::size_t>(socket.from)];
    return detail::tilt((socket.position - from.position).normalized(), tilts[0], tilts[1]);
}

}  // namespace

SocketSensor::SocketSensor(Targets ball, std::vector<Socket> sockets, bool are_known, double sigma)
    : ball_(std::move(ball)), sockets_(std::move(sockets)), are_known_(are_known), sigma_(sigma) {
    if (sockets_.empty()) throw InputError("a sensor of sockets needs at least one socket");
    if (ball_.count() != 1) {
        throw InputError(
            fmt::format("sockets take one target, the ball; there are {}", ball_.count()));
    }
    detail::check_sigma("sigma", sigma, "m");
    check_names(sockets_);
    check_distances(sockets_);
    Index next = ball_.unknown_count();
    for (Index k = 0; k < target_count(); ++k) {
        unknown_index_.push_back(next);
        next += has_distance(k) ? 2 : 3;
    }
}

std::vector<std::string> SocketSensor::contact_names() const {
    std::vector<std::string> names;
    for (const Socket& socket : sockets_) names.push_back(socket.name);
    return names;
}

std::vector<std::string> SocketSensor::observation_names() const {
    std::vector<std::string> names;
    for (const Socket& socket : sockets_) {
        for (const char axis : {'x', 'y', 'z'}) names.push_back(socket.name + '_' + axis);
    }
    return names;
}

std::vector<std::string> SocketSensor::unknown_names() const {
    std::vector<std::string> names = ball_.unknown_names();
    for (Index k = 0; k < target_count() && !are_known_; ++k) {
        const auto parts = has_distance(k) ? std::vector<std::string>{"tilt1", "tilt2"}
                                           : std::vector<std::string>{"x", "y", "z"};
        for (const std::string& part : parts) {
            names.push_back("socket." + of(k).name + '.' + part);
        }
    }
    return names;
}

std::vector<bool> SocketSensor::unknown_is_angle() const {
    std::vector<bool> is_angle(static_cast<std::size_t>(ball_.unknown_count()), false);
    for (Index k = 0; k < target_count() && !are_known_; ++k) {
        is_angle.insert(is_angle.end(), has_distance(k) ? 2 : 3, has_distance(k));
    }
    return is_angle;
}

Vector3d SocketSensor::socket_position(Index socket, const VectorXd& unknowns) const {
    if (are_known_) return of(socket).position;
    const Index first = unknown_index_[static_cast<std::size_t>(socket)];
    if (!has_distance(socket)) return unknowns.segment<3>(first);
    return socket_position(of(socket).from, unknowns) +
           of(socket).distance *
               direction_to(of(socket), sockets_, unknowns.segment<2>(first)).value;
}

void SocketSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                           Eigen::Ref<VectorXd> observation) const {
    const Vector3d ball = world_from_flange * ball_.position(0, unknowns);
    for (Index k = 0; k < target_count(); ++k) {
        observation.segment<3>(3 * k) = ball - socket_position(k, unknowns);
    }
}

void SocketSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    auto of_ball = J_measured_parameters.topRows<3>();
    ball_.differentiate(world_from_flange, twists, unknowns, of_ball);
    for (Index k = 1; k < target_count(); ++k) {
        J_measured_parameters.middleRows<3>(3 * k) = of_ball;
    }
    if (are_known_ || J_measured_parameters.cols() == twists.cols()) return;
    for (Index k = 0; k < target_count(); ++k) {
        auto J = J_measured_parameters.middleRows<3>(3 * k);
        Index socket = k;
        for (; has_distance(socket); socket = of(socket).from) {
            const Index first = unknown_index_[static_cast<std::size_t>(socket)];
            const detail::TiltedDirection direction =
                direction_to(of(socket), sockets_, unknowns.segment<2>(first));
            J.col(twists.cols() + first) -= of(socket).distance * direction.by_tilt1;
            J.col(twists.cols() + first + 1) -= of(socket).distance * direction.by_tilt2;
        }
        J.middleCols<3>(twists.cols() + unknown_index_[static_cast<std::size_t>(socket)]) -=
            Matrix3d::Identity();
    }
}

void SocketSensor::differentiate_along(const Isometry3d& world_from_flange,
                                       const TwistMatrix& twists, const Twist& direction,
                                       const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                       Eigen::Ref<RowMatrixXd> J_rate) const {
    RowMatrixXd of_ball(3, J_rate.cols());
    ball_.differentiate_along(world_from_flange, twists, direction, twist_rates, unknowns, of_ball);
    for (Index k = 0; k < target_count(); ++k) J_rate.middleRows<3>(3 * k) = of_ball;
}

void SocketSensor::covariance(const Isometry3d&, const VectorXd&,
                              Eigen::Ref<MatrixXd> covariance) const {
    covariance = sigma_ * sigma_ * MatrixXd::Identity(row_count(), row_count());
}

SensorWords SocketSensor::words() const {
    Index distances = 0;
    for (const Socket& socket : sockets_) distances += socket.from >= 0 ? 1 : 0;
    SensorWords words;
    words.readings = "contacts";
    words.place = "the ball";
    words.unknowns = "ball in the flange frame, sockets in the world";
    words.known = {are_known_ ? "base.known" : "sensor.known_sockets", "sensor.targets.known"};
    words.sentence = fmt::format(
        "a ball in {} ({}{}), {}, sigma {} mm", detail::count_of(target_count(), "socket"),
        are_known_ ? "known" : "to be identified",
        distances > 0 && !are_known_
            ? fmt::format(", {} known", detail::count_of(distances, "distance"))
            : "",
        describe(ball_), detail::format_short(mm_per_m * sigma_));
    return words;
}

}  // namespace posewise
