#include "board_starts.hpp"

#include <cmath>

#include "core/decompositions.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

constexpr double flat = 1e-6;

/// Middle, principal directions as columns and extents along them, the largest first.
struct Shape {
    Vector3d middle;
    Matrix3d axes;
    Vector3d extents;
};

Shape shape_of(const std::vector<Vector3d>& corners) {
    MatrixXd points(3, std::ssize(corners));
    for (Index k = 0; k < points.cols(); ++k) points.col(k) = corners[static_cast<std::size_t>(k)];
    Shape shape;
    shape.middle = points.rowwise().mean();
    points.colwise() -= shape.middle;
    const detail::SingularDirections directions = detail::singular_directions(points.transpose());
    shape.axes = directions.V;
    if (shape.axes.determinant() < 0) shape.axes.col(2) *= -1;
    shape.extents = directions.values;
    return shape;
}

/// Points moved to their middle and scaled to a distance of about 1 [Hartley & Zisserman
/// 2004, 4.4].
struct Scaled {
    std::vector<Vector2d> points;
    Matrix3d scaled_from_points;
};

Scaled scale(const std::vector<Vector2d>& points) {
    const auto count = static_cast<double>(points.size());
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& p : points) middle += p / count;
    double square = 0;
    for (const Vector2d& p : points) square += (p - middle).squaredNorm() / count;
    const double factor = square > 0 ? std::sqrt(2 / square) : 1;
    Scaled result;
    for (const Vector2d& p : points) result.points.push_back(factor * (p - middle));
    result.scaled_from_points << factor, 0, -factor * middle.x(), 0, factor, -factor * middle.y(),
        0, 0, 1;
    return result;
}

/// The plane's frame in the camera's, from the homography to directions; before the camera.
Isometry3d pose_of(Matrix3d H) {
    if (H(2, 2) < 0) H = -H;  // the origin is before the camera
    H /= std::sqrt(H.col(0).norm() * H.col(1).norm());
    Matrix3d R;
    R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = nearest_rotation(R);
    pose.translation() = H.col(2);
    return pose;
}

/// The same board leant over to the other side of the line of sight, which looks nearly alike from
/// afar [Schweighofer & Pinz 2006].
Isometry3d leant_over(const Isometry3d& pose) {
    Isometry3d other = pose;
    const Vector3d sight = pose.translation().normalized();
    const Vector3d normal = pose.linear().col(2);
    const Vector3d mirrored = 2 * sight * sight.dot(normal) - normal;
    other.linear() = rotation_between(normal, mirrored) * pose.linear();
    return other;
}

/// Points in no plane, their middle and how far they are from it.
struct Body {
    Vector3d middle;
    double size = 0;
    std::vector<Vector3d> points;  ///< from the middle, in sizes
};

Body body_of(const std::vector<Vector3d>& corners) {
    const Shape shape = shape_of(corners);
    Body body{
        shape.middle, shape.extents.norm() / std::sqrt(static_cast<double>(corners.size())), {}};
    for (const Vector3d& corner : corners) {
        body.points.emplace_back((corner - body.middle) / body.size);
    }
    return body;
}

/// As if all points were equally deep, in a camera turned towards them [DeMenthon & Davis 1995]:
/// good for what is small or far away, and where the projection leaves too much open.
std::optional<Isometry3d> distant_pose_of(const Body& body,
                                          const std::vector<Vector2d>& directions) {
    const Index count = std::ssize(directions);
    Vector3d sight = Vector3d::Zero();
    for (const Vector2d& direction : directions) sight += direction.homogeneous().normalized();
    const Matrix3d towards = rotation_between(sight, Vector3d::UnitZ());
    MatrixXd A(count, 4), b(count, 2);
    for (Index k = 0; k < count; ++k) {
        const auto point = static_cast<std::size_t>(k);
        A.row(k) << body.points[point].transpose(), 1;
        b.row(k) = (towards * directions[point].homogeneous()).hnormalized().transpose();
    }
    const Eigen::Matrix<double, 4, 2> solution = solve_least_squares(A, b);
    const Vector3d x = solution.col(0).head<3>(), y = solution.col(1).head<3>();
    const double depth = 1 / std::sqrt(x.norm() * y.norm());
    if (!std::isfinite(depth)) return std::nullopt;
    Matrix3d R;
    R << x * depth, y * depth, x.cross(y) * depth * depth;
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = nearest_rotation(R.transpose());
    pose.translation() = body.size * depth * Vector3d(solution(3, 0), solution(3, 1), 1);
    pose = Isometry3d(towards.transpose()) * pose;
    pose.translation() -= pose.linear() * body.middle;
    return pose;
}

