#include "board_pose.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <cmath>

#include "camera_model.hpp"
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
    const Eigen::JacobiSVD<MatrixXd> svd(points * points.transpose(), Eigen::ComputeFullU);
    shape.axes = svd.matrixU();
    if (shape.axes.determinant() < 0) shape.axes.col(2) *= -1;
    // Not by singular values of the squares, which would be exact to 1e-8 only.
    for (Index axis = 0; axis < 3; ++axis) {
        shape.extents[axis] = (shape.axes.col(axis).transpose() * points).norm();
    }
    return shape;
}

/// The vector that A makes smallest.
VectorXd null_vector(const MatrixXd& A) {
    return Eigen::JacobiSVD<MatrixXd>(A, Eigen::ComputeFullV).matrixV().rightCols<1>();
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
    other.linear() =
        Eigen::Quaterniond::FromTwoVectors(normal, mirrored).toRotationMatrix() * pose.linear();
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
    const auto towards = Eigen::Quaterniond::FromTwoVectors(sight, Vector3d::UnitZ());
    MatrixXd A(count, 4), b(count, 2);
    for (Index k = 0; k < count; ++k) {
        const auto point = static_cast<std::size_t>(k);
        A.row(k) << body.points[point].transpose(), 1;
        b.row(k) = (towards * directions[point].homogeneous()).hnormalized().transpose();
    }
    const Eigen::Matrix<double, 4, 2> solution = A.householderQr().solve(b);
    const Vector3d x = solution.col(0).head<3>(), y = solution.col(1).head<3>();
    const double depth = 1 / std::sqrt(x.norm() * y.norm());
    if (!std::isfinite(depth)) return std::nullopt;
    Matrix3d R;
    R << x * depth, y * depth, x.cross(y) * depth * depth;
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = nearest_rotation(R.transpose());
    pose.translation() = body.size * depth * Vector3d(solution(3, 0), solution(3, 1), 1);
    pose = towards.inverse() * pose;
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

/// Moves a pose by a small rotation about the camera's axes and a translation.
Isometry3d moved_by(const Isometry3d& pose, const VectorXd& step) {
    Isometry3d moved = pose;
    moved.linear() = rotation_from_vector(step.head<3>()) * pose.linear();
    moved.translation() += step.segment<3>(3);
    return moved;
}

/// Residuals in the image (1000 px) and their derivatives by moved_by() and Intrinsics::values().
struct ViewEquations {
    VectorXd residuals;
    MatrixXd by_pose;
    MatrixXd by_values;
};

ViewEquations equations_of(const BoardView& view, const Intrinsics& intrinsics,
                           const Isometry3d& pose) {
    const Index count = std::ssize(view.corners);
    ViewEquations equations{VectorXd(2 * count), MatrixXd(2 * count, 6),
                            MatrixXd(2 * count, intrinsics.values().size())};
    Projection projection;
    const Lens lens = lens_of(intrinsics);
    for (Index k = 0; k < count; ++k) {
        const Vector3d turned = pose.linear() * view.corners[static_cast<std::size_t>(k)];
        differentiate_projection(lens, turned + pose.translation(), projection);
        equations.residuals.segment<2>(2 * k) =
            kpx_per_px * view.pixels[static_cast<std::size_t>(k)] - projection.place;
        equations.by_pose.block<2, 3>(2 * k, 0) = -projection.by_point * cross_matrix(turned);
        equations.by_pose.block<2, 3>(2 * k, 3) = projection.by_point;
        equations.by_values.middleRows<2>(2 * k) = projection.by_values;
    }
    return equations;
}

/// Poses and those intrinsic parameters that are not known, by least squares [Marquardt 1963] with
/// the poses eliminated view by view.
class Bundle {
  public:
    Bundle(const std::vector<BoardView>& views, Intrinsics intrinsics,
           std::vector<Isometry3d> poses, std::vector<Index> unknown)
        : views_(views),
          intrinsics_(std::move(intrinsics)),
          poses_(std::move(poses)),
          unknown_(std::move(unknown)) {}

    const Intrinsics& intrinsics() const { return intrinsics_; }
    const std::vector<Isometry3d>& poses() const { return poses_; }
    double squares() const { return squares_; }

    void polish() {
        squares_ = squares_of(intrinsics_, poses_);
        double damping = 1e-4;
        constexpr int most_steps = 50;
        for (int step = 0; step < most_steps && damping < 1e8; ++step) {
            auto [intrinsics, poses] = stepped(damping);
            const double squares = squares_of(intrinsics, poses);
            const bool is_better = squares < squares_;
            damping *= is_better ? 0.1 : 10;
            if (!is_better) continue;
            const bool is_done = squares > squares_ * (1 - 1e-12);
            intrinsics_ = std::move(intrinsics);
            poses_ = std::move(poses);
            squares_ = squares;
            if (is_done) break;
        }
    }

  private:
    double squares_of(const Intrinsics& intrinsics, const std::vector<Isometry3d>& poses) const {
        if (!(intrinsics.fx > 0 && intrinsics.fy > 0)) return INFINITY;
        const Lens lens = lens_of(intrinsics);
        double sum = 0;
        for (std::size_t i = 0; i < views_.size(); ++i) {
            for (std::size_t k = 0; k < views_[i].corners.size(); ++k) {
                const Vector3d point = poses[i] * views_[i].corners[k];
                if (point.z() <= 0) return INFINITY;
                sum += (kpx_per_px * views_[i].pixels[k] - place_of(lens, point)).squaredNorm();
            }
        }
        return sum;
    }

    std::pair<Intrinsics, std::vector<Isometry3d>> stepped(double damping) const {
        const Index count = std::ssize(unknown_);
        MatrixXd N = MatrixXd::Zero(count, count);
        VectorXd g = VectorXd::Zero(count);
        std::vector<MatrixXd> inverse_by_values;
        std::vector<VectorXd> own;
        for (std::size_t i = 0; i < views_.size(); ++i) {
            const ViewEquations e = equations_of(views_[i], intrinsics_, poses_[i]);
            const MatrixXd by_values = e.by_values(Eigen::all, unknown_);
            MatrixXd A = e.by_pose.transpose() * e.by_pose;
            A.diagonal() *= 1 + damping;
            const Eigen::LDLT<MatrixXd> factor(A);
            const MatrixXd B = e.by_pose.transpose() * by_values;
            inverse_by_values.push_back(count > 0 ? MatrixXd(factor.solve(B)) : B);
            own.push_back(factor.solve(e.by_pose.transpose() * e.residuals));
            MatrixXd C = by_values.transpose() * by_values;
            C.diagonal() *= 1 + damping;
            N += C - B.transpose() * inverse_by_values.back();
            g += by_values.transpose() * e.residuals - B.transpose() * own.back();
        }
        const VectorXd change = count > 0 ? VectorXd(N.ldlt().solve(g)) : g;
        VectorXd values = intrinsics_.values();
        values(unknown_) += change;
        std::vector<Isometry3d> poses;
        for (std::size_t i = 0; i < views_.size(); ++i) {
            poses.push_back(moved_by(poses_[i], own[i] - inverse_by_values[i] * change));
        }
        return {intrinsics_.with(values), std::move(poses)};
    }

    const std::vector<BoardView>& views_;
    Intrinsics intrinsics_;
    std::vector<Isometry3d> poses_;
    std::vector<Index> unknown_;
    double squares_ = 0;
};

/// Equations of one view in B11, B22, B13, B23, B33 of B = K^-T K^-1 without skew [Zhang 2000,
/// (8)].
void add_constraints(const Matrix3d& H, MatrixXd& equations) {
    const auto v = [&](Index i, Index j) {
        Eigen::Matrix<double, 1, 5> row;
        row << H(0, i) * H(0, j), H(1, i) * H(1, j), H(2, i) * H(0, j) + H(0, i) * H(2, j),
            H(2, i) * H(1, j) + H(1, i) * H(2, j), H(2, i) * H(2, j);
        return row;
    };
    const Index row = equations.rows();
    equations.conservativeResize(row + 2, 5);
    equations.row(row) = v(0, 1);
    equations.row(row + 1) = v(0, 0) - v(1, 1);
}

/// fx, fy, cx, cy of a pinhole in the units of the homographies; nothing: no such camera.
std::optional<Eigen::Vector4d> pinhole_of(const std::vector<Matrix3d>& homographies) {
    MatrixXd equations(0, 5);
    for (const Matrix3d& H : homographies) add_constraints(H / H.norm(), equations);
    const VectorXd b = null_vector(equations);
    const double cx = -b[2] / b[0], cy = -b[3] / b[1];
    const double size = b[4] + b[2] * cx + b[3] * cy;
    const double fx_square = size / b[0], fy_square = size / b[1];
    if (!(fx_square > 0 && fy_square > 0)) return std::nullopt;
    return Eigen::Vector4d(std::sqrt(fx_square), std::sqrt(fy_square), cx, cy);
}

/// The focal length, one for both axes, of homographies to places from the principal point.
std::optional<double> focal_length_of(const std::vector<Matrix3d>& homographies) {
    // h1^T B h2 = 0 and h1^T B h1 = h2^T B h2 with B = diag(w, w, 1), w = 1 / f^2.
    double above = 0, below = 0;
    for (const Matrix3d& stated : homographies) {
        const Matrix3d H = stated / stated.norm();
        const double a = H.col(0).head<2>().dot(H.col(1).head<2>()), b = H(2, 0) * H(2, 1);
        const double c = H.col(0).head<2>().squaredNorm() - H.col(1).head<2>().squaredNorm();
        const double d = H(2, 0) * H(2, 0) - H(2, 1) * H(2, 1);
        above -= a * b + c * d;
        below += a * a + c * c;
    }
    if (!(above > 0 && below > 0)) return std::nullopt;
    return std::sqrt(below / above);
}

/// fx, fy, cx and cy in px: by all of Zhang's equations or, where these have no solution, with the
/// principal point in the middle of the image.
std::optional<Eigen::Vector4d> start_of(const std::vector<BoardView>& views,
                                        const Isometry3d& plane,
                                        const std::optional<Vector2d>& image) {
    constexpr double unit = 1e3;  // px
    std::vector<Matrix3d> homographies;
    for (const BoardView& view : views) {
        std::vector<Vector2d> places;
        for (const Vector2d& pixel : view.pixels) places.emplace_back(pixel / unit);
        homographies.push_back(homography(in_plane(view.corners, plane), places));
    }
    const auto found = pinhole_of(homographies);
    const auto is_inside = [&](const Eigen::Vector4d& pinhole) {
        const Vector2d centre = unit * pinhole.tail<2>();
        return !image || ((centre.array() > 0).all() && (centre.array() < image->array()).all());
    };
    if (found && is_inside(*found)) return unit * *found;
    if (!image) return std::nullopt;
    const Vector2d middle = *image / 2 / unit;
    for (Matrix3d& H : homographies) H.topRows<2>() -= middle * H.row(2);
    const auto focal = focal_length_of(homographies);
    if (!focal) return std::nullopt;
    return unit * Eigen::Vector4d(*focal, *focal, middle.x(), middle.y());
}

}  // namespace

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

