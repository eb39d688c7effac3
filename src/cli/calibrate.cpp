#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "options.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/text.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/report/calibration_tables.hpp"
#include "posewise/report/units.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise calibrate campaign.yaml -m measurements.csv --out estimate.json

Finds base and targets from nothing, then identifies all parameters together, and prints
  - the error left, in mm: nominal (only base and targets fitted), calibrated (all samples), means
    (of each configuration's samples), held out (each configuration predicted by a calibration
    without it: what to expect at poses that were not measured);
  - the noise floor, from the repeats: no calibration gets below it;
  - every parameter with its standard deviation, the base as position and rotation vector;
  - the strongest correlations: what these poses can hardly tell apart.
With --plan the calibration sees only the plan's configurations and is judged on the others too.
The method two-step is that of Wu et al. 2015; it heads to the same optimum, slowly, and the output
says whether it got there.)";

constexpr Index leave_one_out_limit = 100;
constexpr Index default_folds = 10;
constexpr Index correlations_shown = 5;

struct Arguments {
    InputPaths paths;
    std::string plan;
    std::string method = "lm";
    TwoStepOptions two_step;
    std::optional<Index> iteration_limit;
    std::string validate;
    std::optional<Index> folds;
    std::optional<bool> prior;
    std::string out;
};

/// The measured configurations, split by the plan if there is one.
struct Split {
    Measurements used;
    std::optional<Measurements> left_out;
};

Split read_split(const Arguments& arguments, const io::CampaignFile& file) {
    auto all = io::read_measurements(arguments.paths.measurements, file);
    if (arguments.plan.empty()) return {std::move(all), std::nullopt};
    const auto planned = find_planned(all, arguments.plan);
    const auto others = all_but(all.configuration_count(), planned);
    Split split{take(all, planned), std::nullopt};
    if (!others.empty()) split.left_out = take(all, others);
    return split;
}

Estimate identify_by_method(const Arguments& arguments, const Campaign& campaign,
                            const Measurements& measurements, const Parameters& start) {
    if (arguments.method == "two-step") {
        TwoStepOptions options = arguments.two_step;
        options.iteration_limit = arguments.iteration_limit.value_or(options.iteration_limit);
        return identify_two_step(campaign, measurements, start, options);
    }
    LevenbergMarquardtOptions options;
    options.iteration_limit = arguments.iteration_limit.value_or(options.iteration_limit);
    return identify(campaign, measurements, start, options);
}

/// Base and targets fitted, the robot as its maker says.
Metrics fit_nominal(const Campaign& campaign, const Measurements& measurements) {
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    return identify(nominal, measurements, register_base_and_targets(nominal, measurements)).fit;
}

std::optional<CrossValidation> hold_out(const Arguments& arguments, const Campaign& campaign,
                                        const Measurements& measurements, const Parameters& start) {
    const Index count = measurements.configuration_count();
    const Index folds =
        arguments.folds.value_or(count <= leave_one_out_limit ? count : default_folds);
    if (folds == 0) return std::nullopt;
    if (folds < 2 || folds > count) {
        throw InputError(
            fmt::format("--folds is {}, must be 0 or from 2 to the number of configurations, {}",
                        folds, count));
    }
    return cross_validate(campaign, measurements, start, folds);
}

