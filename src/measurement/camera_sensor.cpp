#include "posewise/measurement/camera_sensor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "board_starts.hpp"
#include "camera_view.hpp"
#include "core/format.hpp"
#include "known_sensor.hpp"
#include "noise_words.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "rigid_points.hpp"

namespace posewise {
namespace {

constexpr double most_corner_sigma = 0.1;  // m

std::vector<std::optional<Vector3d>> point_of_place(const std::optional<Isometry3d>& place) {
    if (!place) return {std::nullopt};
    return {Vector3d(place->translation())};
}

void check(SingleCamera& camera) {
    const std::size_t values = 4 + camera.intrinsics.coefficients.size();
    if (camera.is_known.empty()) camera.is_known.assign(values, true);
    if (camera.is_known.size() != values) {
        throw InputError(fmt::format("{} intrinsic parameters are said to be known or not, not {}",
                                     camera.is_known.size(), values));
    }
    if (camera.deviations.empty()) camera.deviations.assign(values, 0);
    if (camera.deviations.size() != values) {
        throw InputError(fmt::format("{} deviations of intrinsic parameters are stated, not {}",
                                     camera.deviations.size(), values));
    }
    for (std::size_t k = 0; k < values; ++k) {
        if (std::isfinite(camera.deviations[k]) && camera.deviations[k] >= 0 &&
            (camera.deviations[k] == 0 || camera.is_known[k])) {
            continue;
        }
        throw InputError(
            fmt::format("the deviation of {} must be a finite number, 0 or more, of "
                        "an intrinsic parameter that is known",
                        camera.intrinsics.names()[k]));
    }
    Intrinsics assumed = camera.intrinsics;
    if (assumed.fx == 0 && !camera.is_known[0]) assumed.fx = 1;
    if (assumed.fy == 0 && !camera.is_known[1]) assumed.fy = 1;
    check_intrinsics(assumed);
    detail::check_sigma("sigma", detail::kpx_per_px * camera.sigma, "kpx");
    detail::check_growth(camera.growth);
}

CameraSetup checked(CameraSetup setup) {
    check(setup);
    for (SingleCamera& other : setup.others) check(other);
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
    if (!(setup.corner_sigma >= 0 && setup.corner_sigma <= most_corner_sigma)) {
        throw InputError(fmt::format("the corners' sigma is {:g} m, must be from 0 to {:g} m",
                                     setup.corner_sigma, most_corner_sigma));
    }
    if (!(setup.view.nearest >= 0 && setup.view.nearest < setup.view.farthest)) {
        throw InputError(
            fmt::format("depths in view are from {:g} to {:g} m, the first must be less",
                        setup.view.nearest, setup.view.farthest));
    }
    return setup;
}

/// How many unknowns have a size that is known.
Index sized_count(const CameraSetup& setup) {
    const auto doubtful = [](const SingleCamera& camera) {
        return std::ranges::count_if(camera.deviations, [](double sigma) { return sigma > 0; });
    };
    Index count = setup.corner_sigma > 0 ? 3 * std::ssize(setup.corners) : 0;
    count += doubtful(setup);
    for (const SingleCamera& other : setup.others) count += doubtful(other);
    return count;
}

/// ", growing with tilt".
std::string growth_words(const NoiseGrowth& growth) {
    if (growth.is_none()) return "";
    return fmt::format(", growing with {}{}{}", growth.tilt > 0 ? "tilt" : "",
                       growth.tilt > 0 && growth.focus ? " and " : "",
                       growth.focus ? "distance from focus" : "");
}

/// ", seen from 250 mm to 900 mm".
std::string depth_words(const CameraView& view) {
    std::string words;
    if (view.nearest > 0) words += fmt::format(" from {:g} mm", mm_per_m * view.nearest);
    if (std::isfinite(view.farthest)) words += fmt::format(" to {:g} mm", mm_per_m * view.farthest);
    return words.empty() ? words : ", seen" + words;
}

/// "camera.", "camera2."
std::string prefix_of(Index camera) {
    return camera == 0 ? "camera." : fmt::format("camera{}.", camera + 1);
}

/// The camera, if it is one; whether its unknowns are known or not.
const CameraSensor* as_camera(const Sensor& sensor) {
    const auto* const known = dynamic_cast<const detail::KnownSensor*>(&sensor);
    return dynamic_cast<const CameraSensor*>(known != nullptr ? &known->original() : &sensor);
}

}  // namespace

Isometry3d detail::frame_from(const Eigen::Ref<const VectorXd>& six) {
    Isometry3d frame = Isometry3d::Identity();
    frame.translation() = six.head<3>();
    frame.linear() = rotation_from_vector(six.segment<3>(3));
    return frame;
}

CameraSensor::CameraSensor(CameraSetup setup)
    : setup_(checked(std::move(setup))),
      origin_(point_of_place(setup_.known_place), sized_count(setup_)) {
    std::vector<double> sizes(static_cast<std::size_t>(corner_error_count()), setup_.corner_sigma);
    unknown_count_ = sized_count(setup_) + (has_unknown_place() ? 6 : 0);
    for (Index c = 0; c < camera_count(); ++c) {
        OwnUnknowns own{unknown_count_, {}, std::ssize(sizes)};
        const SingleCamera& one = camera(c);
        for (std::size_t k = 0; k < one.deviations.size(); ++k) {
            if (one.deviations[k] == 0) continue;
            own.doubtful.push_back(static_cast<Index>(k));
            sizes.push_back(one.deviations[k]);
        }
        for (std::size_t k = 0; k < one.is_known.size(); ++k) {
            if (!one.is_known[k]) own.intrinsics.push_back(static_cast<Index>(k));
        }
        if (one.intrinsics.fx > 0) {
            own.widest = detail::widest_tangent(detail::lens_of(one.intrinsics));
        }
        unknown_count_ += (c > 0 ? 6 : 0) + std::ssize(own.intrinsics);
        own_.push_back(std::move(own));
    }
    if (setup_.is_scale_unknown) ++unknown_count_;
    sizes_ = Eigen::Map<const VectorXd>(sizes.data(), std::ssize(sizes));
    if (const auto plane = detail::plane_of(setup_.corners)) {
        const Vector3d normal = plane->linear().col(2);
        const bool is_plus = normal.z() > 0 || (normal.z() == 0 && normal.sum() > 0);
        normal_ = is_plus == setup_.view.is_front_plus_z ? normal : Vector3d(-normal);
    }
    for (Index c = 0; c < camera_count() && !normal_; ++c) {
        if (camera(c).growth.tilt == 0) continue;
        throw InputError("noise.tilt is stated, but the corners are in no plane; must be left out");
    }
}

std::vector<PlacedCamera> CameraSensor::placed_others(const VectorXd& unknowns) const {
    std::vector<PlacedCamera> others;
    for (Index c = 1; c < camera_count(); ++c) others.push_back(placed(c, unknowns));
    return others;
}

Isometry3d CameraSensor::place(const VectorXd& unknowns) const {
    if (setup_.known_place) return *setup_.known_place;
    return detail::frame_from(unknowns.segment<6>(first_of_place()));
}

PlacedCamera CameraSensor::placed(Index camera, const VectorXd& unknowns) const {
    const SingleCamera& one = this->camera(camera);
    PlacedCamera placed{Isometry3d::Identity(), one.intrinsics, one.image};
    if (camera > 0) {
        placed.in_first = detail::frame_from(unknowns.segment<6>(first_unknown(camera)));
    }
    const std::vector<Index>& unknown = unknown_intrinsics(camera);
    VectorXd values = placed.intrinsics.values();
    values(unknown) = unknowns.segment(first_intrinsic(camera), std::ssize(unknown));
    const std::vector<Index>& doubtful = doubtful_intrinsics(camera);
    values(doubtful) += unknowns.segment(first_intrinsic_error(camera), std::ssize(doubtful));
    placed.intrinsics = placed.intrinsics.with(values);
    return placed;
}

Isometry3d CameraSensor::camera_from_board(const Isometry3d& world_from_flange,
                                           const VectorXd& unknowns) const {
    const Isometry3d world_from_place = world_from_flange * place(unknowns);
    return setup_.is_on_flange ? world_from_place.inverse() : world_from_place;
}

bool CameraSensor::is_seen_from_back(Index camera, const Isometry3d& world_from_flange,
                                     const VectorXd& unknowns) const {
    const Isometry3d board = placed(camera, unknowns).in_first.inverse() *
                             camera_from_board(world_from_flange, unknowns);
    return normal_ && (board.linear() * *normal_).dot(board * corner(0, unknowns)) > 0;
}

VectorXd CameraSensor::unknowns(const Isometry3d& place, const Intrinsics& intrinsics,
                                const std::vector<PlacedCamera>& others) const {
    VectorXd unknowns = VectorXd::Zero(unknown_count_);
    if (has_unknown_place()) unknowns.segment<6>(first_of_place()) = tool_unknowns(place);
    for (Index c = 0; c < camera_count(); ++c) {
        const auto other = static_cast<std::size_t>(c - 1);
        const bool is_placed = c > 0 && other < others.size();
        if (is_placed) {
            unknowns.segment<6>(first_unknown(c)) = tool_unknowns(others[other].in_first);
        }
        const Intrinsics& lens = c == 0      ? intrinsics
                                 : is_placed ? others[other].intrinsics
                                             : camera(c).intrinsics;
        const std::vector<Index>& unknown = unknown_intrinsics(c);
        unknowns.segment(first_intrinsic(c), std::ssize(unknown)) = lens.values()(unknown);
        const std::vector<Index>& doubtful = doubtful_intrinsics(c);
        unknowns.segment(first_intrinsic_error(c), std::ssize(doubtful)) =
            lens.values()(doubtful) - camera(c).intrinsics.values()(doubtful);
    }
    return unknowns;
}

std::vector<std::string> CameraSensor::observation_names() const {
    std::vector<std::string> names;
    for (Index c = 0; c < camera_count(); ++c) {
        const std::string camera = c == 0 ? "" : fmt::format("c{}_", c + 1);
        for (Index k = 1; k <= corner_count(); ++k) {
            names.push_back(fmt::format("{}p{}_u", camera, k));
            names.push_back(fmt::format("{}p{}_v", camera, k));
        }
    }
    return names;
}

std::vector<std::string> CameraSensor::unknown_names() const {
    std::vector<std::string> names;
    for (Index k = 0; k < corner_error_count(); ++k) {
        names.push_back(fmt::format("board.p{}.{}", setup_.first_corner + k / 3, "xyz"[k % 3]));
    }
    for (Index c = 0; c < camera_count(); ++c) {
        const auto of_values = camera(c).intrinsics.names();
        for (const Index k : doubtful_intrinsics(c)) {
            names.push_back(prefix_of(c) + "d" + of_values[static_cast<std::size_t>(k)]);
        }
    }
    const auto add_pose = [&names](const std::string& of) {
        for (const char* const name : {"x", "y", "z", "rx", "ry", "rz"}) names.push_back(of + name);
    };
    if (has_unknown_place()) add_pose(setup_.is_on_flange ? "camera." : "board.");
    for (Index c = 0; c < camera_count(); ++c) {
        if (c > 0) add_pose(prefix_of(c));
        const auto of_values = camera(c).intrinsics.names();
        for (const Index k : unknown_intrinsics(c)) {
            names.push_back(prefix_of(c) + of_values[static_cast<std::size_t>(k)]);
        }
    }
    if (setup_.is_scale_unknown) names.emplace_back("board.scale");
    return names;
}

std::vector<bool> CameraSensor::unknown_is_angle() const {
    std::vector<bool> is_angle(static_cast<std::size_t>(unknown_count_), true);
    const auto set_lengths = [&is_angle](Index first, Index count) {
        std::fill_n(is_angle.begin() + first, count, false);
    };
    set_lengths(0, corner_error_count());
    if (has_unknown_place()) set_lengths(first_of_place(), 3);
    for (Index c = 1; c < camera_count(); ++c) set_lengths(first_unknown(c), 3);
    return is_angle;
}

std::vector<const AmountUnits*> CameraSensor::unknown_units() const {
    auto units = Sensor::unknown_units();
    for (Index c = 0; c < camera_count(); ++c) {
        const auto set = [&units](Index first, const std::vector<Index>& values) {
            auto next = units.begin() + first;
            for (const Index k : values) *next++ = k < 4 ? &pixel_units : &plain_units;
        };
        set(first_intrinsic(c), unknown_intrinsics(c));
        set(first_intrinsic_error(c), doubtful_intrinsics(c));
    }
    if (setup_.is_scale_unknown) units.back() = &plain_units;
    return units;
}

void CameraSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                           Eigen::Ref<VectorXd> observation) const {
    const Isometry3d board = camera_from_board(world_from_flange, unknowns);
    Index row = 0;
    for (Index c = 0; c < camera_count(); ++c) {
        const auto one = detail::camera_in_first(*this, c, unknowns);
        for (Index k = 0; k < corner_count(); ++k, row += 2) {
            observation.segment<2>(row) =
                detail::place_of(one.lens, one.seen(board * corner(k, unknowns)));
        }
    }
}

