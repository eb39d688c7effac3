#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "target_text.hpp"

// Targets that are stated by coordinates.

namespace posewise::detail {
namespace {

using io::ProgramFormat;

constexpr double turn = 2 * std::numbers::pi;
constexpr double quadrant = std::numbers::pi / 2;

/// ABB's cf1, cf4 and cf6.
constexpr std::array<Index, 3> abb_axes{0, 3, 5};

/// In the unit of the format's lengths and angles.
double length_of(ProgramFormat format, double si) {
    return format == ProgramFormat::Ur ? si : mm_per_m * si;
}

/// Angles that are the same as these, nearest to others.
Vector3d near_angles(const Vector3d& angles, const Vector3d& others) {
    Vector3d near = angles;
    for (Index k = 0; k < 3; ++k) near[k] -= turn * std::round((angles[k] - others[k]) / turn);
    return near;
}

/// Roll, pitch and yaw of a rotation, of both ways to state it those nearest to others.
Vector3d near_rpy(const Matrix3d& R, const Vector3d& others) {
    const Vector3d rpy = rpy_from_rotation(R);
    constexpr double half = std::numbers::pi;
    const Vector3d one = near_angles(rpy, others);
    const Vector3d other =
        near_angles(Vector3d(rpy[0] + half, half - rpy[1], rpy[2] + half), others);
    return (one - others).norm() <= (other - others).norm() ? one : other;
}

/// Rotation vector, of those that differ by whole turns the one nearest to another.
Vector3d near_vector(const Matrix3d& R, const Vector3d& other) {
    const Vector3d vector = vector_from_rotation(R);
    const double angle = vector.norm();
    if (angle == 0) return vector;
    const Vector3d around = vector * ((angle - turn) / angle);
    return (around - other).norm() < (vector - other).norm() ? around : vector;
}

Eigen::Vector4d near_quaternion(const Matrix3d& R, const Eigen::Vector4d& other) {
    const Eigen::Quaterniond q(R);
    const Eigen::Vector4d values(q.w(), q.x(), q.y(), q.z());
    return (values + other).norm() < (values - other).norm() ? Eigen::Vector4d(-values) : values;
}

Matrix3d rotation_of(ProgramFormat format, const std::vector<double>& n) {
    const auto degrees = [&](std::size_t k) { return to_radians(n[k]); };
    switch (format) {
        case ProgramFormat::Fanuc:  // W, P, R about fixed x, y, z
            return rotation_from_rpy({degrees(3), degrees(4), degrees(5)});
        case ProgramFormat::Kuka:  // A, B, C about z, y', x''
            return rotation_from_rpy({degrees(5), degrees(4), degrees(3)});
        case ProgramFormat::Abb: {
            const Eigen::Quaterniond q(n[3], n[4], n[5], n[6]);
            constexpr double tolerance = 1e-3;
            if (!(std::abs(q.norm() - 1) <= tolerance)) {
                throw InputError(fmt::format(
                    "has a quaternion of length {:g}; must be 1 within 0.001", q.norm()));
            }
            return q.normalized().toRotationMatrix();
        }
        default:
            return rotation_from_vector({n[3], n[4], n[5]});
    }
}

std::vector<double> orientation_numbers(ProgramFormat format, const Matrix3d& R,
                                        const std::vector<double>& n) {
    const auto degrees = [](const Vector3d& v) { return Vector3d(v * (180 / std::numbers::pi)); };
    const auto old_angles = [&](std::size_t a, std::size_t b, std::size_t c) {
        return Vector3d(to_radians(n[a]), to_radians(n[b]), to_radians(n[c]));
    };
    switch (format) {
        case ProgramFormat::Fanuc: {
            const Vector3d rpy = degrees(near_rpy(R, old_angles(3, 4, 5)));
            return {rpy[0], rpy[1], rpy[2]};
        }
        case ProgramFormat::Kuka: {
            const Vector3d rpy = degrees(near_rpy(R, old_angles(5, 4, 3)));
            return {rpy[2], rpy[1], rpy[0]};
        }
        case ProgramFormat::Abb: {
            const Eigen::Vector4d q = near_quaternion(R, {n[3], n[4], n[5], n[6]});
            return {q[0], q[1], q[2], q[3]};
        }
        default: {
            const Vector3d vector = near_vector(R, {n[3], n[4], n[5]});
            return {vector[0], vector[1], vector[2]};
        }
    }
}

/// The numbers of a configuration for these controller joints.
std::vector<long> states_of(const io::PlaceTarget& place, ProgramFormat format,
                            const VectorXd& joints) {
    if (place.configuration.empty()) return {};
    if (format == ProgramFormat::Kuka) {
        long turns = 0;
        for (Index j = 0; j < joints.size(); ++j) {
            if (joints[j] < 0) turns |= 1L << j;
        }
        // Bits of external axes stay.
        return {turns | (place.states[0] & ~((1L << joints.size()) - 1))};
    }
    std::vector<long> states;
    for (const Index axis : abb_axes)
        states.push_back(std::lround(std::floor(joints[axis] / quadrant)));
    return states;
}

void check_fanuc_turns(const io::PlaceTarget& place, const io::CorrectedPlace& corrected) {
    for (Index j = 0; j < corrected.joints.size(); ++j) {
        if (std::round(corrected.joints[j] / turn) == std::round(corrected.nominal[j] / turn)) {
            continue;
        }
        throw InputError(fmt::format(
            "target {} is corrected from {:.3f} to {:.3f} deg of J{}, which needs another turn "
            "number in its CONFIG; must be moved away from there, or be stated by joint values",
            quote(place.id), to_degrees(corrected.nominal[j]), to_degrees(corrected.joints[j]),
            j + 1));
    }
}

}  // namespace

Isometry3d place_of(ProgramFormat format, const std::vector<double>& numbers) {
    Isometry3d place = Isometry3d::Identity();
    for (std::size_t k = 0; k < 3; ++k) {
        const double si = format == ProgramFormat::Ur ? numbers[k] : numbers[k] / mm_per_m;
        if (!is_plausible(si, Quantity::Length)) {
            throw InputError(fmt::format("is at {:g}, where no cell is", numbers[k]));
        }
        place.translation()[static_cast<Index>(k)] = si;
    }
    constexpr double most = 1e4;  // of an angle
    for (std::size_t k = 3; k < numbers.size(); ++k) {
        if (std::abs(numbers[k]) <= most) continue;
        throw InputError(fmt::format("is turned by {:g}; must be an angle", numbers[k]));
    }
    place.linear() = rotation_of(format, numbers);
    return place;
}

std::vector<double> numbers_of_place(ProgramFormat format, const Isometry3d& place,
                                     const std::vector<double>& before) {
    std::vector<double> numbers;
    for (Index k = 0; k < 3; ++k) numbers.push_back(length_of(format, place.translation()[k]));
    for (const double number : orientation_numbers(format, place.linear(), before)) {
        numbers.push_back(number);
    }
    return numbers;
}

std::vector<std::pair<io::TextSpan, std::string>> place_texts(const io::TargetProgram& program,
                                                              std::size_t place,
                                                              ProgramFormat format,
                                                              const io::CorrectedPlace& corrected) {
    const io::PlaceTarget& target = program.places[place];
    if (format == ProgramFormat::Fanuc) check_fanuc_turns(target, corrected);
    std::vector<double> before;
    for (const io::TextSpan& span : target.values) {
        before.push_back(number_at(program.content, span));
    }
    const std::vector<double> numbers = numbers_of_place(format, corrected.frame_from_tool, before);
    constexpr int quaternion_decimals = 8;
    std::vector<std::pair<io::TextSpan, std::string>> texts;
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        const bool is_quaternion = format == ProgramFormat::Abb && k >= 3;
        const io::TextSpan span = target.values[k];
        texts.emplace_back(
            span, number_text(
                      std::string_view(program.content).substr(span.begin, span.end - span.begin),
                      is_quaternion ? quaternion_decimals : target_kind_of(format)->rules.decimals,
                      numbers[k]));
    }
    const std::vector<long> states = states_of(target, format, corrected.joints);
    for (std::size_t k = 0; k < states.size(); ++k) {
        if (states[k] == target.states[k]) continue;
        texts.emplace_back(target.configuration[k], std::to_string(states[k]));
    }
    return texts;
}

}  // namespace posewise::detail

namespace posewise::io {

bool is_of_configuration(const PlaceTarget& place, ProgramFormat format, const VectorXd& joints) {
    constexpr double tolerance = to_radians(0.05);  // of a program's digits
    if (place.configuration.empty()) return true;
    if (format == ProgramFormat::Kuka) {
        for (Index j = 0; j < joints.size(); ++j) {
            const bool is_negative = ((place.states[0] >> j) & 1) != 0;
            if ((is_negative ? joints[j] : -joints[j]) > tolerance) return false;
        }
        return true;
    }
    for (std::size_t k = 0; k < detail::abb_axes.size(); ++k) {
        const double into =
            joints[detail::abb_axes[k]] - detail::quadrant * static_cast<double>(place.states[k]);
        if (into < -tolerance || into > detail::quadrant + tolerance) return false;
    }
    return true;
}

}  // namespace posewise::io
