#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

constexpr const char* calibrate_footer = R"(
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
round a joint that the campaign file has reversed (inspect --measurements tells). With --search each
start is the best of a population search of NLopt (crs2, esch, isres) or of covariance matrix adaptation
(cmaes), which takes hundreds of times as long as a random one and rarely finds more.)";

const std::map<std::string, StartSearch> start_searches{{"random", StartSearch::Random},
                                                        {"crs2", StartSearch::Crs2},
                                                        {"esch", StartSearch::Esch},
                                                        {"isres", StartSearch::Isres},
                                                        {"cmaes", StartSearch::CmaEs}};
const std::map<std::string, LossKind> losses{
    {"squares", LossKind::Squares}, {"huber", LossKind::Huber}, {"cauchy", LossKind::Cauchy}};
const std::map<std::string, CalibrationMethod> methods{{"lm", CalibrationMethod::Joint},
                                                       {"two-step", CalibrationMethod::TwoStep},
                                                       {"global", CalibrationMethod::Global}};

struct CalibrateArguments {
    InputPaths paths;
    std::string plan;
    std::string validate;
    std::string out;
    std::string method = "lm";
    std::string search = "random";
    std::string loss = "squares";
    double length_error_percent = 30;
    double angle_error_deg = 20;
    std::optional<Index> iteration_limit;
    std::optional<bool> prior;
    bool has_all_parameters = false;
    CalibrationOptions options;  ///< with the numbers that are options as they are
};

CalibrationOptions make_options(const CalibrateArguments& arguments, std::uint64_t seed) {
    CalibrationOptions options = arguments.options;
    options.method = methods.at(arguments.method);
    options.joint.loss.kind = losses.at(arguments.loss);
    options.global.seed = seed;
    options.global.search = start_searches.at(arguments.search);
    options.global.length_share = arguments.length_error_percent / 100;
    options.global.angle = to_radians(arguments.angle_error_deg);
    for (Index* const limit : {&options.joint.iteration_limit, &options.two_step.iteration_limit,
                               &options.global.start_options.iteration_limit}) {
        *limit = arguments.iteration_limit.value_or(*limit);
    }
    return options;
}

/// The library knows groups, the message the option that asks for them.
void check_folds(const CalibrationOptions& options, Index all) {
    const Index count = options.used.empty() ? all : static_cast<Index>(options.used.size());
    const Index folds = options.folds.value_or(0);
    if (folds == 0 || (folds >= 2 && folds <= count)) return;
    throw InputError(fmt::format(
        "--folds is {}, must be 0 or from 2 to the number of configurations, {}", folds, count));
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
    const bool is_squares = arguments.loss == "squares";
    const bool is_lm = arguments.method == "lm";
    require(is_squares || is_lm, "--loss", "needs --method lm; the others know squares only");
    require(!is_squares || options.joint.loss.width == 0, "--loss-width",
            "needs --loss huber or cauchy");
    if (!options.model_selection) return;
    require(is_lm, "--model-selection", "needs --method lm");
    require(options.folds != 0, "--model-selection", "needs --folds of 2 or more");
}

void calibrate(const CalibrateArguments& arguments) {
    const InputPaths& paths = arguments.paths;
    check_outputs({paths.campaign, paths.measurements, arguments.plan, arguments.validate},
                  {arguments.out});
    const io::CampaignFile file = read_with_prior(paths.campaign, arguments.prior);
    const Measurements measured = read_measured(paths.measurements, file);
    CalibrationOptions options = make_options(arguments, file.seed);
    if (!arguments.plan.empty()) options.used = find_planned(measured, arguments.plan);
    std::optional<Measurements> validation;
    if (!arguments.validate.empty()) validation = read_measured(arguments.validate, file);
    options.validation = validation ? &*validation : nullptr;
    const Calibration result = compute_from(paths.measurements, [&] {
        check_folds(options, measured.configuration_count());
        return posewise::calibrate(file, measured, options);
    });
    if (!result.is_identified()) {
        if (result.selection) print(format(*result.selection));
        throw input_error_at({paths.measurements}, result.estimate.undetermined);
    }
    if (!arguments.out.empty()) io::write_estimate(arguments.out, result, paths.measurements);
    std::ranges::for_each(describe_doubts(result, paths.measurements), print_warning);
    print(format(result, arguments.has_all_parameters));
}

