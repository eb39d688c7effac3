#include "orientation_senses.hpp"

#include <array>
#include <numbers>
#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

Matrix3d turn(int axis, double angle) { return rotation_from_vector(angle * Vector3d::Unit(axis)); }

// ---- What three numbers, in the order of their columns, may mean ----

Matrix3d fixed_xyz(const Vector3d& v) { return rotation_from_rpy(v); }
Matrix3d fixed_zyx(const Vector3d& v) { return turn(0, v[2]) * turn(1, v[1]) * turn(2, v[0]); }
/// A, B, C of KUKA; Euler angles z, y', x".
Matrix3d turned_zyx(const Vector3d& v) { return rotation_from_rpy(v.reverse()); }
Matrix3d turned_xyz(const Vector3d& v) { return turn(0, v[0]) * turn(1, v[1]) * turn(2, v[2]); }
Matrix3d turned_zyz(const Vector3d& v) { return turn(2, v[0]) * turn(1, v[1]) * turn(2, v[2]); }
Matrix3d turned_zxz(const Vector3d& v) { return turn(2, v[0]) * turn(0, v[1]) * turn(2, v[2]); }

constexpr double deg_per_rad = 180 / std::numbers::pi;

Matrix3d inverted(const Vector3d& read) { return rotation_from_vector(-read); }
Matrix3d larger_vector(const Vector3d& read) { return rotation_from_vector(deg_per_rad * read); }
Matrix3d smaller_vector(const Vector3d& read) { return rotation_from_vector(read / deg_per_rad); }
Matrix3d inverted_rpy(const Vector3d& rpy) { return rotation_from_rpy(rpy).transpose(); }
Matrix3d larger_rpy(const Vector3d& rpy) { return rotation_from_rpy(deg_per_rad * rpy); }
Matrix3d smaller_rpy(const Vector3d& rpy) { return rotation_from_rpy(rpy / deg_per_rad); }

// ---- Quaternions: which of the numbers that were read as w, x, y, z stands where ----

template <int w, int x, int y, int z, int sign>
Matrix3d reordered(const Vector3d& read) {
    const Eigen::Quaterniond q(rotation_from_vector(read));
    const std::array numbers{q.w(), q.x(), q.y(), q.z()};
    return Eigen::Quaterniond(numbers[w], sign * numbers[x], sign * numbers[y], sign * numbers[z])
        .toRotationMatrix();
}

// ---- The tables ----

constexpr const char* convert = "convert them to roll, pitch, yaw";

/// Angles about axes, whichever three numbers of an orientation they were read as.
const std::vector<OrientationSense> of_angles{
    {"as yaw, pitch, roll (angles about z, the turned y and the turned x)",
     "name the columns yaw, pitch, roll", turned_zyx},
    {"as Euler angles about x, the turned y and the turned z", convert, turned_xyz},
    {"as Euler angles about z, the turned y and the turned z", convert, turned_zyz},
    {"as Euler angles about z, the turned x and the turned z", convert, turned_zxz},
    {"as angles about the fixed axes z, y and x", convert, fixed_zyx},
};

/// The likeliest, then angles about axes, then others.
std::vector<OrientationSense> around_angles(const OrientationSense& likeliest,
                                            const std::vector<OrientationSense>& others) {
    std::vector<OrientationSense> all{likeliest};
    all.insert(all.end(), of_angles.begin(), of_angles.end());
    all.insert(all.end(), others.begin(), others.end());
    return all;
}

const std::vector<OrientationSense> of_vectors = around_angles(
    {"as roll, pitch, yaw about fixed axes", "name the columns roll, pitch, yaw", fixed_xyz},
    {
        {"inverted", "turn round their signs", inverted},
        {"in degrees where the file says rad", "name the columns rx_deg, ry_deg, rz_deg",
         smaller_vector},
        {"in rad where the file says degrees", "name the columns rx_rad, ry_rad, rz_rad",
         larger_vector},
    });

const std::vector<OrientationSense> of_rpy_angles =
    around_angles({"as a rotation vector", "name the columns rx, ry, rz", rotation_from_vector},
                  {
                      {"inverted", "invert the rotations", inverted_rpy},
                      {"in degrees where the file says rad",
                       "name the columns roll_deg, pitch_deg, yaw_deg", smaller_rpy},
                      {"in rad where the file says degrees",
                       "name the columns roll_rad, pitch_rad, yaw_rad", larger_rpy},
                  });

const std::array<OrientationSense, 10> of_quaternions{{
    {"conjugate", "turn round the signs of qx, qy and qz", inverted},
    {"with the last number of each as its real part", "name the columns qx, qy, qz, qw",
     reordered<3, 0, 1, 2, 1>},
    {"conjugate and with the last number of each as its real part",
     "name the columns qx, qy, qz, qw and turn round the signs of qx, qy and qz",
     reordered<3, 0, 1, 2, -1>},
    {"with the number called qx as its real part",
     "rename qx to qw, qy to qx, qz to qy and qw to qz", reordered<1, 2, 3, 0, 1>},
    {"with qy and qz exchanged", "exchange the names of these columns", reordered<0, 1, 3, 2, 1>},
    {"with qx and qz exchanged", "exchange the names of these columns", reordered<0, 3, 2, 1, 1>},
    {"with qx and qy exchanged", "exchange the names of these columns", reordered<0, 2, 1, 3, 1>},
    {"conjugate and with qy and qz exchanged",
     "exchange the names of these columns and turn round the signs of qx, qy and qz",
     reordered<0, 1, 3, 2, -1>},
    {"conjugate and with qx and qz exchanged",
     "exchange the names of these columns and turn round the signs of qx, qy and qz",
     reordered<0, 3, 2, 1, -1>},
    {"conjugate and with qx and qy exchanged",
     "exchange the names of these columns and turn round the signs of qx, qy and qz",
     reordered<0, 2, 1, 3, -1>},
}};

}  // namespace

std::span<const OrientationSense> orientation_senses(OrientationNotation notation) {
    switch (notation) {
        case OrientationNotation::RotationVector:
            break;
        case OrientationNotation::RollPitchYaw:
            return of_rpy_angles;
        case OrientationNotation::Quaternion:
            return of_quaternions;
    }
    return of_vectors;
}

std::string orientation_columns(OrientationNotation notation) {
    switch (notation) {
        case OrientationNotation::RotationVector:
            break;
        case OrientationNotation::RollPitchYaw:
            return "roll, pitch, yaw";
        case OrientationNotation::Quaternion:
            return "qw, qx, qy, qz";
    }
    return "rx, ry, rz";
}

}  // namespace posewise::detail
