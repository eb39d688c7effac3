#include "sentences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/format.hpp"
#include "core/text.hpp"
#include "model/error_class.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {
namespace {

/// ", joints repeat to 0.01 mrad"; nothing if they repeat exactly. Several values as a range.
std::string describe_repeatability(const Campaign& campaign) {
    std::string text;
    for (const Motion motion : {Motion::Rotation, Motion::Translation}) {
        double least = std::numeric_limits<double>::infinity();
        double largest = 0;
        for (Index j = 0; j < campaign.joint_repeatability.size(); ++j) {
            if (campaign.robot.joint(j).motion != motion) continue;
            least = std::min(least, campaign.joint_repeatability[j]);
            largest = std::max(largest, campaign.joint_repeatability[j]);
        }
        if (largest == 0) continue;
        text += ", joints repeat to ";
        if (least < largest) text += format_short(mm_per_m * least) + " to ";
        text += format_error(largest, motion == Motion::Rotation);
    }
    return text;
}

}  // namespace

bool is_told_by_estimate(const Plan& plan, const KnownWithin& known) {
    return !plan.request.sources.estimate.empty() && known.model_error < model_error_factor;
}

std::string describe_model_error(const Campaign& campaign) {
    const Sensor& sensor = *campaign.sensor;
    std::string text;
    if (sensor.has_lengths() || sensor.has_pixels())
        text = format_short(mm_per_m * campaign.model_error, 4) + " mm";
    if (!sensor.has_angles()) return text;
    return text + (text.empty() ? "" : " and ") +
           format_short(mrad_per_rad * campaign.model_error_orientation, 4) + " mrad";
}

std::string describe_ends(const CountBand& band, const std::string& none) {
    if (band.lower == band.upper) return "";
    const auto text = [&](const std::optional<Index>& count) {
        return count ? std::to_string(*count) : none;
    };
    return fmt::format(" (90 %: {} to {})", text(band.lower), text(band.upper));
}

std::string describe_scaling(const Campaign& campaign, double repeats) {
    std::string text = fmt::format(
        "noise: {}, {}{}, model error {}\nscale: {} mm and {} mrad a parameter",
        campaign.sensor->words().sentence,
        repeats == 1 ? "single samples" : "mean of " + format_short(repeats) + " samples",
        describe_repeatability(campaign), describe_model_error(campaign),
        format_short(mm_per_m * campaign.spread.length),
        format_short(mrad_per_rad * campaign.spread.angle));
    if (campaign.spread.offset) {
        text += fmt::format(", {} mrad a joint offset",
                            format_short(mrad_per_rad * *campaign.spread.offset));
    }
    const auto add = [&](ErrorClass of_class, const char* what, double size) {
        const bool is_angle = of_class != ErrorClass::SlideHarmonic;
        for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
            if (error_class_of(campaign.robot, k) != of_class) continue;
            text += fmt::format(", {} {} a {} term", format_short(mrad_per_rad * size),
                                units_of(is_angle).error, what);
            return;
        }
    };
    add(ErrorClass::Gravity, "gravity", campaign.spread.gravity);
    add(ErrorClass::Harmonic, "harmonic", campaign.spread.harmonic);
    add(ErrorClass::SlideHarmonic, "harmonic", campaign.spread.slide_harmonic);
    add(ErrorClass::Tilt, "tilt", campaign.spread.tilt);
    add(ErrorClass::Gain, "gain", campaign.spread.gain);
    if (!campaign.spread.by_name.empty()) text += ", others by name in the campaign file";
    text += '\n';
    if (campaign.prior) return text + "prior: that of an earlier estimate\n";
    if (prior_count(campaign) > 0) text += "prior: the scale, as standard deviation\n";
    return text;
}

std::string describe_looseness(double efficiency, Index starts_at_best, Index starts) {
    constexpr double loose_efficiency = 0.9;
    if (efficiency >= loose_efficiency) return "";
    if (starts == 0) return "the bound is loose at so few poses";
    return fmt::format(
        "the bound is loose at so few poses: {} of {} independent starts ended at this value",
        starts_at_best, starts);
}

std::string describe(const Cure& cure, const Campaign& campaign) {
    return fmt::format("with {}: {} instead of {} {} held out", spell(cure.remedy),
                       format_short(1e3 * cure.after, 3), format_short(1e3 * cure.before, 3),
                       campaign.sensor->main_units().error);
}

std::string describe_images(const std::string& begin, const std::vector<ImageCoverage>& images) {
    std::string text;
    for (const ImageCoverage& image : images) {
        text += fmt::format("{}{:.0f} % of {} image", text.empty() ? begin : "; ", 100 * image.part,
                            image.name.empty() ? "the" : image.name + "'s");
        if (image.part == 0 || image.empty.empty()) continue;
        text += ", none at its " + list_words(image.empty);
    }
    return text;
}

bool is_model_error_found(const Calibration& calibration) {
    const auto names = calibration.campaign.robot.parameter_names();
    const bool has_any = std::ranges::any_of(names, [&](const std::string& name) {
        return std::ranges::find(calibration.held, name) == calibration.held.end();
    });
    return has_any && calibration.campaign.spread.is_prior &&
           calibration.method != CalibrationMethod::TwoStep;
}

std::string describe_largest(const std::vector<ErrorPart>& parts, double total,
                             const AmountUnits& units) {
    if (!(total > 0)) return "";
    const auto& [size, what] = *std::ranges::max_element(parts, {}, &ErrorPart::size);
    return fmt::format("{}: {}, {:.0f} % of the square", what, format_error(size, units),
                       100 * size * size / (total * total));
}

std::string format_error(double value, const AmountUnits& units) {
    if (std::isnan(value)) return "-";
    return format_short(mm_per_m * value, 4) + ' ' + std::string(units.error);
}

}  // namespace posewise::detail