std::string describe_ending(const Arguments& arguments, const Estimate& estimate) {
    std::string text = fmt::format("{}: {} after {} iterations", arguments.method,
                                   ending_name(estimate.ending), estimate.iterations);
    if (estimate.ending != Ending::Converged) text += "; this is not the optimum";
    return text + fmt::format(
                      "\nvariance factor {} with {} degrees of freedom (1: noise and model "
                      "error stated right)\n",
                      format_short(estimate.variance_factor, 4), estimate.degrees_of_freedom);
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

Metrics metrics_of(const Campaign& campaign, const Measurements& measurements,
                   const Estimate& estimate) {
    return make_metrics(residuals(campaign, estimate.parameters, measurements));
}

/// All but what needs another file.
io::CalibrationReport make_report(const Arguments& arguments, const Campaign& campaign,
                                  const Split& split) {
    const Measurements& used = split.used;
    const Parameters start = register_base_and_targets(campaign, used);
    io::CalibrationReport report;
    report.method = arguments.method;
    report.measurements = arguments.paths.measurements;
    report.estimate = identify_by_method(arguments, campaign, used, start);
    report.nominal = fit_nominal(campaign, used);
    report.repeatability = repeatability(*campaign.sensor, used);
    report.held_out = hold_out(arguments, campaign, used, start);
    if (split.left_out) {
        report.left_out = metrics_of(campaign, *split.left_out, report.estimate);
    }
    return report;
}

/// A robot's maker is rarely wrong by 10 cm, a column's unit easily by a factor of 1000.
void warn_about_units(const std::string& path, const Metrics& nominal) {
    constexpr double suspicious = 0.1;  // m
    if (nominal.distance_rms <= suspicious) return;
    const std::string warning = fmt::format(
        "posewise: warning: {}: the nominal robot misses the points by {} m (RMS); are the units "
        "of the columns right?\n",
        escape_controls(path), format_short(nominal.distance_rms, 3));
    std::fwrite(warning.data(), 1, warning.size(), stderr);
}

/// Nor does it miss orientations by 10 deg, unless they are read in another order.
void warn_about_orientation(const std::string& path, const Metrics& nominal) {
    constexpr double suspicious = 0.2;  // rad
    if (nominal.orientation_rms <= suspicious) return;
    const std::string warning = fmt::format(
        "posewise: warning: {}: the nominal robot misses the orientations by {} deg (RMS); is qw "
        "the real part of the quaternion, are roll, pitch and yaw about the fixed axes x, y and "
        "z?\n",
        escape_controls(path), format_short(to_degrees(nominal.orientation_rms), 3));
    std::fwrite(warning.data(), 1, warning.size(), stderr);
}

void print_report(const Arguments& arguments, const Campaign& campaign, const Measurements& used,
                  const io::CalibrationReport& report) {
    print(fmt::format("{}: {} configurations, {} samples, {} parameters\n", campaign.name,
                      used.configuration_count(), used.observations.rows(),
                      parameter_count(campaign)));
    if (!used.is_seen.all()) {
        print(fmt::format("{} of {} points are missing: targets that were not seen\n",
                          used.is_seen.size() - used.is_seen.count(), used.is_seen.size()));
    }
    print(describe_ending(arguments, report.estimate));
    print_accuracy(report);
    print_section("Parameters (errors of the robot, base, targets in the flange frame)",
                  parameter_table(campaign, report.estimate));
    print_section("Strongest correlations", correlation_table(report.estimate, correlations_shown));
}

void calibrate(const Arguments& arguments) {
    const InputPaths& paths = arguments.paths;
    check_outputs({paths.campaign, paths.measurements, arguments.plan, arguments.validate},
                  {arguments.out});
    auto file = io::read_campaign(paths.campaign);
    bool& is_prior = file.campaign.spread.is_prior;
    is_prior = arguments.prior.value_or(is_prior);
    const Split split = read_split(arguments, file);
    io::CalibrationReport report = compute_from(
        paths.measurements, [&] { return make_report(arguments, file.campaign, split); });
    if (!arguments.validate.empty()) {
        report.validation = metrics_of(
            file.campaign, io::read_measurements(arguments.validate, file), report.estimate);
    }
    if (!arguments.out.empty()) io::write_estimate(arguments.out, file.campaign, report);
    warn_about_units(paths.measurements, report.nominal);
    warn_about_orientation(paths.measurements, report.nominal);
    print_report(arguments, file.campaign, split.used, report);
}
void add_options(CLI::App& command, Arguments& arguments) {
    command.add_option("--plan", arguments.plan, "Use only the configurations of this plan file")
        ->check(file_name());
    command.add_option("--method", arguments.method, "lm or two-step")
        ->check(CLI::IsMember({"lm", "two-step"}))
        ->capture_default_str();
    command
        .add_option("--alpha", arguments.two_step.alpha, "two-step: part of each robot step taken")
        ->check(real_number(1e-6, 1.0))
        ->capture_default_str();
    command
        .add_option("--max-iterations", arguments.iteration_limit,
                    "Most iterations (default: lm 100, two-step 200)")
        ->check(whole_number(1, 1000000));
    command
        .add_option("--validate", arguments.validate,
                    "Second measurement file, to judge the result on")
        ->check(file_name());
    command
        .add_option("--folds", arguments.folds,
                    "Groups to hold out in turn; 0: none (default: every configuration by "
                    "itself up to 100 of them, else 10)")
        ->check(whole_number(0, 1000000));
    add_prior_option(command, arguments.prior, ": fewer poses than parameters will do");
    command.add_option("-o,--out", arguments.out, "Write everything as JSON to this file")
        ->check(file_name());
}

}  // namespace

void add_calibrate(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("calibrate", "Identify the robot's errors from measurements");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_options(*command, *arguments);
    command->footer(footer);
    command->callback([arguments] { calibrate(*arguments); });
}

}  // namespace posewise::cli
