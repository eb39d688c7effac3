#include "data_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "absurd_values.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "held_out_doubt.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "task/calibration/cures.hpp"
#include "task/calibration/expected_distance.hpp"

namespace posewise::detail {
namespace {

/// The residuals contradict what is stated: errors of a kind that was not reckoned with.
constexpr double beyond_stated = 3;
/// No instrument's scale is off by more, nor does any temperature make a robot so much longer.
constexpr double largest_factor = 0.005;

std::string describe(double value, const AmountUnits& units) {
    return format_short(1e3 * value, 3) + ' ' + std::string(units.error);
}

void add_comparison(const HeldOutComparison& held_out, double times_stated,
                    const AmountUnits& units, std::vector<std::string>& faults) {
    const std::string both =
        fmt::format("{}, by the nominal robot by {}", describe(held_out.calibrated, units),
                    describe(held_out.nominal, units));
    if (held_out.is_worse()) {
        faults.push_back("poses that were held out are missed by " + both +
                         ": most are missed by more than without a calibration");
    } else if (held_out.is_no_better() && times_stated > beyond_stated) {
        faults.push_back(
            fmt::format("poses that were held out are missed by {}: not shown to be better", both));
    }
}

void add_left_over(const Doubted& doubted, const Metrics& fit, std::vector<std::string>& faults) {
    const Sensor& sensor = *doubted.campaign.sensor;
    for (const bool is_angle : {false, true}) {
        if (!(is_angle ? sensor.has_angles() : sensor.has_lengths())) continue;
        const double left = is_angle ? fit.orientation_rms : fit.distance_rms;
        const double most = largest_left_over(doubted.campaign, doubted.estimate.parameters,
                                              doubted.measurements, is_angle);
        if (!(left > most)) continue;
        faults.push_back(fmt::format(
            "it leaves {} over, a robot of this kind misses only {} before it is calibrated",
            describe(left, sensor.units(is_angle)), describe(most, sensor.units(is_angle))));
    }
}

/// Lengths and angles left over, of means, less outliers.
Metrics left_over(const Calibration& calibration) {
    Metrics left = calibration.estimate.fit_means;
    const auto& others = calibration.without_outliers;
    if (!others) return left;
    const bool has_lengths = calibration.campaign.sensor->has_lengths();
    (has_lengths ? left.distance_rms : left.orientation_rms) = others->fit_rms;
    if (others->fit_angle_rms) left.orientation_rms = *others->fit_angle_rms;
    return left;
}

/// Whether another model may do better. Of another robot none would.
bool asks_for_models(const Doubts& doubts) {
    const bool has_large_residuals =
        std::ranges::any_of(doubts.residuals, [](const auto& doubt) { return doubt.ratio > 1; });
    return !doubts.misfit &&
           (has_large_residuals || !doubts.model_errors.empty() || !doubts.sizes.empty() ||
            !doubts.learned_sizes.empty() || doubts.missing_errors || doubts.gross_error ||
            doubts.orientations || doubts.scatter || doubts.held_out);
}

/// Whether it is worth while to look for what would do better.
bool asks_for_cures(const Doubts& doubts) {
    return doubts.look.outlying || asks_for_models(doubts);
}

std::vector<std::string> find_data_faults(const Doubted& doubted, const Calibration& calibration,
                                          const std::optional<HeldOutComparison>& held_out) {
    const AmountUnits& units = doubted.campaign.sensor->main_units();
    std::vector<std::string> faults;
    if (asks_for_cures(calibration.doubts)) {
        if (const auto lone = find_lone_configuration(doubted)) {
            faults.push_back(fmt::format("without configuration {} it leaves {} instead of {}",
                                         quote(lone->id), describe(lone->after, units),
                                         describe(lone->before, units)));
        }
    }
    if (held_out) {
        add_comparison(*held_out, times_stated(doubted.campaign, doubted.estimate), units, faults);
    }
    // Where none of its errors are fitted it leaves as much over as before.
    if (doubted.campaign.robot.parameter_count() > 0) {
        add_left_over(doubted, left_over(calibration), faults);
    }
    if (const auto& lengths = calibration.doubts.look.lengths) {
        if (lengths->errors && std::abs(lengths->excess) > largest_factor) {
            faults.push_back(fmt::format(
                "all lengths are {} % {} than the robot's, which no instrument and no temperature "
                "does: is it another robot, or are they in another unit?",
                format_short(100 * std::abs(lengths->excess), 2),
                lengths->excess > 0 ? "longer" : "shorter"));
        }
    }
    return faults;
}

/// With the noise that corners show in each view by itself.
void add_scatter(const Calibration& calibration, std::vector<OtherCampaign>& campaigns) {
    const auto& doubt = calibration.doubts.camera;
    const auto* const camera = dynamic_cast<const CameraSensor*>(calibration.campaign.sensor.get());
    if (camera == nullptr || !doubt || doubt->scatter == 0) return;
    const std::string sigma = format_short(doubt->scatter, 2);
    CameraSetup setup = camera->setup();
    const double times = std::stod(sigma) / setup.sigma;
    setup.sigma *= times;
    for (SingleCamera& other : setup.others) other.sigma *= times;
    Campaign campaign = calibration.campaign;
    campaign.sensor = std::make_shared<CameraSensor>(std::move(setup));
    campaigns.push_back({"sensor.sigma_px: " + sigma, std::move(campaign)});
}

/// With intrinsic parameters found that are stated as known exactly.
void add_unknown_intrinsics(const Campaign& campaign, std::vector<OtherCampaign>& campaigns) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr) return;
    CameraSetup setup = camera->setup();
    bool is_any_known = false;
    for (Index c = 0; c < camera->camera_count(); ++c) {
        SingleCamera& one = setup.camera(c);
        const Index count = one.intrinsics.values().size();
        const bool is_all_unknown = std::ssize(camera->unknown_intrinsics(c)) == count;
        if (is_all_unknown || !camera->doubtful_intrinsics(c).empty()) continue;
        is_any_known = true;
        one.is_known.assign(static_cast<std::size_t>(count), false);
        one.deviations.clear();
    }
    if (!is_any_known) return;
    const VectorXd& nominal = campaign.nominal.sensor;
    const auto sensor = std::make_shared<CameraSensor>(std::move(setup));
    Campaign other = campaign;
    other.nominal.sensor = sensor->unknowns(camera->place(nominal), sensor->setup().intrinsics,
                                            camera->placed_others(nominal));
    other.sensor = sensor;
    campaigns.push_back({"sensor.intrinsics.known: false", std::move(other)});
}

