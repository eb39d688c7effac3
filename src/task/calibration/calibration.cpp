#include "posewise/task/calibration.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "answers.hpp"
#include "calibration_options.hpp"
#include "calibrator/robust.hpp"
#include "core/format.hpp"
#include "core/progress_counter.hpp"
#include "core/text.hpp"
#include "earlier_estimate.hpp"
#include "judgement.hpp"
#include "moved.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "sensor_accuracy.hpp"
#include "task/doubt/data_faults.hpp"
#include "task/doubt/nominal_residuals.hpp"
#include "task/plan/workspace.hpp"

namespace posewise {
namespace {

/// What is calibrated, with what, and how far it is.
struct Work {
    const Campaign& whole;          ///< as asked for, with the sizes that were learned earlier
    detail::KnownParameters known;  ///< see EarlierUse::only
    Campaign campaign;              ///< less what is known
    const Measurements& used;
    const CalibrationOptions& options;
    Index folds;
    detail::ProgressCounter counter;
    std::optional<detail::NominalRobot> nominal{};  ///< base and targets fitted to what is used

    /// One part is done.
    ProgressCallback step() {
        return [this](const Progress&) { counter.count(); };
    }
    /// Of what is fitted beside the identification itself: the same loss.
    LevenbergMarquardtOptions beside() const {
        LevenbergMarquardtOptions beside;
        beside.loss = options.joint.loss;
        return stopped(beside);
    }
    detail::Refitting refitting() const {
        return {beside(), options.validation_campaign != nullptr};
    }
    /// A method's options, ended by what ends the calibration.
    template <class MethodOptions>
    MethodOptions stopped(MethodOptions method_options) const {
        method_options.stop = options.stop;
        return method_options;
    }
};

Index part_count(const Campaign& campaign, const CalibrationOptions& options, Index folds) {
    const auto sets = options.model_selection
                          ? static_cast<Index>(nested_parameter_sets(campaign.robot).size())
                          : 0;
    return sets + 1 + folds;
}

/// Parameters of the first that the second does not have.
std::vector<std::string> names_only_in(const Campaign& whole, const Campaign& part) {
    std::vector<std::string> names = parameter_names(whole);
    const std::vector<std::string> others = parameter_names(part);
    std::erase_if(names, [&](const auto& name) { return std::ranges::count(others, name) > 0; });
    return names;
}

MeasuredCount count_measured(const Sensor& sensor, const Measurements& measurements) {
    const Index samples = measurements.observations.rows();
    return {measurements.configuration_count(), samples, samples * sensor.seen_at_once(),
            measurements.is_seen.count()};
}

void identify_by_method(const Work& work, const Parameters& registered, Calibration& result) {
    const CalibrationOptions& options = work.options;
    switch (options.method) {
        case CalibrationMethod::Joint:
            result.estimate =
                identify(work.campaign, work.used, registered, work.stopped(options.joint));
            return;
        case CalibrationMethod::TwoStep:
            result.estimate = identify_two_step(work.campaign, work.used, registered,
                                                work.stopped(options.two_step));
            return;
        case CalibrationMethod::Global:
            break;
    }
    GlobalOptions global = options.global;
    global.start_options = work.stopped(global.start_options);
    GlobalEstimate found = identify_globally(work.campaign, work.used, global);
    result.estimate = std::move(found.estimate);
    result.starts = found.starts;
    result.starts_at_best = found.starts_at_best;
}

/// Nothing if it was stopped on the way.
std::optional<CrossValidation> hold_out(Work& work, const Calibration& result) {
    if (work.folds == 0 || work.options.stop.is_set()) return std::nullopt;
    // One configuration more or less hardly changes the model error.
    LevenbergMarquardtOptions options = work.beside();
    options.finds_model_error = false;
    auto held_out = cross_validate(result.campaign, work.used, result.estimate.parameters,
                                   work.folds, options, work.step());
    if (work.options.stop.is_set()) return std::nullopt;
    return held_out;
}

/// How far the other points are off; nothing without outliers.
std::optional<WithoutOutliers> judge_without_outliers(const Work& work, const Calibration& result) {
    const Estimate& estimate = result.estimate;
    if (estimate.outliers.empty()) return std::nullopt;
    const Seen is_judged = detail::points_but_outliers(work.used, estimate.outliers);
    const auto rms = [&](const RowMatrixXd& squares) {
        return std::sqrt(is_judged.select(squares, 0).sum() /
                         static_cast<double>(is_judged.count()));
    };
    const Sensor& sensor = *work.campaign.sensor;
    const bool has_both = sensor.has_lengths() && sensor.has_angles();
    const bool is_held_out = result.held_out && result.held_out->failures.empty();
    WithoutOutliers others{rms(squared_distances(work.campaign, estimate.parameters, work.used)),
                           std::nullopt};
    if (has_both) {
        others.fit_angle_rms = rms(squared_angles(work.campaign, estimate.parameters, work.used));
    }
    if (is_held_out) others.held_out_rms = rms(result.held_out->squared_distances);
    if (is_held_out && has_both) {
        others.held_out_angle_rms = rms(result.held_out->squared_angles);
    }
    return others;
}

void compare_models(Work& work, const Parameters& registered, Calibration& result) {
    if (!work.options.model_selection) return;
    ModelSelection selection =
        select_model(work.campaign, work.used, registered, work.folds, work.beside(), work.step());
    if (!work.options.stop.is_set()) result.selection = std::move(selection);
}

std::map<std::string, double> sigmas_by_name(const Estimate& estimate) {
    const VectorXd sigmas = standard_deviations(estimate);
    std::map<std::string, double> by_name;
    Index k = 0;
    for (const std::string& name : estimate.names) by_name[name] = sigmas[k++];
    return by_name;
}

/// At the residuals; not where it was stopped, since that takes fits. Measurements that are not of
/// this robot, or were misread, contradict all of it: of them only rows are looked at, and whether
/// a few configurations do it.
void look(const Work& work, Calibration& result) {
    if (work.options.stop.is_set()) return;
    Doubts& doubts = result.doubts;
    if (!doubts.misfit) {
        doubts.look = look_at_residuals(work.campaign, work.used, result.estimate);
    }
    if (!doubts.misfit && !doubts.gross_error) return;
    const bool has_pixels = work.campaign.sensor->has_only_pixels();
    if (has_pixels && doubts.misfit && doubts.misfit->is_explained()) return;
    if (!has_pixels) doubts.look.shifted = find_shifted_rows(work.campaign, work.used);
    if (!doubts.look.shifted && !doubts.look.outlying) {
        doubts.look.outlying = find_gross_configurations(work.campaign, work.used, result.estimate);
    }
}

/// The campaign with sizes half way, as factors, from those expected to larger ones that were
/// learned: these are as large as what is wrong may make them.
Campaign with_credible_sizes(const Campaign& campaign, const Estimate& estimate) {
    Campaign credible = campaign;
    if (!estimate.spread) return credible;
    for (const SharedSize& learned : shared_sizes(*estimate.spread, campaign.robot)) {
        double& size = size_of(credible.spread, campaign.robot, learned.members.front());
        size = std::max(size, std::sqrt(size * learned.size));
    }
    return credible;
}

/// Of views that contradict the others a robust loss hardly takes notice; all else found by least
/// squares follows from them.
bool has_spoilt_views(const Calibration& result) {
    return !result.doubts.views.empty() && result.estimate.loss.kind == LossKind::Squares;
}

std::string describe_spoilt(const std::vector<ViewDoubt>& views) {
    return views.size() == 1
               ? fmt::format("view {} contradicts the others", detail::quote(views.front().sample))
               : fmt::format("{} views contradict the others", views.size());
}

/// What no errors of the robot can hide; empty: nothing. A robot whose errors are not fitted hides
/// nothing.
std::string describe_misread(const Campaign& campaign, const Doubts& doubts) {
    constexpr double far = 3;
    const bool has_pixels = campaign.sensor->has_only_pixels();
    const bool has_errors = campaign.robot.parameter_count() > 0;
    const auto& misfit = doubts.misfit;
    const auto& camera = doubts.camera;
    if (camera && camera->board_factor != 1 && camera->misfit > far * camera->scaled_misfit) {
        return "the board is of another size than stated";
    }
    if (doubts.look.shifted && has_pixels) return "rows have the joint values of their neighbours";
    if (!misfit || (has_errors && !has_pixels)) return "";
    if (misfit->is_explained()) return "what was measured fits far better read otherwise";
    // Of points it is as good as the robot.
    if (has_errors || !has_pixels) return "";
    return fmt::format(
        "the nominal robot, whose errors are not fitted, misses half of the {} by over {} {}",
        campaign.sensor->words().readings, detail::format_short(1e3 * misfit->distance, 3),
        campaign.sensor->main_units().error);
}

/// All that `used` alone tell.
void calibrate_with(Work& work, Calibration& result) {
    Registration registration = register_base_and_targets(work.campaign, work.used);
    if (!registration.is_determined()) {
        result.estimate.ending = Ending::NotIdentifiable;
        result.estimate.undetermined = registration.undetermined;
        return;
    }
    Parameters& registered = registration.parameters;
    compare_models(work, registered, result);
    identify_by_method(work, registered, result);
    work.counter.count();
    if (!result.is_identified()) return;
    work.nominal = detail::fit_nominal_robot(work.campaign, work.whole.robot, work.used, registered,
                                             work.beside());
    result.nominal_residuals =
        residuals(work.nominal->campaign, work.nominal->parameters(), work.used);
    result.nominal = make_metrics(result.nominal_residuals, *work.campaign.sensor);
    result.repeatability = repeatability(*work.campaign.sensor, work.used);
    result.campaign = with_model_error(work.campaign, result.estimate);
    if (result.estimate.spread) result.stated_spread = work.campaign.spread;
    result.held_out = hold_out(work, result);
    result.without_outliers = judge_without_outliers(work, result);
    const RowMatrixXd left = residuals(work.campaign, result.estimate.parameters, work.used);
    result.by_sensor = detail::accuracy_by_sensor(
        *work.campaign.sensor, work.used.is_seen, result.nominal_residuals, left,
        result.held_out ? result.held_out->residuals : RowMatrixXd());
    result.order_trend = detail::find_order_trend(work.campaign, work.used, left);
    result.condition_trends =
        detail::find_condition_trends(work.campaign, work.used, left, work.options.conditions);
    if (const auto& held_out = result.held_out) {
        result.influence = detail::find_influence(work.campaign, work.used, left, *held_out);
        result.held_out_interval = detail::held_out_interval(work.campaign, work.used, *held_out);
    }
    result.images = find_image_coverage(*work.campaign.sensor, work.used);
    result.doubts = find_doubts(work.campaign, work.used, registered, result.nominal);
    if (work.options.earlier) result.doubts.places.clear();  // by moved_since, where it matters
    result.faults =
        find_faults(with_credible_sizes(work.campaign, result.estimate), result.estimate,
                    result.method == CalibrationMethod::Global ? ValueCheck::None
                                                               : ValueCheck::ByExpectedSizes);
    if (has_spoilt_views(result)) {
        result.faults.insert(result.faults.begin(), describe_spoilt(result.doubts.views));
    } else {
        if (std::string fault = describe_misread(work.campaign, result.doubts); !fault.empty()) {
            result.faults.insert(result.faults.begin(), std::move(fault));
        }
        add_doubts(work.campaign, work.used, result.estimate, result.doubts);
        look(work, result);
        detail::judge_data({work.campaign, work.whole.robot, work.used, registered, work.beside()},
                           work.options, result);
    }
    if (const auto& earlier = work.options.earlier) {
        if (!result.held.empty()) result.sigmas_beside_held = sigmas_by_name(result.estimate);
        result.estimate = detail::complete(work.whole, earlier->estimate, work.known, work.campaign,
                                           work.used, result.estimate);
        result.campaign = with_model_error(work.whole, result.estimate);
    }
    result.expected = expected_error(result.campaign, result.estimate, work.used);
    if (const auto error = detail::expected_workspace_error(result.campaign, result.estimate)) {
        result.expected_workspace = error->readings;
        result.expected_place = error->place;
        result.expected_robot = error->robot;
    }
    constexpr double far_more = 2;
    const auto& workspace = result.expected_workspace;
    if (workspace && result.expected.is_by_few_poses() &&
        workspace->total() > far_more * result.nominal.rms()) {
        result.doubts.workspace = WorkspaceDoubt{workspace->total(), result.nominal.rms()};
    }
}

/// How many numbers of base and targets.
Index refitted_count(const std::vector<std::string>& parts, const Campaign& campaign) {
    Index count = 0;
    for (const std::string& part : parts) {
        count += part == "base" ? base_parameter_count(campaign)
                                : std::ssize(campaign.sensor->unknown_names());
    }
    return count;
}

Estimate refit(const Work& work, const Calibration& result, const Campaign& campaign) {
    const std::vector<std::string>& refitted = work.options.refitted;
    Estimate before = result.estimate;
    VectorXd& robot = before.parameters.robot;
    robot = errors_under_loads(result.campaign.robot, robot, campaign.robot);
    Estimate found =
        detail::refit_parts(work.refitting(), campaign, before, *work.options.validation, refitted);
    found.variance_factor = before.variance_factor;  // what is expected there is not learned there
    found.variance_by_kind = before.variance_by_kind;
    found.degrees_of_freedom = before.degrees_of_freedom;
    found.model_error_within = before.model_error_within;
    if (found.undetermined.empty()) return found;
    throw InputError(
        fmt::format("{} cannot be refitted: {}", fmt::join(refitted, " and "), found.undetermined));
}

/// Only where it matters: of what an earlier estimate tells as prior, or of what is held.
void find_moved_since(const Work& work, Calibration& result) {
    const auto& earlier = work.options.earlier;
    if (!earlier || earlier->use.has_new_base || earlier->use.has_new_targets) return;
    const bool is_prior = earlier->use.is_prior;
    if (!is_prior && !work.known.base && !work.known.targets) return;
    const Campaign then = with_model_error(work.whole, earlier->estimate);
    auto moved = detail::find_moved(work.refitting(), then, earlier->estimate, work.used);
    if (!moved) return;
    std::erase_if(moved->parts, [&](const std::string& part) {
        return !is_prior && !(part == "base" ? work.known.base : work.known.targets);
    });
    if (!moved->parts.empty()) result.moved_since = moved;
}

/// To compare with; nullptr: no errors of the robot are found, so that it is the same.
const detail::NominalRobot* nominal_of(const Work& work) {
    return work.campaign.robot.parameter_count() > 0 ? &*work.nominal : nullptr;
}

/// With the same parts refitted to the validation as the calibrated robot has; nothing: they cannot
/// be, or it is the same.
std::optional<detail::NominalRobot> nominal_at_validation(const Work& work,
                                                          const Campaign& campaign) {
    if (nominal_of(work) == nullptr) return std::nullopt;
    detail::NominalRobot nominal = *work.nominal;
    if (work.options.refitted.empty()) return nominal;
    Estimate before;
    before.parameters = nominal.parameters();
    nominal.campaign = with_robot(campaign, without_parameters(campaign.robot));
    nominal.fitted = detail::refit_parts({work.beside(), true}, nominal.campaign, before,
                                         *work.options.validation, work.options.refitted);
    if (!nominal.fitted.undetermined.empty()) return std::nullopt;
    return nominal;
}

/// On the measurements of the validation.
void validate(const Work& work, Calibration& result) {
    const CalibrationOptions& options = work.options;
    if (options.validation == nullptr) return;
    Campaign campaign = result.campaign;
    Estimate estimate = result.estimate;
    if (options.validation_campaign != nullptr) {
        campaign = with_model_error(*options.validation_campaign, estimate);
    }
    if (!options.refitted.empty()) {
        estimate = refit(work, result, campaign);
        result.refitted = campaign;
        result.refitted->nominal = estimate.parameters;
        result.refitted_sigmas = sigmas_by_name(estimate);
    }
    // What else was identified there the estimate's covariance does not tell.
    const bool is_same = options.validation_campaign == nullptr;
    const auto nominal = nominal_at_validation(work, campaign);
    result.validation =
        detail::judge({campaign, estimate, work.used.configurations, is_same,
                       refitted_count(options.refitted, campaign), nominal ? &*nominal : nullptr},
                      *options.validation);
    if (is_same && options.refitted.empty()) {
        result.moved =
            detail::find_moved(work.refitting(), campaign, estimate, *options.validation);
    }
}

/// On poses of the same file that were not used: those that a plan has to verify, and the rest.
void judge_others(const Work& work, const Measurements& all, Calibration& result) {
    const auto judge_at = [&](const std::vector<Index>& configurations) {
        std::optional<Judgement> judgement;
        if (configurations.empty()) return judgement;
        const Measurements others = take(all, configurations);
        judgement = detail::judge(
            {result.campaign, result.estimate, work.used.configurations, true, 0, nominal_of(work)},
            others);
        if (judgement->is_beyond()) {
            judgement->moved =
                detail::find_moved(work.refitting(), result.campaign, result.estimate, others);
        }
        return judgement;
    };
    const CalibrationOptions& options = work.options;
    result.verification = judge_at(options.verification);
    if (options.used.empty()) return;
    std::vector<Index> known = options.used;
    known.insert(known.end(), options.verification.begin(), options.verification.end());
    result.left_out = judge_at(all_but(all.configuration_count(), known));
}

/// Few poses that were held out may tell little where others, that were not calibrated with, show
/// that it is better than the nominal robot.
void forget_held_out(Calibration& result) {
    constexpr double plainly = 0.7;
    if (!result.verification || !result.doubts.held_out || result.doubts.held_out->is_worse()) {
        return;
    }
    for (const JudgedGroup& group : result.verification->groups) {
        const bool is_better = group.found.rms() < plainly * result.nominal.rms();
        if (group.group == PoseGroup::New && is_better) result.doubts.held_out.reset();
    }
}

}  // namespace

Calibration calibrate(const Campaign& stated, const Measurements& measurements,
                      const CalibrationOptions& options) {
    const Campaign campaign = detail::weighed_campaign(stated, options.joint.loss);
    const Measurements part =
        options.used.empty() ? Measurements{} : take(measurements, options.used);
    const Measurements& used = options.used.empty() ? measurements : part;
    detail::check_options(options, used.configuration_count());
    const Index folds = options.folds.value_or(default_folds(used.configuration_count()));
    const auto& earlier = options.earlier;
    Campaign whole = campaign;
    const bool has_learned = earlier && earlier->estimate.spread;
    if (has_learned) whole.spread = *earlier->estimate.spread;
    Work work{whole,
              detail::known_parameters(campaign,
                                       earlier ? earlier->use.only : std::vector<std::string>{}),
              earlier ? with_earlier(campaign, *earlier) : campaign,
              used,
              options,
              folds,
              detail::ProgressCounter(options.progress, part_count(campaign, options, folds))};
    Calibration result;
    result.campaign = whole;
    if (has_learned) result.stated_spread = campaign.spread;
    result.method = options.method;
    result.measured = count_measured(*campaign.sensor, used);
    result.excluded = options.excluded;
    result.limit = options.limit;
    result.held = names_only_in(whole, work.campaign);
    calibrate_with(work, result);
    if (!result.is_identified()) return result;
    find_moved_since(work, result);
    judge_others(work, measurements, result);
    forget_held_out(result);
    try {
        validate(work, result);
    } catch (const InputError& error) {
        throw ValidationError(error.what());
    }
    if (options.predicted.rows() > 0) {
        result.predicted = predict_errors(result.campaign, result.estimate, options.predicted);
        result.predicted_beyond =
            find_beyond_measured(campaign, used.configurations, options.predicted);
    }
    return result;
}

}  // namespace posewise
