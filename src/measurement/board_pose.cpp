#include "board_pose.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "board_starts.hpp"
#include "camera_model.hpp"
#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

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
          unknown_(std::move(unknown)),
          squares_(squares_of(intrinsics_, poses_)) {}

    const Intrinsics& intrinsics() const { return intrinsics_; }
    const std::vector<Isometry3d>& poses() const { return poses_; }
    double squares() const { return squares_; }
    /// Of what is left in one view by the degrees of freedom that its pose leaves, px.
    double rms(std::size_t view) const {
        const auto freedom = 2 * std::ssize(views_[view].corners) - 6;
        return std::sqrt(squares_in(lens_of(intrinsics_), views_[view], poses_[view]) /
                         static_cast<double>(std::max<Index>(1, freedom))) /
               kpx_per_px;
    }

    void polish() {
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
        for (std::size_t i = 0; i < views_.size(); ++i)
            sum += squares_in(lens, views_[i], poses[i]);
        return sum;
    }

    static double squares_in(const Lens& lens, const BoardView& view, const Isometry3d& pose) {
        double sum = 0;
        for (std::size_t k = 0; k < view.corners.size(); ++k) {
            const Vector3d point = pose * view.corners[k];
            if (point.z() <= 0) return INFINITY;
            sum += (kpx_per_px * view.pixels[k] - place_of(lens, point)).squaredNorm();
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
    double squares_;
};

/// RMS distances of places in an image from their middle along the direction of most, and across.
Vector2d spread_of(const std::vector<Vector2d>& pixels) {
    RowMatrixXd places(std::ssize(pixels), 2);
    for (Index k = 0; k < places.rows(); ++k) places.row(k) = pixels[static_cast<std::size_t>(k)];
    places.rowwise() -= places.colwise().mean().eval();
    return singular_directions(places).values / std::sqrt(static_cast<double>(places.rows()));
}

/// Whether a view may be of a board: `rms` is what the best pose, or homography, leaves of u and v.
bool is_of_a_board(const BoardView& view, double rms) {
    constexpr double thin = 0.01, far = 0.25;
    const Vector2d spread = spread_of(view.pixels);
    return spread[1] > thin * spread[0] && rms <= far * spread.norm();
}

/// What the best homography to the image leaves of u and v by the degrees of freedom left, px.
double left_by_homography(const BoardView& view, const Isometry3d& plane) {
    const std::vector<Vector2d> places = in_plane(view.corners, plane);
    const Matrix3d H = homography(places, view.pixels);
    double squares = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        squares += ((H * places[k].homogeneous()).hnormalized() - view.pixels[k]).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(2 * places.size()));
}

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

bool shows_enough(const BoardView& view) {
    return view.corners.size() >= 4 && !are_in_line(view.corners);
}

double most_left_over(const std::vector<double>& left_over) {
    constexpr double far = 10;
    constexpr double least = 1;  // px
    std::vector<double> finite;
    std::ranges::copy_if(left_over, std::back_inserter(finite),
                         [](double left) { return std::isfinite(left); });
    if (finite.empty()) return least;
    const Eigen::Map<const VectorXd> all(finite.data(), std::ssize(finite));
    return std::max(least, far * quantile(all, 0.5, QuantileRule::Upper));
}

std::vector<BoardView> keep_plane_views(const std::vector<BoardView>& views) {
    std::vector<Vector3d> all;
    for (const BoardView& view : views) {
        all.insert(all.end(), view.corners.begin(), view.corners.end());
    }
    const auto plane = all.empty() ? std::nullopt : plane_of(all);
    if (!plane) return views;
    std::vector<double> left_over;
    for (const BoardView& view : views) {
        const double left =
            spread_of(view.pixels)[1] > 0 ? left_by_homography(view, *plane) : INFINITY;
        left_over.push_back(is_of_a_board(view, left) ? left : INFINITY);
    }
    const double most = most_left_over(left_over);
    std::vector<BoardView> kept;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (left_over[i] <= most) kept.push_back(views[i]);
    }
    return kept;
}

std::optional<BoardFit> find_board(const BoardView& view, const Intrinsics& intrinsics) {
    if (!shows_enough(view)) return std::nullopt;
    std::vector<Vector2d> directions;
    for (const Vector2d& pixel : view.pixels) {
        const auto direction = undistort(intrinsics, pixel);
        if (!direction) return std::nullopt;
        directions.push_back(*direction);
    }
    std::optional<BoardFit> best;
    double least = INFINITY;
    const std::vector<BoardView> one{view};
    for (const Isometry3d& start : board_starts(view.corners, directions)) {
        Bundle bundle(one, intrinsics, {start}, {});
        bundle.polish();
        if (!(bundle.squares() < least)) continue;
        least = bundle.squares();
        best = {bundle.poses().front(), bundle.rms(0), false};
    }
    if (best) best->is_good = is_of_a_board(view, best->rms);
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
    const bool is_stated = stated.fx > 0 && stated.fy > 0;
    if (!is_stated) {
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
        poses.push_back(pose->board);
    }
    if (found.empty()) return std::nullopt;
    Bundle bundle(found, start, poses, unknown);
    const double at_start = bundle.squares();
    bundle.polish();
    // Few views of few corners are fitted a little better by intrinsics that are far from right.
    constexpr double much_better = 9;
    if (!std::isfinite(bundle.squares()) ||
        (is_stated && at_start <= much_better * bundle.squares())) {
        return start;
    }
    return bundle.intrinsics();
}

}  // namespace posewise::detail
