#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "board_pose.hpp"
#include "board_starts.hpp"
#include "camera_view.hpp"
#include "core/statistics.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/measurements.hpp"
#include "rigid_points.hpp"

namespace posewise {
namespace {

/// What one camera sees of the board.
detail::BoardView view_of(const CameraSensor& sensor, Index camera, const ConstNumbers& observation,
                          const SeenTargets& is_seen) {
    detail::BoardView view;
    const Index corners = sensor.corner_count();
    for (Index k = 0; k < corners; ++k) {
        const Index target = camera * corners + k;
        if (!is_seen[target]) continue;
        view.corners.push_back(sensor.setup().corners[static_cast<std::size_t>(k)]);
        view.pixels.emplace_back(observation.segment<2>(2 * target) / detail::kpx_per_px);
    }
    return view;
}

/// The pose that is turned least from all the others, at the median of their places.
Isometry3d middle_of(const std::vector<Isometry3d>& poses) {
    Isometry3d middle;
    double least = std::numeric_limits<double>::infinity();
    for (const Isometry3d& pose : poses) {
        double turned = 0;
        for (const Isometry3d& other : poses) {
            turned += Eigen::AngleAxisd(pose.linear().transpose() * other.linear()).angle();
        }
        if (!(turned < least)) continue;
        least = turned;
        middle = pose;
    }
    for (Index axis = 0; axis < 3; ++axis) {
        VectorXd places(std::ssize(poses));
        for (std::size_t i = 0; i < poses.size(); ++i) {
            places[static_cast<Index>(i)] = poses[i].translation()[axis];
        }
        middle.translation()[axis] = detail::quantile(places, 0.5, detail::QuantileRule::Linear);
    }
    return middle;
}

/// Where `shown` views show enough of the board and only `told` of them a pose of it.
std::string describe_strange_views(Index told, Index shown) {
    return fmt::format(
        "the corners of {} of {} fit no view of such a board from anywhere; are columns and rows "
        "of the board, the corners' numbers and the columns u and v right?",
        shown - told, detail::count_of(shown, "view"));
}

/// What poses of the board may leave of a camera's views before they are taken for views of
/// something else, px. No limit where most leave too much anyway, or where its corners are not
/// exactly where they are stated: few of them often find no good pose, and still tell where to
/// begin. Throws InputError if hardly a view finds any.
double most_left_over(const CameraSensor& sensor, Index camera, const Intrinsics& intrinsics,
                      const Measurements& means) {
    if (!sensor.has_exact_corners()) return INFINITY;
    constexpr Index enough = 40;
    std::vector<double> left_over;
    Index shown = 0;
    for (const Index i : evenly_spaced(means.configuration_count(), enough)) {
        const auto view =
            view_of(sensor, camera, means.observations.row(i).transpose(), means.is_seen.row(i));
        if (!detail::shows_enough(view)) continue;
        ++shown;
        const auto fit = detail::find_board(view, intrinsics);
        if (fit && fit->is_good) left_over.push_back(fit->rms);
    }
    const Index good = std::ssize(left_over);
    if (10 * good < shown) throw InputError(describe_strange_views(good, shown));
    return 2 * good < shown ? INFINITY : detail::most_left_over(left_over);
}

/// Whether a view that leaves at most so much is to begin with.
bool is_taken(const std::optional<detail::BoardFit>& fit, double most_left) {
    return fit && (std::isinf(most_left) || (fit->is_good && fit->rms <= most_left));
}

/// The board in each camera's frame, in each view of a part of them that is enough; nothing where
/// it does not show it.
std::vector<std::vector<std::optional<Isometry3d>>> boards_of(
    const CameraSensor& sensor, const std::vector<PlacedCamera>& cameras,
    const Measurements& means) {
    constexpr Index enough = 200;
    std::vector<std::vector<std::optional<Isometry3d>>> boards;
    Index found = 0;
    for (Index i = 0; i < means.configuration_count() && found < enough; ++i) {
        std::vector<std::optional<Isometry3d>> seen;
        Index count = 0;
        for (Index c = 0; c < sensor.camera_count(); ++c) {
            const auto view =
                view_of(sensor, c, means.observations.row(i).transpose(), means.is_seen.row(i));
            const auto fit =
                detail::find_board(view, cameras[static_cast<std::size_t>(c)].intrinsics);
            seen.push_back(fit ? std::optional(fit->board) : std::nullopt);
            count += seen.back() ? 1 : 0;
        }
        if (count < 2) continue;
        boards.push_back(std::move(seen));
        ++found;
    }
    return boards;
}

/// Where further cameras are in the first one's frame, by views of the board that they share.
void place_cameras(const CameraSensor& sensor, const Measurements& means,
                   std::vector<PlacedCamera>& cameras) {
    if (cameras.size() == 1) return;
    const auto boards = boards_of(sensor, cameras, means);
    std::vector<bool> is_placed(cameras.size(), false);
    is_placed[0] = true;
    for (bool has_changed = true; has_changed;) {
        has_changed = false;
        for (std::size_t c = 1; c < cameras.size(); ++c) {
            if (is_placed[c]) continue;
            std::vector<Isometry3d> poses;
            for (const auto& seen : boards) {
                for (std::size_t other = 0; other < cameras.size() && seen[c]; ++other) {
                    if (!is_placed[other] || !seen[other]) continue;
                    poses.push_back(cameras[other].in_first * *seen[other] * seen[c]->inverse());
                }
            }
            if (poses.empty()) continue;
            cameras[c].in_first = middle_of(poses);
            is_placed[c] = has_changed = true;
        }
    }
    const auto lost = std::ranges::find(is_placed, false);
    if (lost == is_placed.end()) return;
    throw InputError(fmt::format(
        "no view shows enough of the board (4 corners or more that are not in one line) both to "
        "camera {} and to the first one or one that is linked with it so; some must",
        lost - is_placed.begin() + 1));
}

}  // namespace

std::optional<double> CameraSensor::left_by_any_pose(Index camera, const VectorXd& unknowns,
                                                     const ConstNumbers& observation,
                                                     const SeenTargets& is_seen) const {
    const detail::BoardView view = view_of(*this, camera, observation, is_seen);
    if (!detail::shows_enough(view)) return std::nullopt;
    const auto fit = detail::find_board(view, placed(camera, unknowns).intrinsics);
    return fit && fit->is_good ? fit->rms : std::numeric_limits<double>::infinity();
}

ObservedPoints CameraSensor::points_with(const std::vector<PlacedCamera>& cameras,
                                         const std::vector<double>& most_left) const {
    const auto positions = [this, cameras, most_left](const VectorXd& observation,
                                                      const SeenTargets& is_seen) {
        // By the camera that sees most of it.
        std::vector<std::pair<std::size_t, detail::BoardView>> views;
        for (std::size_t c = 0; c < cameras.size(); ++c) {
            views.emplace_back(c, view_of(*this, static_cast<Index>(c), observation, is_seen));
        }
        std::ranges::stable_sort(views, std::ranges::greater{},
                                 [](const auto& one) { return one.second.corners.size(); });
        for (const auto& [c, view] : views) {
            const auto fit = detail::find_board(view, cameras[c].intrinsics);
            if (!is_taken(fit, most_left[c])) continue;
            const Isometry3d in_first = cameras[c].in_first * fit->board;
            const Isometry3d place = setup_.is_on_flange ? in_first.inverse() : in_first;
            return VectorXd(detail::points_of(place).reshaped());
        }
        return VectorXd();
    };
    const auto of_points = [this, cameras](const VectorXd& coordinates) {
        return unknowns(has_unknown_place() ? detail::frame_of(coordinates) : *setup_.known_place,
                        cameras[0].intrinsics, {cameras.begin() + 1, cameras.end()});
    };
    const auto in_flange = [this](const VectorXd& unknowns) {
        return VectorXd(detail::points_of(place(unknowns)).reshaped());
    };
    return {detail::rigid_targets(setup_.known_place), positions, of_points, in_flange};
}

std::optional<ObservedPoints> CameraSensor::observed_points() const {
    return points_with({{Isometry3d::Identity(), setup_.intrinsics}}, {INFINITY});
}

std::optional<ObservedPoints> CameraSensor::observed_points(const Measurements& means) const {
    std::vector<PlacedCamera> cameras;
    for (Index c = 0; c < camera_count(); ++c) {
        const SingleCamera& one = camera(c);
        cameras.push_back({Isometry3d::Identity(), one.intrinsics});
        if (unknown_intrinsics(c).empty()) continue;
        std::vector<detail::BoardView> views;
        for (Index i = 0; i < means.configuration_count(); ++i) {
            auto view =
                view_of(*this, c, means.observations.row(i).transpose(), means.is_seen.row(i));
            if (detail::shows_enough(view)) views.push_back(std::move(view));
        }
        const Index shown = std::ssize(views);
        if (has_exact_corners()) views = detail::keep_plane_views(views);
        const auto found = detail::find_intrinsics(views, one.intrinsics, one.is_known, one.image);
        const bool is_stated = one.intrinsics.fx > 0 && one.intrinsics.fy > 0;
        if (!found && 2 * std::ssize(views) < shown) {
            throw InputError(describe_strange_views(std::ssize(views), shown));
        }
        if (!found && !is_stated) {
            throw InputError(fmt::format(
                "the intrinsic parameters of {} do not follow from these views; more views of a "
                "plane board that leans to different sides are needed, or intrinsics that are "
                "stated, if only roughly (key {})",
                c == 0 ? "the camera" : fmt::format("camera {}", c + 1),
                c == 0 ? "sensor.intrinsics" : "sensor.other_cameras"));
        }
        if (found) cameras.back().intrinsics = *found;
    }
    std::vector<double> most_left;
    for (Index c = 0; c < camera_count(); ++c) {
        most_left.push_back(
            most_left_over(*this, c, cameras[static_cast<std::size_t>(c)].intrinsics, means));
    }
    place_cameras(*this, means, cameras);
    return points_with(cameras, most_left);
}

}  // namespace posewise
