#include "calibrate_options.hpp"

#include "calibrator/loss.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "page.hpp"
#include "plot.hpp"
#include "task/calibration/calibration_options.hpp"

namespace posewise::cli {

void add_calibrate_options(CLI::App& command, CalibrateArguments& arguments) {
    CalibrationOptions& options = arguments.options;
    add_points_options(command, arguments.paths.plan, arguments.paths.points_unit,
                       "Use only the configurations of this plan, judge on those it has to verify "
                       "and on the others");
    add_exclude_option(command, options.excluded);
    command
        .add_option("--method", arguments.method,
                    "Method of identification: lm, two-step or global")
        ->check(CLI::IsMember(detail::words_of(detail::method_names)))
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
                    "global: starts are random, or the best of covariance matrix adaptation: "
                    "random or cmaes")
        ->check(CLI::IsMember({"random", "cmaes"}))
        ->capture_default_str();
    command.add_option("--starts", options.global.start_limit, "global: most starts")
        ->check(whole_number(1, 1000000))
        ->capture_default_str();
    command
        .add_option(
            "--validate", arguments.validate,
            "Second measurement file, to judge the result on: poses that are new, beyond the "
            "ranges calibrated with, and repeated, each group by itself")
        ->check(file_name());
    command
        .add_option("--limit-mm", arguments.limit_mm,
                    "RMS of distances to keep at the poses it is judged on: pass, fail or "
                    "undecided, with 95 %")
        ->check(real_number(1e-6, 1e6));
    CLI::Option* const predict =
        command
            .add_option("--predict", arguments.predict,
                        "Configurations that need not be measured (CSV): what to expect there")
            ->check(file_name());
    command
        .add_option("--predict-out", arguments.predict_out,
                    "Write what to expect at each of them (CSV)")
        ->needs(predict)
        ->check(file_name());
    command
        .add_option("--folds", options.folds,
                    "Groups to hold out in turn; 0: none (default: every configuration by "
                    "itself up to 100 of them, else 10)")
        ->check(whole_number(0, 1000000));
    command
        .add_option("--loss", arguments.loss,
                    "Loss of the residuals: squares, huber or cauchy; the last two are robust to "
                    "outliers")
        ->check(CLI::IsMember(detail::words_of(detail::loss_names)))
        ->capture_default_str();
    command
        .add_option("--loss-width", options.joint.loss.width,
                    "Where the loss leaves squares, in robust standard deviations (default: 95 % "
                    "efficiency; three coordinates a target: huber 1.63, cauchy 2.67)")
        ->check(real_number(0.1, 1e6));
    command.add_flag("--model-selection", options.model_selection,
                     "Compare nested parameter sets by their held-out error");
    add_ids_option(
        command, "--free", arguments.free,
        "Identify only these errors of the robot, by commas: dq2,dq3, or a class, "
        "class:offsets, lengths, angles, gravity, harmonics, tilts, gains, terms (to use the "
        "estimate with --from later, list them in the campaign: errors: [dq2, dq3])");
    add_prior_option(command, arguments.prior, ": fewer poses than parameters will do");
    command
        .add_option("--sizes", arguments.sizes,
                    "How large the errors of each class are: learned, from the expected sizes of "
                    "the prior, "
                    "or as stated (default: as the campaign says)")
        ->check(CLI::IsMember({"learned", "stated"}));
    command.add_flag("--all-parameters", arguments.has_all_parameters, "List each, however many");
    add_earlier_options(command, arguments.earlier);
    let_force_take_measured(command);
    CLI::Option* const refit =
        add_parts_option(command, "--refit", options.refitted,
                         "With --validate: what is identified anew there: base, targets or both "
                         "(base,targets); the rest stays")
            ->needs("--validate");
    command
        .add_option("--validate-campaign", arguments.validation_campaign,
                    "Campaign file of that measurement, if it has other targets, another sensor or "
                    "payload; needs --refit base,targets")
        ->check(file_name())
        ->needs(refit);
    command.add_option("-o,--out", arguments.out, "Write everything as JSON to this file")
        ->check(file_name());
    command
        .add_option(
            "--csv", arguments.csv,
            "Write the offset of each joint of the controller (deg, mm, pulses), as for mastering")
        ->check(file_name());
    add_report_option(command, arguments.page);
    add_plot_option(command, arguments.plot, "Draw what is left of each reading");
}

}  // namespace posewise::cli
