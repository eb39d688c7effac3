#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "calibration_report.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/calibrator/global_identification.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/estimate_file.hpp"

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

constexpr Index leave_one_out_limit = 100;
constexpr Index default_folds = 10;

const std::map<std::string, StartSearch> start_searches{{"random", StartSearch::Random},
                                                        {"crs2", StartSearch::Crs2},
                                                        {"esch", StartSearch::Esch},
                                                        {"isres", StartSearch::Isres},
                                                        {"cmaes", StartSearch::CmaEs}};

struct Arguments {
    InputPaths paths;
    std::string plan;
    std::string method = "lm";
    TwoStepOptions two_step;
    std::optional<Index> iteration_limit;
    GlobalOptions global;
    std::string search = "random";
    double length_error_percent = 30;
    double angle_error_deg = 20;
    std::string validate;
    std::optional<Index> folds;
    std::optional<bool> prior;
    std::string loss = "squares";
    double loss_width = 0;
    bool model_selection = false;
    std::string out;
};

/// The measured configurations, split by the plan if there is one.
struct Split {
    Measurements used;
    std::optional<Measurements> left_out;
};

Split read_split(const Arguments& arguments, const io::CampaignFile& file) {
    auto all = read_measured(arguments.paths.measurements, file);
    if (arguments.plan.empty()) return {std::move(all), std::nullopt};
    const auto planned = find_planned(all, arguments.plan);
    const auto others = all_but(all.configuration_count(), planned);
    Split split{take(all, planned), std::nullopt};
    if (!others.empty()) split.left_out = take(all, others);
    return split;
}

LevenbergMarquardtOptions with_loss(const Arguments& arguments) {
    LevenbergMarquardtOptions options;
    for (const LossKind kind : {LossKind::Huber, LossKind::Cauchy}) {
        if (arguments.loss == loss_name(kind)) options.loss = {kind, arguments.loss_width};
    }
    return options;
}

Estimate identify_from_afar(const Arguments& arguments, const Campaign& campaign,
                            const Measurements& measurements) {
    GlobalOptions options = arguments.global;
    options.search = start_searches.at(arguments.search);
    options.length_share = arguments.length_error_percent / 100;
    options.angle = to_radians(arguments.angle_error_deg);
    Index& limit = options.start_options.iteration_limit;
    limit = arguments.iteration_limit.value_or(limit);
    GlobalEstimate found = identify_globally(campaign, measurements, options);
    print(fmt::format("{} starts, {} of them ended at the best{}\n", found.starts,
                      found.starts_at_best,
                      found.starts_at_best > 1 ? "" : "; there may be a better one"));
    return std::move(found.estimate);
}

Estimate identify_by_method(const Arguments& arguments, const Campaign& campaign,
                            const Measurements& measurements, const Parameters& start) {
    if (arguments.method == "global") return identify_from_afar(arguments, campaign, measurements);
    if (arguments.method == "two-step") {
        TwoStepOptions options = arguments.two_step;
        options.iteration_limit = arguments.iteration_limit.value_or(options.iteration_limit);
        return identify_two_step(campaign, measurements, start, options);
    }
    LevenbergMarquardtOptions options = with_loss(arguments);
    options.iteration_limit = arguments.iteration_limit.value_or(options.iteration_limit);
    return identify(campaign, measurements, start, options);
}

/// Base and targets fitted, the robot as its maker says.
Metrics fit_nominal(const Arguments& arguments, const Campaign& campaign,
                    const Measurements& measurements) {
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    const Parameters start = register_base_and_targets(nominal, measurements);
    return identify(nominal, measurements, start, with_loss(arguments)).fit;
}

/// Groups to hold out in turn, 0: none.
Index choose_folds(const Arguments& arguments, const Measurements& measurements) {
    const Index count = measurements.configuration_count();
    const Index folds =
        arguments.folds.value_or(count <= leave_one_out_limit ? count : default_folds);
    if (folds != 0 && (folds < 2 || folds > count)) {
        throw InputError(
            fmt::format("--folds is {}, must be 0 or from 2 to the number of configurations, {}",
                        folds, count));
    }
    return folds;
}

/// How far the other points are off; nothing without outliers.
std::optional<io::WithoutOutliers> judge_without_outliers(const Campaign& campaign,
                                                          const Measurements& measurements,
                                                          const io::CalibrationReport& report) {
    const Estimate& estimate = report.estimate;
    if (estimate.outliers.empty()) return std::nullopt;
    Seen is_judged = times_seen(measurements).array() > 0;
    for (const Outlier& outlier : estimate.outliers) {
        is_judged(outlier.configuration, outlier.target) = false;
    }
    const auto rms = [&](const RowMatrixXd& squares) {
        return std::sqrt(is_judged.select(squares, 0).sum() /
                         static_cast<double>(is_judged.count()));
    };
    io::WithoutOutliers result{rms(squared_distances(campaign, estimate.parameters, measurements)),
                               std::nullopt};
    if (report.held_out && report.held_out->failures.empty()) {
        result.held_out_rms = rms(report.held_out->squared_distances);
    }
    return result;
}

Metrics metrics_of(const Campaign& campaign, const Measurements& measurements,
                   const Estimate& estimate) {
    return make_metrics(residuals(campaign, estimate.parameters, measurements),
                        campaign.sensor->lengths_per_target());
}

