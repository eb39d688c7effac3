#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "calibration_tables.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "error_classes.hpp"
#include "judgement_report.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "residual_look_report.hpp"
#include "sentences.hpp"

namespace posewise {
namespace {

constexpr Index correlations_shown = 5;
constexpr Index outliers_shown = 20;

std::string describe_starts(const Calibration& calibration) {
    if (calibration.method != CalibrationMethod::Global) return "";
    return fmt::format("{}, {} of them ended at the best{}\n",
                       detail::count_of(calibration.starts, "start"), calibration.starts_at_best,
                       calibration.starts_at_best > 1 ? "" : "; there may be a better one");
}

/// "15 of 86 parameters" where the others are held.
std::string describe_parameter_count(const Calibration& calibration) {
    const Index all = parameter_count(calibration.campaign);
    const Index held = std::ssize(calibration.held);
    const std::string count = detail::count_of(all, "parameter");
    return held == 0 ? count : fmt::format("{} of {}, the others held", all - held, count);
}

std::string describe_measured(const Calibration& calibration) {
    const MeasuredCount& measured = calibration.measured;
    std::string text = fmt::format("{}: {}, {}, {}\n", calibration.campaign.name,
                                   detail::count_of(measured.configurations, "configuration"),
                                   detail::count_of(measured.samples, "sample"),
                                   describe_parameter_count(calibration));
    if (!calibration.excluded.empty()) {
        text += "excluded: " +
                detail::escape_controls(fmt::format("{}", fmt::join(calibration.excluded, ", "))) +
                '\n';
    }
    if (measured.readings_seen < measured.readings) {
        text += fmt::format("{} of {} {} are missing: targets that were not seen\n",
                            measured.readings - measured.readings_seen, measured.readings,
                            calibration.campaign.sensor->words().readings);
    }
    return text;
}

std::string describe_model_error(const Calibration& calibration) {
    const char* what = calibration.estimate.degrees_of_freedom > 0
                           ? "model error found: "
                           : "model error assumed, nothing is left to find it from: ";
    if (!detail::is_model_error_found(calibration)) {
        if (calibration.held.empty()) return "";
        what = "model error of the earlier estimate: ";
    }
    return what + detail::describe_model_error(calibration.campaign) + '\n';
}

/// ": 1.02 in mm, 4.3 in mrad" where both are measured.
std::string describe_variance_by_kind(const Estimate& estimate) {
    if (estimate.variance_by_kind.empty()) return "";
    return fmt::format(": {} in mm, {} in {}",
                       detail::format_short(estimate.variance_of(false).factor, 4),
                       detail::format_short(estimate.variance_of(true).factor, 4),
                       estimate.fit.orientation_units->error);
}

std::string describe_ending(const Calibration& calibration) {
    const Estimate& estimate = calibration.estimate;
    std::string text = fmt::format("{}: {} after {} iterations", method_name(calibration.method),
                                   ending_name(estimate.ending), estimate.iterations);
    if (estimate.ending != Ending::Converged) text += "; this is not the optimum";
    return text + '\n' + describe_model_error(calibration) +
           fmt::format("variance factor {} with {} degrees of freedom{} ({})\n",
                       detail::format_short(estimate.variance_factor, 4),
                       estimate.degrees_of_freedom, describe_variance_by_kind(estimate),
                       detail::is_model_error_found(calibration)
                           ? "the model error is found from these residuals: 1 says little"
                           : "1: noise and model error stated right");
}

/// A line for each cure that was tried and helps, and one for the others.
std::string describe_tried(const Calibration& calibration) {
    std::string text;
    for (const Cure& cure : calibration.cures.found) {
        text += detail::describe(cure, calibration.campaign) + '\n';
    }
    std::vector<std::string> others;
    std::ranges::transform(calibration.cures.without_effect, std::back_inserter(others), &spell);
    if (others.empty()) return text;
    return text + fmt::format("tried, of little or no use: {}\n",
                              detail::escape_controls(fmt::format("{}", fmt::join(others, ", "))));
}

/// "40 of 247 leave the joint ranges measured (q2, q3): what is expected there is extrapolated".
std::string describe(const std::optional<BeyondMeasured>& beyond, const char* what) {
    if (!beyond) return "";
    return fmt::format(
        "{} of {} {} leave the range measured of {}: what is expected there is extrapolated and "
        "often too small\n",
        beyond->count, detail::count_of(beyond->of, "pose"), what, fmt::join(beyond->joints, ", "));
}

/// Base and targets that the validation was judged with.
std::string format_refitted(const Calibration& calibration) {
    if (!calibration.refitted) return "";
    const std::string unknowns = calibration.refitted->sensor->words().unknowns;
    return format_section(fmt::format("Refitted to the validation (base, {})", unknowns),
                          detail::refitted_table(calibration));
}

std::string describe_noise_floor(const Calibration& calibration) {
    const auto& repeatability = calibration.repeatability;
    if (calibration.campaign.sensor->has_pixels()) return "";
    if (!repeatability) return "noise floor: unknown, no configuration was repeated\n";
    std::string text = fmt::format("noise floor from repeats: {} mm per coordinate",
                                   detail::format_mm(repeatability->length, 5));
    if (calibration.nominal.has_orientation) {
        text += fmt::format(", {} mrad per angle",
                            detail::format_fixed(mrad_per_rad * repeatability->orientation, 5));
    }
    return text + '\n';
}

std::string describe(const ExpectedError& expected, const std::string& where,
                     const AmountUnits& units) {
    return fmt::format("expected {}: {} (parameters {}, left over {}, instrument {})", where,
                       detail::format_error(expected.total(), units),
                       detail::format_error(expected.parameters, units),
                       detail::format_error(expected.model, units),
                       detail::format_error(expected.noise, units));
}

/// What points not used will be off by, so far as the calibration can know.
std::string describe_expected(const Calibration& calibration) {
    const AmountUnits& units = calibration.campaign.sensor->main_units();
    std::string text = describe(calibration.expected, "at poses like these", units) + '\n';
    if (calibration.expected_workspace) {
        text += describe(*calibration.expected_workspace, "over the workspace", units) + '\n';
        if (const auto& place = calibration.expected_place) {
            text += fmt::format(
                "expected over the workspace, in the instrument's frame: {} (parameters {}, left "
                "over {})\n",
                detail::format_error(place->total(), length_units),
                detail::format_error(place->parameters, length_units),
                detail::format_error(place->model, length_units));
        }
        if (const auto& robot = calibration.expected_robot) {
            text += fmt::format(
                "expected over the workspace, of the robot alone (base and {} refitted): {}, "
                "nominal {}{}\n",
                calibration.campaign.sensor->words().place,
                detail::format_error(robot->calibrated, length_units),
                detail::format_error(robot->nominal, length_units),
                robot->calibrated < robot->nominal ? "" : ": nothing is gained");
        }
    } else if (!calibration.campaign.sensor->has_contacts()) {
        text +=
            "expected over the workspace: not known; the joint limits or the cell leave no poses\n";
    }
    const auto add = [&](const std::optional<Judgement>& judged, const char* where) {
        if (judged && judged->expected) {
            text += describe(*judged->expected, where, *judged->units) + '\n';
        }
    };
    add(calibration.verification, "at the verification");
    add(calibration.left_out, "not in plan");
    add(calibration.validation, "at the validation");
    text += detail::describe_judgements(calibration);
    for (const ErrorPrediction& prediction : calibration.predicted) {
        const auto where =
            fmt::format("at the {} to predict",
                        detail::count_of(static_cast<Index>(prediction.each.size()), "pose"));
        text += describe(prediction.overall, where, *prediction.units) + ", 95 % are below " +
                detail::format_error(prediction.overall.percentile95, *prediction.units) + '\n';
    }
    return text + describe(calibration.predicted_beyond, "to predict");
}

std::string format_accuracy(const Calibration& calibration) {
    std::vector<std::pair<std::string, Metrics>> columns{{"nominal", calibration.nominal},
                                                         {"calibrated", calibration.estimate.fit},
                                                         {"means", calibration.estimate.fit_means}};
    if (calibration.held_out) {
        columns.emplace_back("held out", calibration.held_out->samples);
        columns.emplace_back("held-out means", calibration.held_out->means);
    }
    const auto add = [&](const std::optional<Judgement>& judged, const char* name) {
        const bool is_alike = judged && judged->units == &calibration.campaign.sensor->main_units();
        if (is_alike) columns.emplace_back(name, judged->found);
    };
    add(calibration.verification, "verification");
    add(calibration.left_out, "not in plan");
    add(calibration.validation, "validation");
    std::string text = format_section("Accuracy", detail::metrics_table(columns)) + '\n';
    if (!calibration.by_sensor.empty()) {
        text += format_section("Accuracy of each sensor, RMS",
                               detail::sensor_table(calibration.by_sensor)) +
                '\n';
    }
    if (calibration.held_out) {
        text += fmt::format(
            "held out: {} folds, {} of them not identifiable{}\n", calibration.held_out->folds,
            calibration.held_out->failures.size(),
            calibration.expected.is_by_few_poses()
                ? "; each tells much that the others do not, so that they are missed by more than "
                  "other poses will be"
                : "");
    }
    return text + describe_noise_floor(calibration) + describe_expected(calibration) +
           detail::describe_length_factor(calibration.doubts.look);
}

std::string count_outliers(Index count) { return detail::count_of(count, "outlier"); }

std::string format_without_outliers(const WithoutOutliers& others, const AmountUnits& units) {
    const auto one = [&units](double rms, const std::optional<double>& angle) {
        std::string text = detail::format_error(rms, units);
        return angle ? text + " and " + detail::format_error(*angle, true) : text;
    };
    std::string text = "without them: means " + one(others.fit_rms, others.fit_angle_rms);
    if (others.held_out_rms) {
        text += ", held-out means " + one(*others.held_out_rms, others.held_out_angle_rms);
    }
    return text + (others.fit_angle_rms      ? " (RMS of distances and of orientations)\n"
                   : &units != &length_units ? " (RMS)\n"
                                             : " (distance RMS)\n");
}

std::string format_outliers(const Calibration& calibration) {
    const Estimate& estimate = calibration.estimate;
    if (estimate.loss.kind == LossKind::Squares) return "";
    const auto count = static_cast<Index>(estimate.outliers.size());
    std::string text = fmt::format(
        "\nloss {} with width {} standard deviations: {}\n", loss_name(estimate.loss.kind),
        detail::format_short(estimate.loss.width, 4), count_outliers(count));
    if (count == 0) return text;
    if (calibration.without_outliers) {
        text += format_without_outliers(*calibration.without_outliers,
                                        calibration.campaign.sensor->main_units());
    }
    text += format_section("Outliers, farthest first",
                           detail::outlier_table(calibration.campaign, estimate, outliers_shown));
    if (count > outliers_shown) text += fmt::format("... and {} more\n", count - outliers_shown);
    return text;
}

/// All parameters that were identified, or of many errors of the robot their classes beside base
/// and sensor. The classes, too, where their sizes were learned.
std::string format_values(const Calibration& calibration, bool has_all) {
    constexpr Index readable = 50;
    const Campaign& campaign = calibration.campaign;
    const std::string unknowns = campaign.sensor->words().unknowns;
    detail::Table values = detail::parameter_table(campaign, calibration.estimate);
    const Index count = campaign.robot.parameter_count();
    detail::add_sigmas_beside_held(calibration, values);
    if (!calibration.held.empty() && !has_all) {
        std::erase_if(values.rows, [&](const std::vector<std::string>& row) {
            return std::ranges::find(calibration.held, row.front()) != calibration.held.end();
        });
        return format_section(
            fmt::format("Parameters identified ({} are held: --all-parameters, --out)",
                        calibration.held.size()),
            values);
    }
    if (has_all || count <= readable) {
        return (calibration.stated_spread ? format_section("Errors of the robot by class",
                                                           detail::class_table(calibration))
                                          : "") +
               format_section(fmt::format("Parameters (errors of the robot, base, {})", unknowns),
                              values);
    }
    const auto begin = values.rows.begin() + base_parameter_count(campaign);
    values.rows.erase(begin, begin + count);
    return format_section("Errors of the robot by class (each one: --all-parameters, --out)",
                          detail::class_table(calibration)) +
           format_section(fmt::format("Parameters (base, {})", unknowns), values);
}

std::string format_parameters(const Calibration& calibration, bool has_all) {
    const Campaign& campaign = calibration.campaign;
    std::string text = format_values(calibration, has_all);
    const detail::Table sockets = detail::socket_table(campaign, calibration.estimate);
    if (!sockets.rows.empty()) {
        text += format_section("Sockets at a known distance, in the world", sockets);
    }
    const detail::Table compliance = detail::compliance_table(campaign, calibration.estimate);
    if (!compliance.rows.empty()) {
        text += format_section("Compliances", compliance);
    }
    return text +
           format_section("Strongest correlations",
                          detail::correlation_table(calibration.estimate, correlations_shown));
}

}  // namespace

std::string format(const Calibration& calibration, bool has_all_parameters) {
    const std::string models = calibration.selection ? format(*calibration.selection) : "";
    if (!calibration.is_identified()) return models + calibration.estimate.undetermined + '\n';
    return models + describe_starts(calibration) + describe_measured(calibration) +
           describe_ending(calibration) + describe_tried(calibration) +
           format_accuracy(calibration) + format_outliers(calibration) +
           format_refitted(calibration) + format_parameters(calibration, has_all_parameters);
}

std::string format(const ModelSelection& selection) {
    std::string text = "Parameter sets, each holding those above it\n\n" +
                       format_table(detail::model_table(selection)) + '\n';
    for (const ModelTrial& trial : selection.trials) {
        if (!trial.failure.empty()) text += trial.set.name + ": " + trial.failure + '\n';
    }
    text += fmt::format("{} folds over configurations; distances of means", selection.folds);
    if (!selection.not_judged.empty()) {
        text += ", without " + count_outliers(static_cast<Index>(selection.not_judged.size()));
    }
    text += selection.recommended < 0
                ? "; no set could be judged\n"
                : "; recommended: the smallest set within one standard error of the best\n";
    return text + '\n';
}

}  // namespace posewise
