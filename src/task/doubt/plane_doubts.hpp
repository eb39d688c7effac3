#pragma once

#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// Whether two normals are 45 deg and more apart, and as far from opposite.
bool is_turned(const Vector3d& normal, const Vector3d& other);

/// A plane that was found far from where it was stated: it is another face, or the poses do not
/// tell it.
struct TurnedPlane {
    Index plane = 0;
    double angle = 0;  ///< between the normals, rad
};
std::vector<TurnedPlane> find_turned_planes(const Campaign& campaign, const VectorXd& unknowns);

}  // namespace posewise::detail
