#include "posewise/measurement/camera_sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "board_pose.hpp"
#include "camera_view.hpp"
#include "core/format.hpp"
#include "noise_words.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "rigid_points.hpp"

namespace posewise {
namespace {

std::vector<std::optional<Vector3d>> point_of_place(const std::optional<Isometry3d>& place) {
    if (!place) return {std::nullopt};
    return {Vector3d(place->translation())};
}

CameraSetup checked(CameraSetup setup) {
    const std::size_t values = 4 + setup.intrinsics.coefficients.size();
    if (setup.is_known.empty()) setup.is_known.assign(values, true);
    if (setup.is_known.size() != values) {
        throw InputError(fmt::format("{} intrinsic parameters are said to be known or not, not {}",
                                     setup.is_known.size(), values));
    }
    Intrinsics assumed = setup.intrinsics;
    if (assumed.fx == 0 && !setup.is_known[0]) assumed.fx = 1;
    if (assumed.fy == 0 && !setup.is_known[1]) assumed.fy = 1;
    check_intrinsics(assumed);
    if (setup.corners.size() < 4) {
        throw InputError(
            fmt::format("the board has {} corners, must have at least 4", setup.corners.size()));
    }
    for (const Vector3d& corner : setup.corners) {
        if (!corner.allFinite()) throw InputError("a corner is not at a finite place");
    }
    if (detail::are_in_line(setup.corners)) {
        throw InputError("the board's corners are all in one line, must span a plane");
    }
    if (setup.known_place && !setup.known_place->matrix().allFinite()) {
        throw InputError("the known pose of board or camera has a value that is no finite number");
    }
    detail::check_sigma("sigma", detail::kpx_per_px * setup.sigma, "kpx");
    return setup;
}

}  // namespace

CameraSensor::CameraSensor(CameraSetup setup)
    : setup_(checked(std::move(setup))), origin_(point_of_place(setup_.known_place)) {
    for (std::size_t k = 0; k < setup_.is_known.size(); ++k) {
        if (!setup_.is_known[k]) unknown_intrinsics_.push_back(static_cast<Index>(k));
    }
    if (const auto plane = detail::plane_of(setup_.corners)) {
        const Vector3d normal = plane->linear().col(2);
        const bool is_plus = normal.z() > 0 || (normal.z() == 0 && normal.sum() > 0);
        normal_ = is_plus == setup_.view.is_front_plus_z ? normal : Vector3d(-normal);
    }
    if (setup_.intrinsics.fx > 0)
        widest_ = detail::widest_tangent(detail::lens_of(setup_.intrinsics));
}

Isometry3d CameraSensor::place(const VectorXd& unknowns) const {
    if (setup_.known_place) return *setup_.known_place;
    Isometry3d place = Isometry3d::Identity();
    place.translation() = unknowns.head<3>();
    place.linear() = rotation_from_vector(unknowns.segment<3>(3));
    return place;
}

Intrinsics CameraSensor::intrinsics(const VectorXd& unknowns) const {
    if (unknown_intrinsics_.empty()) return setup_.intrinsics;
    VectorXd values = setup_.intrinsics.values();
    values(unknown_intrinsics_) = unknowns.segment(place_count(), intrinsics_count());
    return setup_.intrinsics.with(values);
}

Isometry3d CameraSensor::camera_from_board(const Isometry3d& world_from_flange,
                                           const VectorXd& unknowns) const {
    const Isometry3d world_from_place = world_from_flange * place(unknowns);
    return setup_.is_on_flange ? world_from_place.inverse() : world_from_place;
}

bool CameraSensor::is_seen_from_back(const Isometry3d& world_from_flange,
                                     const VectorXd& unknowns) const {
    const Isometry3d board = camera_from_board(world_from_flange, unknowns);
    const Vector3d corner = board_factor(unknowns) * setup_.corners.front();
    return normal_ && (board.linear() * *normal_).dot(board * corner) > 0;
}

VectorXd CameraSensor::unknowns(const Isometry3d& place, const Intrinsics& intrinsics) const {
    VectorXd unknowns =
        VectorXd::Zero(place_count() + intrinsics_count() + (setup_.is_scale_unknown ? 1 : 0));
    if (has_unknown_place()) unknowns.head<6>() = tool_unknowns(place);
    unknowns.segment(place_count(), intrinsics_count()) = intrinsics.values()(unknown_intrinsics_);
    return unknowns;
}

std::vector<std::string> CameraSensor::observation_names() const {
    std::vector<std::string> names;
    for (Index k = 1; k <= target_count(); ++k) {
        names.push_back(fmt::format("p{}_u", k));
        names.push_back(fmt::format("p{}_v", k));
    }
    return names;
}

std::vector<std::string> CameraSensor::unknown_names() const {
    std::vector<std::string> names;
    const std::string on_flange = setup_.is_on_flange ? "camera." : "board.";
    for (const char* const name : {"x", "y", "z", "rx", "ry", "rz"}) {
        if (has_unknown_place()) names.push_back(on_flange + name);
    }
    const auto of_values = setup_.intrinsics.names();
    for (const Index k : unknown_intrinsics_) {
        names.push_back("camera." + of_values[static_cast<std::size_t>(k)]);
    }
    if (setup_.is_scale_unknown) names.emplace_back("board.scale");
    return names;
}

std::vector<bool> CameraSensor::unknown_is_angle() const {
    std::vector<bool> is_angle(static_cast<std::size_t>(place_count()), false);
    for (std::size_t k = 3; k < is_angle.size(); ++k) is_angle[k] = true;
    is_angle.resize(unknown_names().size(), true);
    return is_angle;
}

std::vector<const AmountUnits*> CameraSensor::unknown_units() const {
    auto units = Sensor::unknown_units();
    for (std::size_t k = 0; k < unknown_intrinsics_.size(); ++k) {
        units[static_cast<std::size_t>(place_count()) + k] =
            unknown_intrinsics_[k] < 4 ? &pixel_units : &plain_units;
    }
    if (setup_.is_scale_unknown) units.back() = &plain_units;
    return units;
}

void CameraSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                           Eigen::Ref<VectorXd> observation) const {
    const auto view = detail::board_from_camera(*this, world_from_flange, unknowns);
    for (Index k = 0; k < target_count(); ++k) {
        observation.segment<2>(2 * k) = detail::place_of(
            view.lens, view.camera * (view.factor * setup_.corners[static_cast<std::size_t>(k)]));
    }
}