bool CameraSensor::is_readable(Index target, const ConstNumbers& observation) const {
    const auto& image = camera(target / corner_count()).image;
    if (!image) return true;
    const Vector2d place = observation.segment<2>(2 * target) / detail::kpx_per_px;
    return (place.array() >= 0).all() && (place.array() <= image->array()).all();
}

void CameraSensor::view_clearances(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                                   Eigen::Ref<VectorXd> clearances) const {
    const CameraView& view = setup_.view;
    const Isometry3d board = camera_from_board(world_from_flange, unknowns);
    Index target = 0;
    for (Index c = 0; c < camera_count(); ++c) {
        const auto one = detail::camera_in_first(*this, c, unknowns);
        const auto& image = camera(c).image;
        const double widest =
            unknown_intrinsics(c).empty() ? this->widest(c) : detail::widest_tangent(one.lens);
        for (Index k = 0; k < corner_count(); ++k) {
            const Vector3d p = one.seen(board * corner(k, unknowns));
            const double to_side = std::atan2(p.head<2>().norm(), p.z());
            double least = std::atan(widest) - to_side;
            if (normal_) {
                const Vector3d normal =
                    one.in_first.linear().transpose() * (board.linear() * *normal_);
                const double tilt = std::atan2(normal.cross(-p).norm(), normal.dot(-p));
                least = std::min(least, view.most_tilt - tilt);
            }
            if (view.nearest > 0) least = std::min(least, p.z() - view.nearest);
            least = std::min(least, view.farthest - p.z());
            if (image && least > 0) {
                const Vector2d place = detail::place_of(one.lens, p);
                const Vector2d focal(one.lens.values[0], one.lens.values[1]);
                const Vector2d size = detail::kpx_per_px * *image;
                least = std::min({least, place.cwiseQuotient(focal).minCoeff(),
                                  (size - place).cwiseQuotient(focal).minCoeff()});
            }
            clearances[target++] = least;
        }
    }
}

