#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "core/statistics.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

/// What one camera sees in one sample.
struct View {
    Index configuration = 0, sample = 0, camera = 0, corners = 0;
    double by_any_pose = 0;    ///< RMS of u and v about the board's best pose, px
    double by_the_joints = 0;  ///< about where the joints say that it is
};

/// Corners numbered in another order: which corner each number means.
struct CornerOrder {
    std::string words;
    std::vector<Index> meant;
};

/// Those that take a plane board's corners to each other's places.
std::vector<CornerOrder> other_orders(const std::vector<Vector3d>& corners) {
    const auto count = std::ssize(corners);
    const Eigen::Map<const Eigen::Matrix3Xd> places(corners.front().data(), 3, count);
    const Vector3d ends = places.rowwise().minCoeff() + places.rowwise().maxCoeff();
    const double near = 1e-3 * (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).norm();
    std::vector<CornerOrder> orders;
    const auto add = [&](std::string words, bool turns_x, bool turns_y) {
        CornerOrder order{std::move(words), {}};
        for (const Vector3d& corner : corners) {
            Vector3d place = corner;
            if (turns_x) place.x() = ends.x() - place.x();
            if (turns_y) place.y() = ends.y() - place.y();
            Index nearest = 0;
            const double off = (places.colwise() - place).colwise().norm().minCoeff(&nearest);
            if (off > near) return;
            order.meant.push_back(nearest);
        }
        orders.push_back(std::move(order));
    };
    add("from the board's other end", true, true);
    add("in mirrored order", true, false);
    add("in mirrored order", false, true);
    return orders;
}

/// How many times what the others are missed by: few corners follow the robot's errors, and the
/// search for a pose may fail.
double far(const View& view) { return view.corners < 6 ? 32 : 8; }

/// Whether no pose of the board that was tried explains it, if the others leave so much (px).
bool is_no_board(const View& view, double others) {
    const double most = std::max(1.0, far(view) * others);
    return view.by_any_pose > most && view.by_the_joints > most;
}

VectorXd values_of(const std::vector<View>& views, double View::*value) {
    std::vector<double> finite;
    for (const View& view : views) {
        if (std::isfinite(view.*value)) finite.push_back(view.*value);
    }
    return Eigen::Map<const VectorXd>(finite.data(), std::ssize(finite));
}

double median_of(const std::vector<View>& views, double View::*value) {
    const VectorXd values = values_of(views, value);
    return values.size() > 0 ? detail::quantile(values, 0.5, detail::QuantileRule::Upper) : 0;
}

double rms_about(const VectorXd& predicted, const Measurements& measured, const View& view,
                 Index corners, const std::vector<Index>& order = {}) {
    double squares = 0;
    Index count = 0;
    for (Index k = 0; k < corners; ++k) {
        if (!measured.is_seen(view.sample, view.camera * corners + k)) continue;
        const Index meant = order.empty() ? k : order[static_cast<std::size_t>(k)];
        const auto seen = measured.observation(view.sample, view.camera * corners + k);
        squares += (seen.transpose() - predicted.segment<2>(2 * (view.camera * corners + meant)))
                       .squaredNorm();
        count += 2;
    }
    return 1e3 * std::sqrt(squares / static_cast<double>(std::max<Index>(count, 1)));
}

/// The corner that is farthest off, and the one whose place it has.
std::vector<CornerOrder> exchanged_pair(const CameraSensor& camera, const VectorXd& predicted,
                                        const Measurements& measured, const View& view) {
    const Index corners = camera.corner_count(), first = view.camera * corners;
    const auto distance = [&](Index seen, Index meant) {
        return (measured.observation(view.sample, first + seen).transpose() -
                predicted.segment<2>(2 * (first + meant)))
            .norm();
    };
    Index worst = -1, nearest = 0;
    for (Index k = 0; k < corners; ++k) {
        const bool is_seen = measured.is_seen(view.sample, first + k);
        if (is_seen && (worst < 0 || distance(k, k) > distance(worst, worst))) worst = k;
    }
    for (Index k = 0; k < corners; ++k) {
        if (distance(worst, k) < distance(worst, nearest)) nearest = k;
    }
    if (nearest == worst) return {};
    CornerOrder order{fmt::format("with {} and {} exchanged",
                                  std::min(worst, nearest) + camera.setup().first_corner,
                                  std::max(worst, nearest) + camera.setup().first_corner),
                      std::vector<Index>(static_cast<std::size_t>(corners))};
    std::iota(order.meant.begin(), order.meant.end(), Index{0});
    std::swap(order.meant[static_cast<std::size_t>(worst)],
              order.meant[static_cast<std::size_t>(nearest)]);
    return {std::move(order)};
}