void CameraSensor::covariance(const Isometry3d&, const VectorXd&,
                              Eigen::Ref<MatrixXd> covariance) const {
    const double sigma = detail::kpx_per_px * setup_.sigma;
    covariance.setZero();
    covariance.diagonal().setConstant(sigma * sigma);
}

void CameraSensor::view_clearances(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                                   Eigen::Ref<VectorXd> clearances) const {
    const auto view = detail::board_from_camera(*this, world_from_flange, unknowns);
    const detail::Lens& lens = view.lens;
    const double widest = unknown_intrinsics_.empty() ? widest_ : detail::widest_tangent(lens);
    for (Index k = 0; k < target_count(); ++k) {
        const Vector3d p =
            view.camera * (view.factor * setup_.corners[static_cast<std::size_t>(k)]);
        const double to_side = std::atan2(p.head<2>().norm(), p.z());
        double least = std::atan(widest) - to_side;
        if (normal_) {
            const Vector3d normal = view.camera.linear() * *normal_;
            const double tilt = std::atan2(normal.cross(-p).norm(), normal.dot(-p));
            least = std::min(least, setup_.view.most_tilt - tilt);
        }
        if (setup_.view.image && least > 0) {
            const Vector2d place = detail::place_of(lens, p);
            const Vector2d focal(lens.values[0], lens.values[1]);
            const Vector2d image = detail::kpx_per_px * *setup_.view.image;
            least = std::min({least, place.cwiseQuotient(focal).minCoeff(),
                              (image - place).cwiseQuotient(focal).minCoeff()});
        }
        clearances[k] = least;
    }
}

SensorWords CameraSensor::words() const {
    const std::string what = setup_.is_on_flange ? "camera" : "board";
    std::string intrinsics = "intrinsics known";
    if (!unknown_intrinsics_.empty()) {
        intrinsics = fmt::format("{} of {} intrinsic parameters to be identified",
                                 unknown_intrinsics_.size(), setup_.is_known.size());
    }
    return {"corners",
            what,
            what + " in the flange frame" +
                (unknown_intrinsics_.empty() ? "" : ", intrinsic parameters of the camera"),
            "sensor.place",
            {"base.known", "sensor.place.known"},
            fmt::format("{} corners of a board seen by a camera {} ({} {}), {}, sigma {} px",
                        target_count(), setup_.is_on_flange ? "on the flange" : "that is fixed",
                        what, setup_.known_place ? "known" : "to be identified", intrinsics,
                        detail::format_short(setup_.sigma))};
}

Index first_corner(const Sensor& sensor) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(&sensor);
    return camera != nullptr ? camera->setup().first_corner : 1;
}

// ---- Registration ----

ObservedPoints CameraSensor::points_with(const Intrinsics& camera) const {
    const auto positions = [this, camera](const VectorXd& observation, const SeenTargets& is_seen) {
        detail::BoardView view;
        for (const Index k : targets_seen(is_seen)) {
            view.corners.push_back(setup_.corners[static_cast<std::size_t>(k)]);
            view.pixels.emplace_back(observation.segment<2>(2 * k) / detail::kpx_per_px);
        }
        const auto board = detail::find_board(view, camera);
        if (!board) return VectorXd();
        const Isometry3d place = setup_.is_on_flange ? board->inverse() : *board;
        return VectorXd(detail::points_of(place).reshaped());
    };
    const auto of_points = [this, camera](const VectorXd& coordinates) {
        return unknowns(has_unknown_place() ? detail::frame_of(coordinates) : *setup_.known_place,
                        camera);
    };
    const auto in_flange = [this](const VectorXd& unknowns) {
        return VectorXd(detail::points_of(place(unknowns)).reshaped());
    };
    return {detail::rigid_targets(setup_.known_place), positions, of_points, in_flange};
}

std::optional<ObservedPoints> CameraSensor::observed_points() const {
    return points_with(setup_.intrinsics);
}

std::optional<ObservedPoints> CameraSensor::observed_points(const Measurements& means) const {
    if (unknown_intrinsics_.empty()) return observed_points();
    std::vector<detail::BoardView> views;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        detail::BoardView view;
        for (const Index k : targets_seen(means.is_seen.row(i))) {
            view.corners.push_back(setup_.corners[static_cast<std::size_t>(k)]);
            view.pixels.emplace_back(means.observations.row(i).segment<2>(2 * k).transpose() /
                                     detail::kpx_per_px);
        }
        if (view.corners.size() >= 4 && !detail::are_in_line(view.corners)) {
            views.push_back(std::move(view));
        }
    }
    const auto found =
        detail::find_intrinsics(views, setup_.intrinsics, setup_.is_known, setup_.view.image);
    if (!found && setup_.intrinsics.fx > 0 && setup_.intrinsics.fy > 0) return observed_points();
    if (!found) {
        throw InputError(
            "the camera's intrinsic parameters do not follow from these views; more views of a "
            "plane board that leans to different sides are needed, or intrinsics that are stated, "
            "if only roughly (key sensor.intrinsics)");
    }
    return points_with(*found);
}

}  // namespace posewise