void add_calibrate_options(CLI::App& command, CalibrateArguments& arguments) {
    CalibrationOptions& options = arguments.options;
    command.add_option("--plan", arguments.plan, "Use only the configurations of this plan file")
        ->check(file_name());
    command.add_option("--method", arguments.method, "lm, two-step or global")
        ->check(CLI::IsMember({"lm", "two-step", "global"}))
        ->capture_default_str();
    command
        .add_option("--alpha", options.two_step.alpha, "two-step: part of each robot step taken")
        ->check(real_number(1e-6, 1.0))
        ->capture_default_str();
    command
        .add_option("--max-iterations", arguments.iteration_limit,
                    "Most iterations (default: lm and each start of global 100, two-step 200)")
        ->check(whole_number(1, 1000000));
    command
        .add_option("--length-error-percent", arguments.length_error_percent,
                    "global: by how much a length may be off (50 mm at least)")
        ->check(real_number(0, 100))
        ->capture_default_str();
    command
        .add_option("--angle-error-deg", arguments.angle_error_deg,
                    "global: by how much an angle may be off")
        ->check(real_number(0, 180))
        ->capture_default_str();
    command
        .add_option("--search", arguments.search,
                    "global: starts are random, or the best of a population search: crs2, esch, "
                    "isres or cmaes")
        ->check(CLI::IsMember({"random", "crs2", "esch", "isres", "cmaes"}))
        ->capture_default_str();
    command.add_option("--starts", options.global.start_limit, "global: most starts")
        ->check(whole_number(1, 1000000))
        ->capture_default_str();
    command
        .add_option("--validate", arguments.validate,
                    "Second measurement file, to judge the result on")
        ->check(file_name());
    command
        .add_option("--folds", options.folds,
                    "Groups to hold out in turn; 0: none (default: every configuration by "
                    "itself up to 100 of them, else 10)")
        ->check(whole_number(0, 1000000));
    command.add_option("--loss", arguments.loss, "squares, huber or cauchy: robust to outliers")
        ->check(CLI::IsMember({"squares", "huber", "cauchy"}))
        ->capture_default_str();
    command
        .add_option("--loss-width", options.joint.loss.width,
                    "Where the loss leaves squares, in robust standard deviations (default: 95 % "
                    "efficiency; three coordinates a target: huber 1.63, cauchy 2.67)")
        ->check(real_number(0.1, 1e6));
    command.add_flag("--model-selection", options.model_selection,
                     "Compare nested parameter sets by their held-out error");
    add_prior_option(command, arguments.prior, ": fewer poses than parameters will do");
    command.add_flag("--learn-sizes", options.learns_sizes,
                     "Learn how large the errors of each class are, instead of the expected sizes");
    command.add_flag("--all-parameters", arguments.has_all_parameters, "List each, however many");
    command.add_option("-o,--out", arguments.out, "Write everything as JSON to this file")
        ->check(file_name());
}

}  // namespace

void add_calibrate(CLI::App& program) {
    const auto arguments = std::make_shared<CalibrateArguments>();
    CLI::App* command =
        program.add_subcommand("calibrate", "Identify the robot's errors from measurements");
    add_campaign_argument(*command, arguments->paths);
    add_measurements_option(*command, arguments->paths);
    add_calibrate_options(*command, *arguments);
    command->footer(calibrate_footer);
    command->callback([arguments, command] {
        check_calibrate_usage(*command, *arguments);
        calibrate(*arguments);
    });
}

}  // namespace posewise::cli