CureOptions cure_options(const CalibrationOptions& options, const Calibration& calibration) {
    CureOptions cures;
    cures.only_exclusions = !asks_for_models(calibration.doubts);
    if (cures.only_exclusions || options.earlier) return cures;  // its sizes and errors are those
    cures.can_learn_sizes =
        !calibration.stated_spread && calibration.campaign.robot.parameter_count() > 0;
    if (options.richer) cures.campaigns = options.richer();
    add_scatter(calibration, cures.campaigns);
    add_unknown_intrinsics(calibration.campaign, cures.campaigns);
    return cures;
}

}  // namespace

void judge_data(const CalibrationData& data, const CalibrationOptions& options,
                Calibration& calibration) {
    const Estimate& estimate = calibration.estimate;
    const bool is_final =
        estimate.ending == Ending::Converged || estimate.ending == Ending::RoundoffLimited;
    const Index folds = comparable_folds(calibration.held_out ? calibration.held_out->folds : 0,
                                         data.measurements.configuration_count());
    if (!is_final || folds == 0) return;
    LevenbergMarquardtOptions as_found = data.options;
    as_found.finds_model_error = false;
    const CrossValidation held_out = calibration.held_out
                                         ? *calibration.held_out
                                         : cross_validate(calibration.campaign, data.measurements,
                                                          estimate.parameters, folds, as_found);
    const bool has_errors = data.robot.parameter_count() > 0;
    const auto comparison = has_errors
                                ? compare_with_nominal(data.campaign, data.robot, data.measurements,
                                                       data.registered, held_out, as_found)
                                : std::nullopt;
    if (options.stop.is_set()) return;
    if (calibration.held_out && held_out.samples.point_count > 0) {
        calibration.held_out_comparison = comparison;
    }
    if (comparison && comparison->is_no_better()) calibration.doubts.held_out = comparison;
    const Doubted doubted{data.campaign, data.measurements, estimate, held_out, data.options};
    const std::vector<std::string> faults = find_data_faults(doubted, calibration, comparison);
    calibration.faults.insert(calibration.faults.begin(), faults.begin(), faults.end());
    if (options.method != CalibrationMethod::Joint || !asks_for_cures(calibration.doubts)) return;
    calibration.cures = find_cures(doubted, calibration.doubts, cure_options(options, calibration));
}

}  // namespace posewise::detail
