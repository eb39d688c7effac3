#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "calibrate_report.hpp"
#include "calibrator/loss.hpp"
#include "commands.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/report/reports.hpp"
#include "report/plot.hpp"
#include "task/calibration/calibration_options.hpp"
#include "validation.hpp"

namespace posewise::cli {
namespace {

constexpr const char* calibrate_footer = R"(
Example:
  posewise calibrate campaign.yaml -m measurements.csv --out estimate.json --report page.html
  posewise calibrate campaign.yaml -m points.txt --points-unit mm --plan plan.json
  posewise calibrate campaign.yaml -m old.txt --plan old.json -m new.txt --plan new.json

Finds base and targets (or tool; of sockets ball and sockets: they need a column socket instead of
readings) from nothing, then identifies all parameters together, and prints
  - the error left, in mm: nominal (only base and targets fitted), calibrated (all samples), means
    (of each configuration's samples), held out (each configuration predicted by a calibration
    without it: with few poses more than others will be missed by);
  - what to expect of poses like those measured, and over the workspace (within the limits and the
    cell), by the parameters, by what the model leaves over and by the instrument;
  - the noise floor, from the repeats: no calibration gets below it;
  - every parameter with its standard deviation, the base as position and rotation vector;
  - the strongest correlations: what these poses can hardly tell apart.
What did not converge, has errors fifty times their expected size or a joint offset beyond 10 deg,
leaves more over than a robot misses before it is calibrated, is spoilt by one configuration, or
predicts poses that were held out worse than the nominal robot does, is printed and not written, with
exit code 3; --force writes it, marked. Where something is doubtful, robust losses, --exclude,
richer errors and intrinsics found anew are tried; those that help are named with the error held out.
With a prior the calibration learns how large the errors of each class are. It starts from the
expected sizes; few poses move them a little, many freely. It prints both; --sizes stated keeps the
expected ones, as is usual where corners in pixels are measured.
With --exclude it leaves out configurations by their ids and samples (7:2), and the estimate records it.
-m takes an instrument's list of points, too (name x y z, as SpatialAnalyzer or PolyWorks write it): with
--plan they get the joint values of the plan's poses by their names (P001_T1: target 1 at pose p1), in
any order; some may be missing. posewise help measurements says what is read.
Several -m, each with the --plan at its place, are calibrated together; p1 of old.json is then old/p1.
With --plan the calibration sees only the plan's configurations. It is judged on those that the plan
has to verify (plan --verification), as far as they were measured, and on the others, each by itself.
Where it is judged, and on those of --validate, poses are told apart: new ones, ones beyond the joint
ranges calibrated with, and ones calibrated with, which say nothing about others. Each group has its
RMS and where that of all such poses is with 95 % (chi-squared; by configurations, since samples of
one share its error, and its targets as far as their residuals are alike). --limit-mm 0.2 says of each pass, fail or undecided: whether that
whole interval is at or below the limit, or above it. The exit code is 0 in any case.
With --predict it says what to expect at configurations that need not be measured, as one reading
there would find it: RMS, 95 %, and each one's in --predict-out (config,parameters_mm,left_over_mm,
noise_mm,total_mm,p95_mm; orientations likewise in mrad). Each row is one, the same pose as often as
it stands there; of a file with a column sample each configuration.
With --from it starts at an earlier estimate. --only base,targets identifies nothing else: where is the
robot now that the instrument was moved? --as-prior takes what was known then as prior, so that a few
new poses say what has changed. --validate NEW.csv --refit base,targets: is the calibration still good
there? --validate-campaign states what NEW.csv was measured with, if that was another instrument.
With --loss huber or cauchy a target seen wrongly counts less (cauchy: hardly at all) and is listed:
if its mean is farther off than 4.95 robust standard deviations (three coordinates), which come from
the residuals' median, whatever sigma is stated. sqrt(variance factor) is their ratio to the stated.
--model-selection calibrates and holds out base and targets alone, then with joint offsets, lengths,
other geometric errors, gravity terms, free terms and harmonics, as far as the campaign has them, and
recommends the smallest set within one standard error of the best. The calibration that follows is
that of the whole campaign; state the recommended set in the campaign file to have it.
The method two-step is that of Wu et al. 2015; it heads to the same optimum, slowly, and the output
says whether it got there. The method global is for a nominal robot that is far off (lengths by
--length-error-percent, angles by --angle-error-deg): lm from the nominal robot and from random
ones, until three starts agree on the best. Errors of 20 deg and 30 % rarely need it; it cannot turn
round a joint that the campaign file has reversed (inspect --measurements tells). With --search
cmaes each start is the best that covariance matrix adaptation finds, which takes hundreds of times as
long as a random one and rarely finds more.)";

