#include "calibration_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

std::string_view method_name(CalibrationMethod method) {
    return detail::name_of(detail::method_names, method);
}

Index default_folds(Index configuration_count) {
    constexpr Index leave_one_out_limit = 100;
    constexpr Index folds = 10;
    if (configuration_count < 2) return 0;
    return configuration_count <= leave_one_out_limit ? configuration_count : folds;
}

void refuse_faults(const Calibration& calibration) {
    if (calibration.faults.empty()) return;
    throw InputError(
        fmt::format("this is no calibration: {}", fmt::join(calibration.faults, "; ")));
}

namespace detail {

std::string judge_measured(const Campaign& campaign, const Measurements& measurements,
                           const JudgeCalibration& judge, const StopSignal& stop) {
    CalibrationOptions options;
    options.folds = 0;
    options.stop = stop;
    constexpr Index enough = 200;  // views, of many numbers each
    const Index count = measurements.configuration_count();
    const bool is_part = campaign.sensor->has_only_pixels() && count > enough;
    const Measurements part =
        is_part ? take(measurements, evenly_spaced(count, enough)) : Measurements{};
    const Calibration calibration = calibrate(campaign, is_part ? part : measurements, options);
    if (calibration.is_identified() && judge && !stop.is_set()) judge(calibration);
    return calibration.estimate.undetermined;
}

void check_options(const CalibrationOptions& options, Index configuration_count) {
    const bool is_joint = options.method == CalibrationMethod::Joint;
    const Index folds = options.folds.value_or(0);
    if (folds != 0 && (folds < 2 || folds > configuration_count)) {
        throw InputError(
            fmt::format("`folds` is {}, must be 0 or from 2 to the number of configurations, {}",
                        folds, configuration_count));
    }
    if (options.earlier && (!is_joint || options.model_selection)) {
        throw InputError("an earlier estimate needs the method lm, without model selection");
    }
    const auto count_refitted = [&](const char* name) {
        return std::count(options.refitted.begin(), options.refitted.end(), name);
    };
    const auto base = count_refitted("base");
    const auto targets = count_refitted("targets");
    if (base + targets < std::ssize(options.refitted)) {
        throw InputError("what is refitted for the validation must be base, targets or both");
    }
    const Campaign* const other = options.validation_campaign;
    if (other != nullptr && (targets == 0 || (base == 0 && base_parameter_count(*other) > 0))) {
        throw InputError("for a validation of another campaign both base and targets are refitted");
    }
    if (!is_joint && options.joint.loss.kind != LossKind::Squares) {
        throw InputError("the loss is " + std::string(loss_name(options.joint.loss.kind)) +
                         ", must be squares with the method " +
                         std::string(method_name(options.method)));
    }
    if (options.model_selection && (!is_joint || options.folds == 0)) {
        throw InputError("model selection needs the method lm, and groups to hold out");
    }
    for (const Index one : options.verification) {
        if (options.used.empty() || std::ranges::count(options.used, one) > 0) {
            throw InputError(
                "poses to verify with must be others than those used, which must be stated");
        }
    }
    if (options.limit && !(*options.limit > 0)) {
        throw InputError(fmt::format("the limit is {} m, must be above 0", *options.limit));
    }
}

}  // namespace detail
}  // namespace posewise