SightLines CameraSensor::sight_lines(const Isometry3d& world_from_flange,
                                     const VectorXd& unknowns) const {
    if (!setup_.view.is_line_required) return {};
    const Isometry3d board = camera_from_board(world_from_flange, unknowns);
    const Isometry3d world_from_first =
        setup_.is_on_flange ? world_from_flange * place(unknowns) : Isometry3d::Identity();
    SightLines lines(6, target_count());
    Index target = 0;
    for (Index c = 0; c < camera_count(); ++c) {
        const Vector3d camera = world_from_first * placed(c, unknowns).in_first.translation();
        for (Index k = 0; k < corner_count(); ++k) {
            const Vector3d X = corner(k, unknowns);
            lines.col(target++) << camera, setup_.is_on_flange ? X : Vector3d(board * X);
        }
    }
    return lines;
}

SensorWords CameraSensor::words() const {
    const std::string what = setup_.on_flange();
    std::size_t unknown = 0, doubtful = 0, all = 0;
    for (Index c = 0; c < camera_count(); ++c) {
        unknown += unknown_intrinsics(c).size();
        doubtful += doubtful_intrinsics(c).size();
        all += camera(c).is_known.size();
    }
    std::string intrinsics = "intrinsics known";
    if (unknown > 0) {
        intrinsics = fmt::format("{} of {} intrinsic parameters to be identified", unknown, all);
    }
    if (doubtful > 0) intrinsics += fmt::format(", {} known with a deviation", doubtful);
    std::string seen_by = setup_.is_on_flange ? "a camera on the flange" : "a camera that is fixed";
    std::string unknowns = what + " in the flange frame";
    if (camera_count() > 1) {
        seen_by = fmt::format("{} cameras {}", camera_count(),
                              setup_.is_on_flange ? "on the flange" : "that are fixed");
        unknowns += ", further cameras in the first one's frame";
    }
    if (unknown > 0) unknowns += ", intrinsic parameters of the camera";
    return {
        "corners",
        what,
        unknowns,
        "sensor.place",
        {"base.known", "sensor.place.known"},
        fmt::format("{} corners of a board seen by {} ({} {}), {}, sigma {} px{}{}", corner_count(),
                    seen_by, what, setup_.known_place ? "known" : "to be identified", intrinsics,
                    detail::format_short(setup_.sigma), growth_words(setup_.growth),
                    depth_words(setup_.view))};
}

Index first_corner(const Sensor& sensor) {
    const CameraSensor* const camera = as_camera(sensor);
    return camera != nullptr ? camera->setup().first_corner : 1;
}

Index camera_count(const Sensor& sensor) {
    const CameraSensor* const camera = as_camera(sensor);
    return camera != nullptr ? camera->camera_count() : 1;
}

bool has_exact_corners(const Sensor& sensor) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(&sensor);
    return camera != nullptr ? camera->has_exact_corners() : sensor.unknown_sizes().size() == 0;
}

}  // namespace posewise