CalibrationOptions make_options(const CalibrateArguments& arguments, std::uint64_t seed) {
    CalibrationOptions options = arguments.options;
    options.method = detail::find_named(detail::method_names, arguments.method).value();
    options.joint.loss.kind = detail::find_named(detail::loss_names, arguments.loss).value();
    options.global.seed = seed;
    options.global.search = arguments.search == "cmaes" ? StartSearch::CmaEs : StartSearch::Random;
    options.global.length_share = arguments.length_error_percent / 100;
    options.global.angle = to_radians(arguments.angle_error_deg);
    if (arguments.limit_mm) options.limit = *arguments.limit_mm / mm_per_m;
    for (Index* const limit : {&options.joint.iteration_limit, &options.two_step.iteration_limit,
                               &options.global.start_options.iteration_limit}) {
        *limit = arguments.iteration_limit.value_or(*limit);
    }
    return options;
}

/// Options of one method beside another would have no effect.
void check_calibrate_usage(const CLI::App& command, const CalibrateArguments& arguments) {
    const auto require = [](bool is_right, const char* option, const std::string& rule) {
        if (!is_right) throw CLI::ValidationError(option, rule);
    };
    for (const char* const option :
         {"--alpha", "--length-error-percent", "--angle-error-deg", "--search", "--starts"}) {
        const std::string owner = std::string(option) == "--alpha" ? "two-step" : "global";
        require(arguments.method == owner || command.count(option) == 0, option,
                "needs --method " + owner);
    }
    const CalibrationOptions& options = arguments.options;
    require(arguments.free.empty() || arguments.earlier.from.empty(), "--free",
            "excludes --from; beside an estimate --only says what is identified anew");
    const bool is_squares = arguments.loss == "squares";
    const bool is_lm = arguments.method == "lm";
    require(is_squares || is_lm, "--loss", "needs --method lm; the others know squares only");
    require(arguments.earlier.from.empty() || (is_lm && !options.model_selection), "--from",
            "needs --method lm, without --model-selection");
    require(arguments.sizes != "learned" || is_lm, "--sizes", "learned needs --method lm");
    require(arguments.sizes != "learned" || arguments.prior.value_or(true), "--sizes",
            "learned needs priors; leave --no-prior out");
    require(arguments.sizes != "learned" || is_squares, "--sizes", "learned needs --loss squares");
    require(!is_squares || options.joint.loss.width == 0, "--loss-width",
            "needs --loss huber or cauchy");
    if (!options.model_selection) return;
    require(is_lm, "--model-selection", "needs --method lm");
    require(options.folds != 0, "--model-selection", "needs --folds of 2 or more");
}

/// With faults it is printed, but not written.
void check_faults(const CalibrateArguments& arguments, const CommonOptions& common,
                  const Calibration& result, const Printed& printed) {
    const std::string words = std::string(no_calibration) + join_some(result.faults);
    if (arguments.earlier.is_forced) return print_warning(words);
    print(printed, common);
    throw NoCalibration(fmt::format(
        "{}: {}; {}--force takes it all the same", arguments.paths.measurements, words,
        (arguments.out + arguments.predict_out + arguments.csv + arguments.page + arguments.plot)
                .empty()
            ? ""
            : "nothing was written, "));
}

/// What is wrong names the file that it is in.
Calibration calibrate_files(const CalibrateArguments& arguments, const io::CampaignFile& file,
                            const Measurements& measured, const CalibrationOptions& options) {
    try {
        return posewise::calibrate(file, measured, options);
    } catch (const ValidationError& error) {
        throw input_error_at({arguments.validate}, error.what());
    } catch (const InputError& error) {
        throw input_error_at({arguments.paths.measurements}, error.what());
    }
}