std::optional<Isometry3d> find_board(const BoardView& view, const Intrinsics& intrinsics) {
    if (view.corners.size() < 4 || are_in_line(view.corners)) return std::nullopt;
    std::vector<Vector2d> directions;
    for (const Vector2d& pixel : view.pixels) {
        const auto direction = undistort(intrinsics, pixel);
        if (!direction) return std::nullopt;
        directions.push_back(*direction);
    }
    std::vector<Isometry3d> starts;
    if (const auto plane = plane_of(view.corners)) {
        const Isometry3d pose = pose_of(homography(in_plane(view.corners, *plane), directions));
        for (const Isometry3d& start : {pose, leant_over(pose)}) {
            starts.push_back(start * plane->inverse());
        }
    } else {
        const Body body = body_of(view.corners);
        for (const auto& start :
             {distant_pose_of(body, directions), projected_pose_of(body, directions)}) {
            if (start) starts.push_back(*start);
        }
    }
    std::optional<Isometry3d> best;
    double least = INFINITY;
    const std::vector<BoardView> one{view};
    for (const Isometry3d& start : starts) {
        Bundle bundle(one, intrinsics, {start}, {});
        bundle.polish();
        if (!(bundle.squares() < least)) continue;
        least = bundle.squares();
        best = bundle.poses().front();
    }
    return best;
}