/// All but what needs another file.
io::CalibrationReport make_report(const Arguments& arguments, const Campaign& campaign,
                                  const Split& split) {
    const Measurements& used = split.used;
    Parameters start = register_base_and_targets(campaign, used);
    io::CalibrationReport report;
    report.method = arguments.method;
    report.measurements = arguments.paths.measurements;
    report.estimate = identify_by_method(arguments, campaign, used, start);
    if (arguments.method == "global") start = report.estimate.parameters;  // for those held out
    report.nominal = fit_nominal(arguments, campaign, used);
    report.repeatability = repeatability(*campaign.sensor, used);
    const Index folds = choose_folds(arguments, used);
    if (folds > 0) {
        report.held_out = cross_validate(campaign, used, start, folds, with_loss(arguments));
    }
    report.without_outliers = judge_without_outliers(campaign, used, report);
    if (split.left_out) {
        report.left_out = metrics_of(campaign, *split.left_out, report.estimate);
    }
    return report;
}

void check_usage(const Arguments& arguments) {
    const auto require = [](bool is_right, const char* option, const char* rule) {
        if (!is_right) throw CLI::ValidationError(option, rule);
    };
    const bool is_squares = arguments.loss == "squares";
    const bool is_lm = arguments.method == "lm";
    require(is_squares || is_lm, "--loss", "needs --method lm; the others know squares only");
    require(!is_squares || arguments.loss_width == 0, "--loss-width",
            "needs --loss huber or cauchy");
    require(!arguments.model_selection || is_lm, "--model-selection", "needs --method lm");
    require(!arguments.model_selection || arguments.folds != 0, "--model-selection",
            "needs --folds of 2 or more");
}

void calibrate(Arguments arguments) {
    check_usage(arguments);
    const InputPaths& paths = arguments.paths;
    check_outputs({paths.campaign, paths.measurements, arguments.plan, arguments.validate},
                  {arguments.out});
    auto file = io::read_campaign(paths.campaign);
    arguments.global.seed = file.seed;
    bool& is_prior = file.spread.is_prior;
    is_prior = arguments.prior.value_or(is_prior);
    const Split split = read_split(arguments, file);
    std::optional<ModelSelection> selection;
    if (arguments.model_selection) {
        selection = compute_from(paths.measurements, [&] {
            return select_model(file, split.used, choose_folds(arguments, split.used),
                                with_loss(arguments));
        });
        print_model_selection(*selection);
    }
    io::CalibrationReport report =
        compute_from(paths.measurements, [&] { return make_report(arguments, file, split); });
    report.selection = std::move(selection);
    if (!arguments.validate.empty()) {
        report.validation =
            metrics_of(file, read_measured(arguments.validate, file), report.estimate);
    }
    if (!arguments.out.empty()) io::write_estimate(arguments.out, file, report);
    warn_about_calibration(paths.measurements, file, split.used, report);
    print_calibration(file, split.used, report);
}
void add_options(CLI::App& command, Arguments& arguments) {
    command.add_option("--plan", arguments.plan, "Use only the configurations of this plan file")
        ->check(file_name());
    command.add_option("--method", arguments.method, "lm, two-step or global")
        ->check(CLI::IsMember({"lm", "two-step", "global"}))
        ->capture_default_str();
    command
        .add_option("--alpha", arguments.two_step.alpha, "two-step: part of each robot step taken")
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
    command.add_option("--starts", arguments.global.start_limit, "global: most starts")
        ->check(whole_number(1, 1000000))
        ->capture_default_str();
    command
        .add_option("--validate", arguments.validate,
                    "Second measurement file, to judge the result on")
        ->check(file_name());
    command
        .add_option("--folds", arguments.folds,
                    "Groups to hold out in turn; 0: none (default: every configuration by "
                    "itself up to 100 of them, else 10)")
        ->check(whole_number(0, 1000000));
    command.add_option("--loss", arguments.loss, "squares, huber or cauchy: robust to outliers")
        ->check(CLI::IsMember({"squares", "huber", "cauchy"}))
        ->capture_default_str();
    command
        .add_option("--loss-width", arguments.loss_width,
                    "Where the loss leaves squares, in robust standard deviations (default: 95 % "
                    "efficiency; three coordinates a target: huber 1.63, cauchy 2.67)")
        ->check(real_number(0.1, 1e6));
    command.add_flag("--model-selection", arguments.model_selection,
                     "Compare nested parameter sets by their held-out error");
    add_prior_option(command, arguments.prior, ": fewer poses than parameters will do");
    command.add_option("-o,--out", arguments.out, "Write everything as JSON to this file")
        ->check(file_name());
}

/// Options of one method beside another would have no effect.
void check_method_options(const CLI::App& command, const std::string& method) {
    const std::vector<std::pair<std::string, std::string>> owners{
        {"--alpha", "two-step"},
        {"--length-error-percent", "global"},
        {"--angle-error-deg", "global"},
        {"--search", "global"},
        {"--starts", "global"}};
    for (const auto& [option, owner] : owners) {
        if (method == owner || command.count(option) == 0) continue;
        throw CLI::ValidationError(option, "needs --method " + owner);
    }
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
    command->callback([arguments, command] {
        check_method_options(*command, arguments->method);
        calibrate(*arguments);
    });
}

}  // namespace posewise::cli
