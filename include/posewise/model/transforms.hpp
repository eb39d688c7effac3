#pragma once

#include <vector>

#include "posewise/model/chain.hpp"

/// Any constant transform, and a joint about any axis, as elementary transforms.
namespace posewise {

/// Rz(yaw) Ry(pitch) Rx(roll) of (roll, pitch, yaw): turns about the fixed x, y and z axes, rad.
Matrix3d rotation_from_rpy(const Vector3d& rpy);

/// The rotation about `vector` by its norm, rad.
Matrix3d rotation_from_vector(const Vector3d& vector);

/// The rotation vector of a rotation matrix, its norm at most pi.
Vector3d vector_from_rotation(const Matrix3d& R);

/// The rotation nearest to a matrix (least squares), by its singular values.
Matrix3d nearest_rotation(const Matrix3d& X);

/// The left Jacobian of the rotations [Barfoot 2017, (7.77)]: while a rotation vector changes at
/// the rate r, its rotation turns with the angular velocity (this matrix) r.
Matrix3d rotation_vector_rate(const Vector3d& vector);

/// [vector]x: what the cross product with it does.
Matrix3d cross_matrix(const Vector3d& vector);

/// (roll, pitch, yaw) of a rotation matrix, pitch within +-pi/2. They give the matrix back to
/// rounding, also where the pitch is so near to +-pi/2 that roll and yaw are one turn.
Vector3d rpy_from_rotation(const Matrix3d& R);

/// A constant transform as Tx Ty Tz Rz Ry Rx, those that do nothing left out.
std::vector<Element> origin_elements(const Vector3d& xyz, const Vector3d& rpy);

/// A joint about or along a unit vector. The coordinate axis nearest to it is turned into it, the
/// joint drives an element of that axis (reversed if the vector points against it), and the frame
/// is turned back: at most Ri Rj E(+-q) Rj Ri. A vector along a coordinate axis needs one element.
std::vector<Element> joint_elements(Motion motion, const Vector3d& axis, Index joint);

}  // namespace posewise
