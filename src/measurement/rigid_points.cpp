#include "rigid_points.hpp"

#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

constexpr double along_axis = 0.3;  // m

}  // namespace

Eigen::Matrix3Xd points_of(const Isometry3d& frame) {
    Eigen::Matrix3Xd points = frame.translation().replicate<1, 4>();
    points.rightCols<3>() += along_axis * frame.linear();
    return points;
}

Isometry3d frame_of(const VectorXd& points) {
    Isometry3d frame = Isometry3d::Identity();
    frame.translation() = points.head<3>();
    const Eigen::Map<const Matrix3d> tips(points.data() + 3);
    frame.linear() = nearest_rotation((tips.colwise() - points.head<3>()) / along_axis);
    return frame;
}

Targets rigid_targets(const std::optional<Isometry3d>& known) {
    std::vector<std::optional<Vector3d>> points(4);
    const Eigen::Matrix3Xd at = points_of(known.value_or(Isometry3d::Identity()));
    for (Index k = 0; k < 4 && known; ++k) points[static_cast<std::size_t>(k)] = at.col(k);
    return Targets(points);
}

}  // namespace posewise::detail