std::optional<Intrinsics> find_intrinsics(const std::vector<BoardView>& views,
                                          const Intrinsics& stated,
                                          const std::vector<bool>& is_known,
                                          const std::optional<Vector2d>& image) {
    std::vector<Index> unknown;
    for (std::size_t k = 0; k < is_known.size(); ++k) {
        if (!is_known[k]) unknown.push_back(static_cast<Index>(k));
    }
    Intrinsics start = stated;
    if (!(stated.fx > 0 && stated.fy > 0)) {
        if (views.empty()) return std::nullopt;
        const auto plane = plane_of(views.front().corners);
        const auto pinhole = plane ? start_of(views, *plane, image) : std::nullopt;
        if (!pinhole) return std::nullopt;
        VectorXd values = start.values();
        for (Index k = 0; k < 4; ++k) {
            if (!is_known[static_cast<std::size_t>(k)]) values[k] = kpx_per_px * (*pinhole)[k];
        }
        start = start.with(values);
    }
    std::vector<BoardView> found;
    std::vector<Isometry3d> poses;
    for (const BoardView& view : views) {
        const auto pose = find_board(view, start);
        if (!pose) continue;
        found.push_back(view);
        poses.push_back(*pose);
    }
    if (found.empty()) return std::nullopt;
    Bundle bundle(found, start, poses, unknown);
    bundle.polish();
    if (!std::isfinite(bundle.squares())) return start;
    return bundle.intrinsics();
}

}  // namespace posewise::detail