VectorXd predict(const Campaign& campaign, const Parameters& at, const Measurements& measured,
                 const View& view) {
    const VectorXd q = measured.configurations.row(view.configuration).transpose();
    return campaign.sensor->predict(world_from_flange(campaign, at, q), at.sensor);
}

/// All that show enough of the board.
std::vector<View> find_views(const CameraSensor& camera, const Measurements& measured,
                             const Parameters& registered) {
    std::vector<View> views;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const Index first = measured.first_sample[static_cast<std::size_t>(i)];
        for (Index sample = first; sample < first + measured.sample_count(i); ++sample) {
            for (Index c = 0; c < camera.camera_count(); ++c) {
                const auto left = camera.left_by_any_pose(
                    c, registered.sensor, measured.observations.row(sample).transpose(),
                    measured.is_seen.row(sample));
                const Index count = camera.corner_count();
                const Index seen = measured.is_seen.row(sample).segment(c * count, count).count();
                if (left) views.push_back({i, sample, c, seen, *left, 0});
            }
        }
    }
    return views;
}

void miss_by_joints(const Campaign& campaign, const CameraSensor& camera,
                    const Measurements& measured, const Parameters& at, std::vector<View>& views) {
    for (View& view : views) {
        view.by_the_joints =
            rms_about(predict(campaign, at, measured, view), measured, view, camera.corner_count());
    }
}

ViewDoubt doubt_of(const Campaign& campaign, const CameraSensor& camera,
                   const Measurements& measured, const Parameters& at, const View& view,
                   const std::vector<View>& views) {
    const Index samples = measured.sample_count(view.configuration);
    const Index first = measured.first_sample[static_cast<std::size_t>(view.configuration)];
    ViewDoubt doubt;
    doubt.sample = samples == 1 ? measured.ids[static_cast<std::size_t>(view.configuration)]
                                : measured.sample_name(view.configuration, view.sample - first);
    doubt.camera = view.camera;
    const double any = median_of(views, &View::by_any_pose);
    doubt.is_no_board = is_no_board(view, any);
    const double others = median_of(views, &View::by_the_joints);
    doubt.distance = 1e-3 * (doubt.is_no_board ? view.by_any_pose : view.by_the_joints);
    doubt.others = 1e-3 * (doubt.is_no_board ? any : others);
    const VectorXd predicted = predict(campaign, at, measured, view);
    const std::vector<CornerOrder> orders = doubt.is_no_board
                                                ? exchanged_pair(camera, predicted, measured, view)
                                                : other_orders(camera.setup().corners);
    for (const CornerOrder& order : orders) {
        const double renumbered =
            rms_about(predicted, measured, view, camera.corner_count(), order.meant);
        if (renumbered < far(view) / 2 * others) doubt.order = order.words;
    }
    return doubt;
}

/// The robot's own errors, which a registration leaves, may be large in some views that are right.
Parameters fit_robustly(const Campaign& campaign, const Measurements& measured,
                        const std::vector<Index>& rest, const Parameters& registered) {
    Campaign open = campaign;
    open.spread.is_prior = true;
    open.prior.reset();
    const Estimate by_rest = identify(open, take(measured, rest), registered);
    if (!by_rest.undetermined.empty()) return registered;
    LevenbergMarquardtOptions robust;
    robust.loss.kind = LossKind::Cauchy;
    const Estimate found = identify(open, measured, by_rest.parameters, robust);
    return found.undetermined.empty() ? found.parameters : by_rest.parameters;
}

}  // namespace

std::vector<ViewDoubt> find_view_doubts(const Campaign& campaign, const Measurements& measured,
                                        const Parameters& registered) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr || !camera->has_exact_corners()) return {};
    std::vector<View> views = find_views(*camera, measured, registered);
    constexpr std::size_t enough = 6;
    if (views.size() < enough) return {};
    miss_by_joints(campaign, *camera, measured, registered, views);
    const double by_any_pose = median_of(views, &View::by_any_pose);
    const auto find_odd = [&] {
        const double by_the_joints = median_of(views, &View::by_the_joints);
        std::vector<View> odd;
        std::ranges::copy_if(views, std::back_inserter(odd), [&](const View& view) {
            return is_no_board(view, by_any_pose) ||
                   view.by_the_joints > std::max(1.0, far(view) * by_the_joints);
        });
        return odd;
    };
    std::vector<View> odd = find_odd();
    if (odd.empty() || 2 * odd.size() > views.size()) return {};
    std::vector<Index> rest;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        if (std::ranges::count(odd, i, &View::configuration) == 0) rest.push_back(i);
    }
    const Parameters at = fit_robustly(campaign, measured, rest, registered);
    miss_by_joints(campaign, *camera, measured, at, views);
    odd = find_odd();
    std::vector<ViewDoubt> doubts;
    for (const View& view : odd) {
        doubts.push_back(doubt_of(campaign, *camera, measured, at, view, views));
    }
    return doubts;
}

}  // namespace posewise
