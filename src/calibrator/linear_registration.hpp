#pragma once

#include <optional>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// What observed points tell of base and targets: A (rows of X, c, t) = b, three equations for each
/// point p_ij that configuration i shows, X p_ij + c - R_i t_j = p_i, with X = R_base^T and
/// c = -X p_base (m), t the points' unknown coordinates in the flange frame (m), and R_i, p_i the
/// flange in the base frame.
struct RegistrationEquations {
    MatrixXd A;  ///< equations x (9 + 3 + unknown coordinates)
    VectorXd b;
};

struct RegistrationSolution {
    Matrix3d X;  ///< a rotation
    Vector3d c;
    VectorXd t;
};

/// Least squares with X any matrix, then projected on the rotations. Nothing if noise would decide:
/// points that all lie in a plane (a planar robot), or a robot without a length to compare with
/// (two axes that cross), leave a part of X open.
std::optional<RegistrationSolution> solve_freely(const RegistrationEquations& equations);

/// Which views belong together, of equations that are so many of each: some may show another pose
/// than the joints say, or a board's corners in another order. Of solve_freely() by few views that
/// counts which misses the median view least [Rousseeuw 1984]; views that it misses by far more are
/// left out.
std::vector<Index> find_consistent(const RegistrationEquations& equations, Index of_each);

/// Least squares over the rotations X; c and t of least norm where several are as good. Needs at
/// least as many equations as unknowns.
RegistrationSolution solve_for_rotation(const RegistrationEquations& equations);

}  // namespace posewise::detail
