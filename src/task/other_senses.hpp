#pragma once

#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// In which other sense of the orientations the nominal robot misses them by less than `tolerance`
/// (rad, RMS), into `doubt`.
void find_other_sense(const Campaign& campaign, const Measurements& measurements, double tolerance,
                      OrientationDoubt& doubt);

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