io::CampaignFile read_calibrated(const CalibrateArguments& arguments) {
    io::CampaignFile file = read_with_prior(arguments.paths.campaign, arguments.prior);
    if (!arguments.sizes.empty()) file.spread.is_open = arguments.sizes == "learned";
    if (arguments.free.empty()) return file;
    try {
        static_cast<Campaign&>(file) = with_free_errors(file, arguments.free);
    } catch (const InputError& error) {
        throw CLI::ValidationError("--free", error.what());
    }
    return file;
}

void calibrate(const CalibrateArguments& arguments, const CLI::App& command,
               const CommonOptions& common) {
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    const InputPaths& paths = arguments.paths;
    const EarlierArguments& earlier = arguments.earlier;
    const io::CampaignFile file = read_calibrated(arguments);
    const MeasuredPlans plans = read_measured_plans(paths, file);
    const std::optional<Plan>& plan = plans.all;
    const Validation validation = read_validation(
        arguments, file, paths.parts.empty() ? points_of(paths, plan) : io::PointsSource{});
    std::vector<std::string> inputs = files_of(paths);
    inputs.insert(inputs.end(), {arguments.validate, arguments.predict, earlier.from});
    check_outputs(
        {&file, validation.campaign ? &*validation.campaign : nullptr}, inputs,
        {arguments.out, arguments.predict_out, arguments.csv, arguments.page, arguments.plot},
        common);
    CalibrationOptions options = make_options(arguments, file.seed);
    const io::MeasurementsFile measured =
        read_measured_without(options.excluded, paths, file, earlier, plans);
    check_needs_unit(paths, measured.is_joined || validation.is_joined);
    options.conditions = measured.conditions;
    io::Provenance made_from = provenance_of(command, file, paths.measurements, measured);
    if (!earlier.from.empty()) {
        options.earlier = read_usable_earlier(earlier.from, file, earlier.use(), earlier.is_forced);
    }
    if (plan) use_plan(paths.plan, *plan, file, measured, options);
    warn_of_no_validation(arguments, validation, made_from);
    options.validation = validation.measured ? &*validation.measured : nullptr;
    options.validation_campaign = validation.campaign ? &*validation.campaign : nullptr;
    check_limit(arguments, file, measured, options);
    options.richer = [&] { return io::richer_campaigns(file, arguments.prior); };
    io::Configurations predicted;
    if (!arguments.predict.empty()) predicted = read_unlimited(arguments.predict, file);
    options.predicted = predicted.joints;
    const Calibration result = calibrate_files(arguments, file, measured, options);
    if (!result.is_identified()) {
        if (result.selection && !common.json) print(format(*result.selection));
        throw input_error_at({paths.measurements}, result.estimate.undetermined);
    }
    std::ranges::for_each(describe_doubts(result, paths.measurements), print_warning);
    made_from.answers = answer(result);
    const Printed printed = describe_calibration(arguments, result, made_from);
    if (!result.faults.empty()) check_faults(arguments, common, result, printed);
    io::PagePart part;
    if (!arguments.page.empty()) {
        const Measurements& all = measured;
        const Measurements used = options.used.empty() ? all : take(all, options.used);
        part = show_estimate(result.campaign, result.estimate, &used);
    }
    made_from.warnings = given_warnings();
    if (!arguments.out.empty()) io::write_estimate(arguments.out, result, made_from);
    if (!arguments.csv.empty()) {
        io::write_offsets_csv(arguments.csv, result.campaign, result.estimate, file.controller);
    }
    if (!arguments.predict_out.empty()) {
        io::write_predictions_csv(arguments.predict_out, predicted.ids, result.predicted);
    }
    print(printed, common);
    show_calibration(arguments, common, result, measured, options, std::move(part), printed);
}

}  // namespace

void add_calibrate(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<CalibrateArguments>();
    CLI::App* command =
        program.add_subcommand("calibrate", "Identify the robot's errors from measurements");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_calibrate_options(*command, *arguments);
    for (const char* const option : {"--measurements", "--plan"}) {  // see pair_with_plans()
        command->get_option(option)->multi_option_policy(CLI::MultiOptionPolicy::TakeFirst);
    }
    command->footer(calibrate_footer);
    command->callback([arguments, command, &common] {
        check_calibrate_usage(*command, *arguments);
        arguments->paths =
            pair_with_plans(arguments->paths, command->get_option("--measurements")->results(),
                            command->get_option("--plan")->results());
        calibrate(*arguments, *command, common);
    });
}

}  // namespace posewise::cli