/// By the linear equations of the projection; they need six points.
std::optional<Isometry3d> projected_pose_of(const Body& body,
                                            const std::vector<Vector2d>& directions) {
    if (directions.size() < 6) return std::nullopt;
    MatrixXd A = MatrixXd::Zero(2 * std::ssize(directions), 12);
    for (std::size_t k = 0; k < directions.size(); ++k) {
        const Eigen::RowVector4d X = body.points[k].homogeneous().transpose();
        const auto row = static_cast<Index>(2 * k);
        A.block<1, 4>(row, 0) = A.block<1, 4>(row + 1, 4) = X;
        A.block<1, 4>(row, 8) = -directions[k].x() * X;
        A.block<1, 4>(row + 1, 8) = -directions[k].y() * X;
    }
    Eigen::Matrix<double, 3, 4> P = null_vector(A).reshaped<Eigen::RowMajor>(3, 4);
    if (P(2, 3) < 0) P = -P;
    const Matrix3d M = P.leftCols<3>();
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = nearest_rotation(M);
    const double scale = (pose.linear().transpose() * M).trace() / 3;
    if (!(scale > 0)) return std::nullopt;
    pose.translation() = body.size * P.col(3) / scale - pose.linear() * body.middle;
    return pose;
}

}  // namespace

VectorXd null_vector(const MatrixXd& A) { return singular_directions(A).V.rightCols<1>(); }

Matrix3d homography(const std::vector<Vector2d>& plane, const std::vector<Vector2d>& image) {
    const Scaled from = scale(plane), to = scale(image);
    MatrixXd A = MatrixXd::Zero(2 * std::ssize(plane), 9);
    for (std::size_t k = 0; k < plane.size(); ++k) {
        const Eigen::RowVector3d X = from.points[k].homogeneous().transpose();
        const auto row = static_cast<Index>(2 * k);
        A.block<1, 3>(row, 0) = A.block<1, 3>(row + 1, 3) = X;
        A.block<1, 3>(row, 6) = -to.points[k].x() * X;
        A.block<1, 3>(row + 1, 6) = -to.points[k].y() * X;
    }
    const Matrix3d H = null_vector(A).reshaped<Eigen::RowMajor>(3, 3);
    return to.scaled_from_points.inverse() * H * from.scaled_from_points;
}

std::vector<Vector2d> in_plane(const std::vector<Vector3d>& corners, const Isometry3d& plane) {
    std::vector<Vector2d> points;
    for (const Vector3d& corner : corners) {
        points.emplace_back((plane.inverse() * corner).head<2>());
    }
    return points;
}

std::optional<Isometry3d> plane_of(const std::vector<Vector3d>& corners) {
    const Shape shape = shape_of(corners);
    if (shape.extents[2] > flat * shape.extents[0]) return std::nullopt;
    Isometry3d plane = Isometry3d::Identity();
    plane.linear() = shape.axes;
    plane.translation() = shape.middle;
    return plane;
}

bool are_in_line(const std::vector<Vector3d>& corners) {
    const Shape shape = shape_of(corners);
    return shape.extents[1] <= flat * shape.extents[0];
}

std::vector<Isometry3d> board_starts(const std::vector<Vector3d>& corners,
                                     const std::vector<Vector2d>& directions) {
    std::vector<Isometry3d> starts;
    if (const auto plane = plane_of(corners)) {
        const Isometry3d pose = pose_of(homography(in_plane(corners, *plane), directions));
        for (const Isometry3d& start : {pose, leant_over(pose)}) {
            starts.push_back(start * plane->inverse());
        }
    } else {
        const Body body = body_of(corners);
        for (const auto& start :
             {distant_pose_of(body, directions), projected_pose_of(body, directions)}) {
            if (start) starts.push_back(*start);
        }
    }
    return starts;
}

}  // namespace posewise::detail
