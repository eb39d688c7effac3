#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrator/part_alone.hpp"
#include "calibrator/residual_lengths.hpp"
#include "camera_misfit.hpp"
#include "core/format.hpp"
#include "core/statistics.hpp"
#include "gross_errors.hpp"
#include "nominal_residuals.hpp"
#include "other_image.hpp"
#include "plane_doubts.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/task/doubts.hpp"
#include "task/calibration/expected_distance.hpp"

namespace posewise {
namespace {

/// From here on other readings are tried: of a wrist reversed joints may do no more.
constexpr double doubtful_errors = 1;

std::string describe(const Plane& plane) {
    return fmt::format(
        "normal [{}, {}, {}] and offset {} mm", detail::format_fixed(plane.normal.x(), 3),
        detail::format_fixed(plane.normal.y(), 3), detail::format_fixed(plane.normal.z(), 3),
        detail::format_mm(plane.offset, 1));
}

/// "reversed", but where the normal points neither there nor where it is stated.
std::string describe_turn(const Vector3d& stated, const Vector3d& measured) {
    if (!detail::is_turned(stated, measured)) return "reversed";
    return fmt::format("turned by {} deg",
                       detail::format_short(to_degrees(std::acos(stated.dot(measured))), 2));
}

/// Whether orientations are off by more than a robot's are.
bool are_orientations_off(const Campaign& campaign, const RowMatrixXd& residuals) {
    if (!campaign.sensor->has_orientation()) return false;
    const Metrics metrics = make_metrics(residuals, campaign.sensor->lengths_per_target());
    return metrics.orientation_rms > detail::gross_angle;
}

double expected_pixels_of(const Campaign& campaign, const Measurements& measured,
                          const Parameters& registered) {
    // Beside a wrong place of the camera it would be any number of pixels.
    const double as_stated = detail::expected_pixels_as_stated(campaign, measured);
    return std::isfinite(as_stated) ? as_stated
                                    : detail::expected_pixels(campaign, registered, measured);
}

/// Of the instrument that tells most by itself, if it is in the unit of all.
std::optional<Misfit> find_misfit_of_part(const Campaign& campaign, const Measurements& measured,
                                          const Parameters& registered) {
    const auto alone = detail::telling_part(campaign, measured, registered);
    const bool is_alike = &alone.campaign.sensor->main_units() == &campaign.sensor->main_units();
    if (alone.campaign.sensor->is_combined() || !is_alike) return std::nullopt;
    return find_misfit(alone.campaign, alone.measured, alone.registered);
}

}  // namespace

double detail::median_distance(const RowMatrixXd& residuals) {
    const auto coordinates = residuals.leftCols(std::min<Index>(3, residuals.cols()));
    return quantile(residual_lengths(coordinates), 0.5, QuantileRule::Upper);
}

std::optional<Misfit> find_misfit(const Campaign& campaign, const Measurements& measured,
                                  const Parameters& registered) {
    if (campaign.sensor->is_combined()) return find_misfit_of_part(campaign, measured, registered);
    const bool has_pixels = campaign.sensor->has_only_pixels();
    if (!campaign.sensor->has_lengths() && !has_pixels) return std::nullopt;  // it is not known
    Misfit misfit;
    const RowMatrixXd residuals = mean_residuals(campaign, registered, measured);
    misfit.distance = detail::median_distance(residuals);
    misfit.expected = has_pixels ? expected_pixels_of(campaign, measured, registered)
                                 : detail::expected_distance(campaign, measured);
    misfit.image = detail::find_other_image(campaign, measured, registered);
    if (misfit.image) return misfit;
    // Corners by the hundred take long to try, and wrong ones miss by far.
    const double doubtful = has_pixels ? detail::credible_errors : doubtful_errors;
    if (misfit.distance <= doubtful * misfit.expected &&
        !are_orientations_off(campaign, residuals) &&
        !detail::fits_no_pose(campaign, measured, registered)) {
        return std::nullopt;
    }
    if (auto of_cameras = detail::find_camera_misfit(campaign, measured, misfit)) {
        return of_cameras;
    }
    misfit.on_other_side = detail::find_other_side(campaign, measured, misfit);
    if (misfit.on_other_side) return misfit;
    misfit.reading = search_readings(campaign, measured).better;
    const bool is_credible = misfit.distance <= detail::credible_errors * misfit.expected;
    if (is_credible && !misfit.reading) return std::nullopt;
    misfit.planes = find_plane_doubts(campaign, measured);
    if (misfit.reading && !misfit.planes.empty()) {
        // What takes fewer changes is more likely.
        if (misfit.reading->change_count <= std::ssize(misfit.planes)) {
            misfit.planes.clear();
        } else {
            misfit.reading.reset();
        }
    }
    return misfit;
}

void check_is_of_robot(const Campaign& campaign, const Measurements& measured,
                       const Registration& registration) {
    if (!registration.is_determined()) return;
    const auto misfit = find_misfit(campaign, measured, registration.parameters);
    if (misfit) throw InputError(describe_misfit(campaign, *misfit));
    std::vector<PlaceDoubt> places = find_place_doubts(campaign, registration.parameters);
    std::erase_if(places, [](const auto& doubt) { return doubt.unit == PlaceDoubt::Unit::AsRead; });
    if (!places.empty()) throw InputError(describe_places(places));
}

std::string describe_planes(const std::vector<PlaneDoubt>& planes) {
    std::string text;
    for (const PlaneDoubt& doubt : planes) {
        text += fmt::format("{}plane {} looks {}: stated with {}, measured at about {}",
                            text.empty() ? "" : "; ", doubt.plane + 1,
                            describe_turn(doubt.stated.normal, doubt.measured.normal),
                            describe(doubt.stated), describe(doubt.measured));
    }
    return text;
}

std::string describe_misfit(const Campaign& campaign, const Misfit& misfit) {
    const std::string_view unit = campaign.sensor->main_units().error;
    if (misfit.image) {
        return fmt::format(
            "the intrinsics stated are not of this image: as those of {} the nominal robot misses "
            "half of the corners by {} instead of {} px; state intrinsics of the image that is "
            "measured in, of its size and neither cropped nor turned",
            misfit.image->words, detail::format_short(1e3 * misfit.image->distance, 3),
            detail::format_short(1e3 * misfit.distance, 3));
    }
    if (misfit.on_other_side) {
        const auto& camera = dynamic_cast<const CameraSensor&>(*campaign.sensor);
        return fmt::format(
            "the corners fit a camera {}: the nominal robot then misses half of them by {} instead "
            "of {} px; sensor.camera says {}",
            camera.setup().is_on_flange ? "that stands still and sees the board on the flange"
                                        : "on the flange that sees a board that stands still",
            detail::format_short(1e3 * *misfit.on_other_side, 3),
            detail::format_short(1e3 * misfit.distance, 3),
            camera.setup().is_on_flange ? "flange" : "fixed");
    }
    if (misfit.camera) {
        return fmt::format(
            "camera {} is at fault: the nominal robot misses half of its corners by over {} px, of "
            "each other camera by {}; are its columns u and v, its corners' numbers and its rows' "
            "poses right?",
            *misfit.camera + 1, detail::format_short(1e3 * misfit.distance, 3),
            detail::format_short(1e3 * misfit.others, 3));
    }
    if (misfit.is_between_cameras) {
        return fmt::format(
            "the cameras do not belong together: half of all corners are missed by over {} px, of "
            "each camera by itself by {} at most; do all number the corners alike, and is no image "
            "mirrored?",
            detail::format_short(1e3 * misfit.distance, 3),
            detail::format_short(1e3 * misfit.others, 3));
    }
    if (campaign.sensor->has_only_pixels() && misfit.reading) return describe(*misfit.reading);
    return fmt::format(
        "are these of another robot? The nominal robot misses half of them by over {} {}; must be "
        "about {} {}, as the spread of {} says{}{}{}",
        detail::format_short(1e3 * misfit.distance, 3), unit,
        detail::format_short(1e3 * misfit.expected, 3), unit, campaign.name,
        misfit.planes.empty() ? "" : "; ", describe_planes(misfit.planes),
        misfit.reading ? "; " + describe(*misfit.reading) : "");
}

}  // namespace posewise
