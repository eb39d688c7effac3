#include "calibration_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common.hpp"
#include "measured.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/units.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/report/calibration_tables.hpp"
#include "suspicions.hpp"

namespace posewise::cli {
namespace {

constexpr Index correlations_shown = 5;
constexpr Index outliers_shown = 20;

std::string describe_ending(const std::string& method, const Estimate& estimate) {
    std::string text = fmt::format("{}: {} after {} iterations", method,
                                   ending_name(estimate.ending), estimate.iterations);
    if (estimate.ending != Ending::Converged) text += "; this is not the optimum";
    return text + fmt::format(
                      "\nvariance factor {} with {} degrees of freedom (1: noise and model "
                      "error stated right)\n",
                      format_short(estimate.variance_factor, 4), estimate.degrees_of_freedom);
}

/// A sentence if the residuals are clearly not as large as stated: more than 1.5 times larger or
/// smaller, and by more than four standard deviations of the variance factor.
std::string judge_residuals(const Estimate& estimate) {
    constexpr double tolerated = 1.5;
    if (estimate.degrees_of_freedom <= 0) return "";
    const double factor = std::sqrt(estimate.variance_factor);
    const double chance = 4 * std::sqrt(2 / static_cast<double>(estimate.degrees_of_freedom));
    if (std::abs(estimate.variance_factor - 1) <= chance) return "";
    const std::string text = fmt::format(
        "the residuals are {} times what sigma and model error say: ", format_short(factor, 2));
    if (factor > tolerated) {
        return text +
               (estimate.loss.kind == LossKind::Squares
                    ? "state a larger model_error_mm, add error terms (gravity, harmonics) or look "
                      "for outliers with --loss\n"
                    : "state a larger model_error_mm or add error terms (gravity, harmonics)\n");
    }
    return factor < 1 / tolerated ? text + "a smaller model_error_mm or sigma would do\n" : "";
}

/// A sentence if compliances are clearly negative; else empty.
std::string judge_compliances(const Campaign& campaign, const Estimate& estimate) {
    constexpr double significant = 3;  // standard deviations
    const VectorXd sigmas = standard_deviations(estimate);
    const Index robot_begin = base_parameter_count(campaign);
    std::string names;
    for (const Compliance& compliance : compliances(campaign.robot)) {
        const Index k = compliance.parameter;
        if (estimate.parameters.robot[k] > -significant * sigmas[robot_begin + k]) continue;
        names += (names.empty() ? "" : ", ") +
                 campaign.robot.joints()[static_cast<std::size_t>(compliance.joint)].name;
    }
    if (names.empty()) return "";
    return '\n' + names +
           ": negative, but a joint gives way with its load; is tau the torque of the load (a "
           "motor's has the other sign), are weights, places and direction of gravity right?\n";
}

std::string describe_noise_floor(const io::CalibrationReport& report) {
    if (!report.repeatability) return "noise floor: unknown, no configuration was repeated\n";
    std::string text = fmt::format("noise floor from repeats: {} mm per coordinate",
                                   format_mm(report.repeatability->length, 5));
    if (report.nominal.has_orientation) {
        text += fmt::format(", {} mrad per angle",
                            format_fixed(mrad_per_rad * report.repeatability->orientation, 5));
    }
    return text + '\n';
}

void print_accuracy(const io::CalibrationReport& report) {
    std::vector<std::pair<std::string, Metrics>> columns{{"nominal", report.nominal},
                                                         {"calibrated", report.estimate.fit},
                                                         {"means", report.estimate.fit_means}};
    if (report.held_out) {
        columns.emplace_back("held out", report.held_out->samples);
        columns.emplace_back("held-out means", report.held_out->means);
    }
    if (report.left_out) columns.emplace_back("not in plan", *report.left_out);
    if (report.validation) columns.emplace_back("validation", *report.validation);
    print_section("Accuracy", metrics_table(columns));
    print("\n");
    if (report.held_out) {
        print(fmt::format("held out: {} folds, {} of them not identifiable\n",
                          report.held_out->folds, report.held_out->failures.size()));
    }
    print(describe_noise_floor(report));
}

void print_outliers(const io::CalibrationReport& report) {
    const Estimate& estimate = report.estimate;
    if (estimate.loss.kind == LossKind::Squares) return;
    const auto count = static_cast<Index>(estimate.outliers.size());
    print(fmt::format("\nloss {} with width {} standard deviations: {} outliers\n",
                      loss_name(estimate.loss.kind), format_short(estimate.loss.width, 4), count));
    if (count == 0) return;
    if (report.without_outliers) {
        print(
            fmt::format("without them: means {} mm", format_mm(report.without_outliers->fit_rms)));
        if (const auto held_out = report.without_outliers->held_out_rms) {
            print(fmt::format(", held-out means {} mm", format_mm(*held_out)));
        }
        print(" (distance RMS)\n");
    }
    print_section("Outliers, farthest first", outlier_table(estimate, outliers_shown));
    if (count > outliers_shown) {
        print(fmt::format("... and {} more\n", count - outliers_shown));
    }
}

/// A robot's maker is rarely wrong by 10 cm.
void warn_about_outliers(const std::string& path, const std::string& readings,
                         const Metrics& nominal) {
    constexpr double suspicious = 0.1;  // m
    if (nominal.distance_rms <= suspicious) return;
    print_warning(
        fmt::format("{}: the nominal robot misses the {} by {} m (RMS); if some are grossly wrong, "
                    "try --loss cauchy",
                    path, readings, format_short(nominal.distance_rms, 3)));
}

/// Nor does it miss orientations by 5 deg, unless they are read in another order.
void warn_about_orientation(const std::string& path, const Campaign& campaign,
                            const Measurements& used, const Metrics& nominal) {
    constexpr double suspicious = 0.1;  // rad
    if (nominal.orientation_rms <= suspicious) return;
    const std::string suspicion = suspect_orientations(campaign, used, suspicious);
    print_warning(fmt::format(
        "{}: the nominal robot misses the orientations by {} deg (RMS){}", path,
        format_short(to_degrees(nominal.orientation_rms), 3),
        suspicion.empty() ? "; is qw the real part of the quaternion, are roll, pitch and yaw "
                            "about the fixed axes x, y and z?"
                          : suspicion));
}

/// A joint with a wrong sign may converge as well, with an offset of half a turn.
void warn_about_sizes(const Campaign& campaign, const Estimate& estimate) {
    constexpr double suspicious = 20;  // times the expected size
    const VectorXd& errors = estimate.parameters.robot;
    const Index robot_begin = base_parameter_count(campaign);
    const VectorXd times =
        errors.cwiseQuotient(parameter_scale(campaign).segment(robot_begin, errors.size()))
            .cwiseAbs();
    std::string words;
    for (Index k = 0; k < times.size(); ++k) {
        if (times[k] <= suspicious) continue;
        words += fmt::format("{}{} ({} times)", words.empty() ? "" : ", ",
                             estimate.names[static_cast<std::size_t>(robot_begin + k)],
                             format_short(times[k], 3));
    }
    if (words.empty()) return;
    print_warning(fmt::format(
        "far above the expected size: {}; are sign, unit and nominal value in the campaign right, "
        "and do the poses tell them apart? If so, state their size in spread",
        words));
}

}  // namespace

void print_model_selection(const ModelSelection& selection) {
    print("Parameter sets, each holding those above it\n\n" + format_table(model_table(selection)));
    print("\n");
    for (const ModelTrial& trial : selection.trials) {
        if (!trial.failure.empty()) print(trial.set.name + ": " + trial.failure + '\n');
    }
    print(fmt::format("{} folds over configurations; distances of means", selection.folds));
    if (!selection.not_judged.empty()) {
        print(fmt::format(", without {} outliers", selection.not_judged.size()));
    }
    print(selection.recommended < 0
              ? "; no set could be judged\n"
              : "; recommended: the smallest set within one standard error of the best\n");
    print("\n");
}

void warn_about_calibration(const std::string& measurements_path, const Campaign& campaign,
                            const Measurements& used, const io::CalibrationReport& report) {
    // No error: a calibration may be just for a robot that is far from nominal.
    const std::string misfit = describe_misfit(campaign, used);
    if (!misfit.empty()) print_warning(measurements_path + ": " + misfit);
    const std::string planes = misfit.empty() ? suspect_planes(campaign, used) : "";
    if (!planes.empty()) print_warning(measurements_path + ": " + planes);
    warn_about_outliers(measurements_path, campaign.sensor->words().readings, report.nominal);
    warn_about_orientation(measurements_path, campaign, used, report.nominal);
    warn_about_sizes(campaign, report.estimate);
}

void print_calibration(const Campaign& campaign, const Measurements& used,
                       const io::CalibrationReport& report) {
    print(fmt::format("{}: {} configurations, {} samples, {} parameters\n", campaign.name,
                      used.configuration_count(), used.observations.rows(),
                      parameter_count(campaign)));
    if (!used.is_seen.all()) {
        print(fmt::format("{} of {} {} are missing: targets that were not seen\n",
                          used.is_seen.size() - used.is_seen.count(), used.is_seen.size(),
                          campaign.sensor->words().readings));
    }
    print(describe_ending(report.method, report.estimate) + judge_residuals(report.estimate));
    print_accuracy(report);
    print_outliers(report);
    print_section(fmt::format("Parameters (errors of the robot, base, {})",
                              campaign.sensor->words().unknowns),
                  parameter_table(campaign, report.estimate));
    const Table compliance = compliance_table(campaign, report.estimate);
    if (!compliance.rows.empty()) {
        print_section("Compliances", compliance);
        print(judge_compliances(campaign, report.estimate));
    }
    print_section("Strongest correlations", correlation_table(report.estimate, correlations_shown));
}

}  // namespace posewise::cli
