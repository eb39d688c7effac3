#include "other_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "camera_misfit.hpp"
#include "core/format.hpp"
#include "nominal_residuals.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/measurements.hpp"
#include "task/calibration/expected_distance.hpp"

namespace posewise::detail {
namespace {

/// How the image that a camera was calibrated in becomes the one that it is used with.
struct Change {
    double factor = 1;      ///< of its size
    int quarter_turns = 0;  ///< 1: to the right, -1: to the left

    std::string words() const {
        if (quarter_turns == 0) {
            return fmt::format("an image {} times as large", format_short(factor, 3));
        }
        return fmt::format("the image turned by a quarter to the {}",
                           quarter_turns > 0 ? "right" : "left");
    }
};

/// The same lens, where the middle of the first pixel is at 0, 0.
Intrinsics changed(const Intrinsics& stated, const Change& change, const Vector2d& size) {
    Intrinsics made = stated;
    made.fx *= change.factor;
    made.fy *= change.factor;
    made.cx = (stated.cx + 0.5) * change.factor - 0.5;
    made.cy = (stated.cy + 0.5) * change.factor - 0.5;
    if (change.quarter_turns == 0) return made;
    const bool is_right = change.quarter_turns > 0;
    std::swap(made.fx, made.fy);
    made.cx = is_right ? size.x() - 1 - stated.cy : stated.cy;
    made.cy = is_right ? stated.cx : size.y() - 1 - stated.cx;
    if (stated.distortion == Distortion::BrownConrady && stated.coefficients.size() >= 4) {
        const double sign = is_right ? 1 : -1;
        made.coefficients[2] = sign * stated.coefficients[3];
        made.coefficients[3] = -sign * stated.coefficients[2];
    }
    return made;
}

bool is_known(const SingleCamera& camera) {
    return std::all_of(camera.is_known.begin(), camera.is_known.begin() + 4,
                       [](bool known) { return known; });
}

bool knows_any(const CameraSensor& sensor) {
    for (Index c = 0; c < sensor.camera_count(); ++c) {
        if (is_known(sensor.camera(c))) return true;
    }
    return false;
}

/// The size of the image, stated or twice the middle of what is seen.
Vector2d size_of(const CameraSensor& sensor, Index camera, const Measurements& measured) {
    return 2 * image_of(sensor, camera, measured)[0];
}

/// The campaign with all cameras whose intrinsic parameters are known so changed.
Campaign with_change(const Campaign& campaign, const CameraSensor& sensor, const Change& change,
                     const Measurements& measured) {
    CameraSetup setup = sensor.setup();
    for (Index c = 0; c < sensor.camera_count(); ++c) {
        SingleCamera& camera = setup.camera(c);
        if (!is_known(camera)) continue;
        camera.intrinsics = changed(camera.intrinsics, change, size_of(sensor, c, measured));
    }
    Campaign other = campaign;
    other.sensor = std::make_shared<CameraSensor>(std::move(setup));
    other.has_nominal_base = other.has_nominal_targets = false;  // as if found with these
    return other;
}

/// As many configurations as it takes.
Measurements part_of(const Measurements& measured) {
    constexpr Index enough = 40;
    return take(measured, evenly_spaced(measured.configuration_count(), enough));
}

/// By how much the nominal robot misses half of the corners, infinite if it is not registered.
double distance_of(const Campaign& campaign, const Measurements& measured) {
    try {
        const Registration found = register_base_and_targets(campaign, measured);
        if (!found.is_determined()) return std::numeric_limits<double>::infinity();
        return median_distance(mean_residuals(campaign, found.parameters, measured));
    } catch (const InputError&) {
        return std::numeric_limits<double>::infinity();
    }
}

std::vector<Change> changes_to_try(const CameraSensor& sensor, const Measurements& measured) {
    std::vector<double> factors{0.25, 1.0 / 3, 0.5, 2.0 / 3, 1.5, 2, 3, 4};
    const Intrinsics& first = sensor.setup().intrinsics;
    const double centred =
        (size_of(sensor, 0, measured).array() / (2 * Vector2d(first.cx, first.cy).array() + 1))
            .mean();
    const bool is_new = std::ranges::none_of(
        factors, [&](double factor) { return std::abs(centred / factor - 1) < 0.02; });
    if (is_new && centred > 0.1 && centred < 10 && std::abs(centred - 1) > 0.1) {
        factors.push_back(centred);
    }
    std::vector<Change> changes{{1, 1}, {1, -1}};
    for (const double factor : factors) changes.push_back({factor, 0});
    return changes;
}

/// Whether a principal point is away from the middle.
bool is_off_middle(const CameraSensor& sensor, const Measurements& measured) {
    constexpr double away = 0.1;  // of the image
    for (Index c = 0; c < sensor.camera_count(); ++c) {
        if (!is_known(sensor.camera(c))) continue;
        const Intrinsics& stated = sensor.camera(c).intrinsics;
        const auto [middle, extents] = image_of(sensor, c, measured);
        const Vector2d off = Vector2d(stated.cx, stated.cy) - middle;
        if (off.cwiseQuotient(extents).cwiseAbs().maxCoeff() > away) return true;
    }
    return false;
}

}  // namespace

std::array<Vector2d, 2> image_of(const CameraSensor& sensor, Index camera,
                                 const Measurements& measured) {
    const auto& image = sensor.camera(camera).image;
    if (image) return {*image / 2, *image};
    Vector2d least = Vector2d::Constant(std::numeric_limits<double>::infinity()), most = -least;
    for (Index i = 0; i < measured.is_seen.rows(); ++i) {
        for (const Index k : targets_seen(measured.is_seen.row(i))) {
            if (k / sensor.corner_count() != camera) continue;
            const Vector2d place = 1e3 * measured.observations.row(i).segment<2>(2 * k).transpose();
            least = least.cwiseMin(place);
            most = most.cwiseMax(place);
        }
    }
    return {(least + most) / 2, most - least};
}

std::optional<double> find_other_side(const Campaign& campaign, const Measurements& measured,
                                      const Misfit& misfit) {
    constexpr double far_less = 0.2;
    const auto* const sensor = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return std::nullopt;
    CameraSetup setup = sensor->setup();
    setup.is_on_flange = !setup.is_on_flange;
    setup.known_place.reset();
    setup.view = {};
    const auto turned = std::make_shared<CameraSensor>(std::move(setup));
    Campaign other = campaign;
    other.nominal.sensor = turned->unknowns(Isometry3d::Identity(), turned->setup().intrinsics,
                                            sensor->placed_others(campaign.nominal.sensor));
    other.sensor = turned;
    other.has_nominal_base = other.has_nominal_targets = false;
    const double found = distance_of(other, part_of(measured));
    if (!(found < std::min(far_less * misfit.distance, credible_errors * misfit.expected))) {
        return std::nullopt;
    }
    return found;
}

std::optional<OtherImage> find_other_image(const Campaign& campaign, const Measurements& measured,
                                           const Parameters& registered) {
    constexpr double clearly = 0.5;
    const auto* const sensor = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (sensor == nullptr) return std::nullopt;
    if (!knows_any(*sensor)) return std::nullopt;
    if (!is_off_middle(*sensor, measured) && !fits_no_pose(campaign, measured, registered)) {
        return std::nullopt;
    }
    const Measurements part = part_of(measured);
    const double stated = median_distance(mean_residuals(campaign, registered, part));
    std::optional<OtherImage> best;
    for (const Change& change : changes_to_try(*sensor, part)) {
        const double distance = distance_of(with_change(campaign, *sensor, change, measured), part);
        if (distance < clearly * stated && (!best || distance < best->distance)) {
            best = OtherImage{change.words(), distance};
        }
    }
    return best;
}

}  // namespace posewise::detail
