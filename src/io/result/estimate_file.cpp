#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/checksum.hpp"
#include "doubts_json.hpp"
#include "estimate_fields.hpp"
#include "io/campaign/robot_statement.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "judgement_json.hpp"
#include "parameters_json.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::Json;

constexpr double mm = 1e3;

/// Standard deviations of base and targets, by parameter name and unit.
Json other_sigmas_to_json(const Campaign& campaign, const Estimate& estimate,
                          const VectorXd& sigmas) {
    const auto units = parameter_units(campaign);
    const auto robot_begin = static_cast<std::size_t>(base_parameter_count(campaign));
    const auto robot_end = robot_begin + static_cast<std::size_t>(estimate.parameters.robot.size());
    Json others = Json::object();
    for (std::size_t i = 0; i < estimate.names.size(); ++i) {
        if (i >= robot_begin && i < robot_end) continue;
        others[estimate.names[i] + detail::si_suffix(*units[i])] = sigmas[static_cast<Index>(i)];
    }
    return others;
}

Json place_to_json(const FoundPlace& found, const std::string& own, const std::string& outer) {
    Json json = detail::base_to_json(found.place);
    json["in"] = outer;
    for (const auto& [axes, is_own] : {std::pair(outer, false), std::pair(own, true)}) {
        const VectorXd deviations = deviations_of(found, is_own);
        json["deviations"].push_back(
            {{"axes", axes},
             {"position_mm", detail::vector_to_json(mm_per_m * deviations.head(3))},
             {"rotation_mrad", detail::vector_to_json(mrad_per_rad * deviations.tail(3))}});
    }
    const Matrix3d half_axes = mm_per_m * ellipsoid_of(found);
    for (Index k = 0; k < 3; ++k) {
        const Vector3d half_axis = half_axes.col(k);
        json["ellipsoid"].push_back(
            {{"half_axis_mm", half_axis.norm()},
             {"direction", detail::vector_to_json(half_axis.normalized())}});
    }
    return json;
}

/// Where camera and board are, as far as that was found; empty: nowhere.
Json hand_eye_to_json(const Campaign& campaign, const Estimate& estimate) {
    const auto found = find_hand_eye(campaign, estimate);
    Json json = Json::object();
    if (!found) return json;
    const std::string on_flange = found->is_camera_on_flange ? "camera" : "board";
    const std::string other = found->is_camera_on_flange ? "board" : "camera";
    if (found->on_flange) json[on_flange] = place_to_json(*found->on_flange, on_flange, "flange");
    if (found->at_base) json[other] = place_to_json(*found->at_base, other, "base");
    return json;
}

/// All parameters' names, and the rows of their covariance up to its diagonal.
Json covariance_to_json(const Estimate& estimate) {
    Json rows = Json::array();
    for (Index k = 0; k < estimate.covariance.rows(); ++k) {
        rows.push_back(
            detail::vector_to_json(VectorXd(estimate.covariance.row(k).head(k + 1).transpose())));
    }
    return {{"parameters", estimate.names}, {"rows_si", std::move(rows)}};
}

Json correlations_to_json(const Estimate& estimate) {
    constexpr Index count = 10;
    Json list = Json::array();
    for (const Correlation& pair : strongest_correlations(estimate, count)) {
        list.push_back({{"first", estimate.names[static_cast<std::size_t>(pair.first)]},
                        {"second", estimate.names[static_cast<std::size_t>(pair.second)]},
                        {"coefficient", pair.coefficient}});
    }
    return list;
}

Json held_out_to_json(const CrossValidation& held_out) {
    return {{"folds", held_out.folds},
            {"samples", detail::metrics_to_json(held_out.samples)},
            {"means", detail::metrics_to_json(held_out.means)},
            {"failures", held_out.failures}};
}

/// By the residuals: the interval of the held-out RMS, the pose that matters most, drift.
void add_residual_answers(Json& accuracy, const Calibration& calibration) {
    const std::string unit = detail::error_suffix(calibration.campaign.sensor->main_units());
    if (const auto& interval = calibration.held_out_interval) {
        accuracy["held_out"]["interval"] = {{"lower" + unit, mm * interval->lower},
                                            {"upper" + unit, mm * interval->upper},
                                            {"degrees_of_freedom", interval->degrees_of_freedom}};
    }
    if (const auto& influence = calibration.influence) {
        accuracy["influence"] = {{"configuration", influence->id},
                                 {"fit_rms" + unit, mm * influence->fit},
                                 {"held_out_rms" + unit, mm * influence->held_out},
                                 {"is_alone", influence->is_alone}};
    }
    if (const auto& trend = calibration.order_trend) {
        Json slopes = Json::array();
        for (const OrderSlope& slope : trend->slopes) {
            const std::string own =
                detail::error_suffix(calibration.campaign.sensor->units(slope.is_angle));
            slopes.push_back({{"axis", slope.axis},
                              {"change" + own, mm * slope.change},
                              {"sigma" + own, mm * slope.error},
                              {"detectable" + own, mm * slope.detectable},
                              {"early" + own, mm * slope.early},
                              {"probability", slope.probability}});
        }
        accuracy["order_trend"] = {{"strongest", trend->worst().axis},
                                   {"is_beside_joints", trend->is_beside_joints},
                                   {"axes", std::move(slopes)}};
    }
    for (const ConditionTrend& condition : calibration.condition_trends) {
        Json slopes = Json::array();
        for (const OrderSlope& slope : condition.trend.slopes) {
            const std::string own =
                detail::error_suffix(calibration.campaign.sensor->units(slope.is_angle));
            slopes.push_back({{"axis", slope.axis},
                              {"change" + own, mm * slope.change},
                              {"sigma" + own, mm * slope.error},
                              {"detectable" + own, mm * slope.detectable},
                              {"probability", slope.probability}});
        }
        accuracy["condition_trends"].push_back(
            {{"name", condition.name},
             {"unit", condition.unit},
             {"range", condition.range},
             {"strongest", condition.trend.worst().axis},
             {"is_beside_joints", condition.trend.is_beside_joints},
             {"axes", std::move(slopes)}});
    }
}

/// Numbers of an expected error, RMS and 95 %, by name without unit: for JSON and CSV.
std::vector<std::pair<std::string, double>> list_numbers(const PredictedError& error) {
    return {{"parameters", error.parameters},
            {"left_over", error.model},
            {"noise", error.noise},
            {"total", error.total()},
            {"p95", error.percentile95}};
}

Json predictions_to_json(const std::vector<ErrorPrediction>& predictions) {
    Json json = {{"configuration_count", predictions.front().each.size()}};
    for (const ErrorPrediction& prediction : predictions) {
        for (const auto& [name, value] : list_numbers(prediction.overall)) {
            json[name + detail::error_suffix(*prediction.units)] = 1e3 * value;
        }
    }
    return json;
}

/// What points not used are expected to be off by, mm (mrad where no length is measured).
Json expected_to_json(const Calibration& calibration) {
    const AmountUnits& own = calibration.campaign.sensor->main_units();
    const auto one = [](const ExpectedError& error, const AmountUnits& units) {
        const std::string unit = detail::error_suffix(units);
        return Json{{"parameters" + unit, mm * error.parameters},
                    {"left_over" + unit, mm * error.model},
                    {"noise" + unit, mm * error.noise},
                    {"total" + unit, mm * error.total()}};
    };
    Json json = {{"at_measured", one(calibration.expected, own)}};
    if (const auto& error = calibration.expected_workspace)
        json["over_workspace"] = one(*error, own);
    if (const auto& error = calibration.expected_place) {
        json["of_places"] = one(*error, length_units);
    }
    if (const auto& error = calibration.expected_robot) {
        json["of_robot"] = Json{{"nominal_mm", mm_per_m * error->nominal},
                                {"calibrated_mm", mm_per_m * error->calibrated}};
    }
    const auto add = [&](const std::optional<Judgement>& judged, const char* where) {
        if (judged && judged->expected) json[where] = one(*judged->expected, *judged->units);
    };
    add(calibration.verification, "at_verification");
    add(calibration.left_out, "at_left_out");
    add(calibration.validation, "at_validation");
    return json;
}

Json without_outliers_to_json(const WithoutOutliers& others, const std::string& unit) {
    Json json = {{"fit_means_rms" + unit, mm * others.fit_rms}};
    if (others.held_out_rms) json["held_out_means_rms" + unit] = mm * *others.held_out_rms;
    if (others.fit_angle_rms) json["fit_means_rms_mrad"] = 1e3 * *others.fit_angle_rms;
    if (others.held_out_angle_rms) {
        json["held_out_means_rms_mrad"] = 1e3 * *others.held_out_angle_rms;
    }
    return json;
}

Json moved_to_json(const Moved& moved) {
    return {
        {"parts", moved.parts}, {"base_mm", mm * moved.base}, {"targets_mm", mm * moved.targets}};
}

Json accuracy_to_json(const Calibration& calibration) {
    Json accuracy = {{"nominal", detail::metrics_to_json(calibration.nominal)},
                     {"fit", detail::metrics_to_json(calibration.estimate.fit)},
                     {"fit_means", detail::metrics_to_json(calibration.estimate.fit_means)}};
    if (calibration.repeatability) {
        accuracy["repeatability_mm"] = mm * calibration.repeatability->length;
        if (calibration.nominal.has_orientation) {
            const AmountUnits& units = *calibration.nominal.orientation_units;
            accuracy["repeatability" + detail::error_suffix(units)] =
                1e3 * calibration.repeatability->orientation;
        }
    }
    for (const SensorAccuracy& one : calibration.by_sensor) {
        Json& json = accuracy["by_sensor"].emplace_back(
            Json{{"readings", one.readings},
                 {"nominal", detail::metrics_to_json(one.nominal)},
                 {"fit", detail::metrics_to_json(one.fit)}});
        if (one.held_out) json["held_out"] = detail::metrics_to_json(*one.held_out);
    }
    if (calibration.held_out) accuracy["held_out"] = held_out_to_json(*calibration.held_out);
    add_residual_answers(accuracy, calibration);
    accuracy["expected"] = expected_to_json(calibration);
    if (const auto& lengths = calibration.doubts.look.lengths) {
        accuracy["length_factor"] = {{"excess", lengths->excess},
                                     {"deviation", lengths->deviation}};
    }
    detail::add_judgements(accuracy, calibration);
    if (calibration.moved) {
        accuracy["moved_before_validation"] = moved_to_json(*calibration.moved);
    }
    if (calibration.moved_since) {
        accuracy["moved_since_earlier"] = moved_to_json(*calibration.moved_since);
    }
    if (!calibration.predicted.empty()) {
        accuracy["predicted"] = predictions_to_json(calibration.predicted);
        if (const auto& beyond = calibration.predicted_beyond) {
            accuracy["predicted"]["extrapolated"] = {{"count", beyond->count},
                                                     {"joints", beyond->joints}};
        }
    }
    if (const auto& others = calibration.without_outliers) {
        accuracy["without_outliers"] = without_outliers_to_json(
            *others, detail::error_suffix(calibration.campaign.sensor->main_units()));
    }
    return accuracy;
}

/// Base and targets that the validation was judged with.
Json refitted_to_json(const Calibration& calibration) {
    const Campaign& campaign = *calibration.refitted;
    Json json = detail::parameters_to_json(campaign, campaign.nominal);
    json.erase("robot");
    const auto units = parameter_units(campaign);
    const std::vector<std::string> errors = campaign.robot.parameter_names();
    std::size_t k = 0;
    for (const std::string& name : parameter_names(campaign)) {
        const std::string suffix = detail::si_suffix(*units[k++]);
        const auto sigma = calibration.refitted_sigmas.find(name);
        if (sigma == calibration.refitted_sigmas.end() || std::ranges::count(errors, name) > 0) {
            continue;
        }
        json["sigma"][name + suffix] = sigma->second;
    }
    return json;
}

Json measured_to_json(const MeasuredCount& measured, const std::vector<ImageCoverage>& images) {
    Json json = {{"configurations", measured.configurations},
                 {"samples", measured.samples},
                 {"readings", measured.readings},
                 {"readings_seen", measured.readings_seen}};
    if (!images.empty()) json["images"] = detail::images_to_json(images);
    return json;
}

Json outliers_to_json(const Sensor& sensor, const Estimate& estimate) {
    const std::vector<std::string> contacts = sensor.contact_names();
    Json list = Json::array();
    for (const Outlier& outlier : estimate.outliers) {
        list.push_back(
            {{"configuration", outlier.id},
             {"target", contacts.empty() ? "target" + std::to_string(outlier.target + 1)
                                         : contacts[static_cast<std::size_t>(outlier.target)]},
             {"distance_mm", mm * outlier.distance},
             {"standard_deviations", outlier.deviations},
             {"weight", outlier.weight}});
    }
    return list;
}

Json trial_to_json(const ModelTrial& trial) {
    Json json = {{"name", trial.set.name},
                 {"parameters", trial.set.parameters},
                 {"parameter_count", trial.parameter_count}};
    if (!trial.failure.empty()) {
        json["failure"] = trial.failure;
        return json;
    }
    json["fit_rms_mm"] = mm * trial.fit_rms;
    json["held_out_rms_mm"] = mm * trial.held_out_rms;
    json["standard_error_mm"] = mm * trial.standard_error;
    return json;
}

/// Of each class the size stated and the one learned.
Json sizes_to_json(const Calibration& calibration) {
    const Chain& robot = calibration.campaign.robot;
    Json sizes = Json::object();
    for (const SharedSize& stated : shared_sizes(*calibration.stated_spread, robot)) {
        sizes[stated.key + detail::si_suffix(stated.is_angle)] = {{"stated", stated.size}};
    }
    for (const SharedSize& learned : shared_sizes(calibration.campaign.spread, robot)) {
        sizes[learned.key + detail::si_suffix(learned.is_angle)]["learned"] = learned.size;
    }
    return sizes;
}

Json selection_to_json(const ModelSelection& selection) {
    Json sets = Json::array();
    for (const ModelTrial& trial : selection.trials) sets.push_back(trial_to_json(trial));
    Json json = {{"folds", selection.folds},
                 {"points_not_judged", selection.not_judged.size()},
                 {"sets", std::move(sets)}};
    if (selection.recommended < 0) return json;
    const auto name = [&](Index k) {
        return selection.trials[static_cast<std::size_t>(k)].set.name;
    };
    json["best"] = name(selection.best);
    json["recommended"] = name(selection.recommended);
    return json;
}

Json estimate_to_json(const Calibration& calibration, Provenance made_from) {
    const Campaign& campaign = calibration.campaign;
    Estimate estimate = calibration.estimate;
    std::vector<std::string> faults = calibration.faults;
    const VectorXd sigmas = standard_deviations(estimate);
    Json document = detail::make_document("estimate");
    const detail::Fields fields(document);
    document["campaign"] = campaign.name;
    document["warnings"] = made_from.warnings;
    detail::provenance_fields(fields, made_from);
    for (const auto& [key, text] : made_from.record) document["record"][key] = text;
    document["measured"] = measured_to_json(calibration.measured, calibration.images);
    if (!calibration.excluded.empty()) document["excluded"] = calibration.excluded;
    if (!calibration.held.empty()) document["held"] = calibration.held;
    document["method"] = method_name(calibration.method);
    if (calibration.method == CalibrationMethod::Global) {
        document["starts"] = calibration.starts;
        document["starts_at_best"] = calibration.starts_at_best;
    }
    detail::fit_fields(fields, estimate, faults);
    document["readings"] = campaign.sensor->words().readings;
    document["chain"] = detail::robot_statement(campaign.robot);
    document.update(detail::parameters_to_json(campaign, estimate.parameters, &sigmas));
    document["sigma"] = other_sigmas_to_json(campaign, estimate, sigmas);
    document["covariance"] = covariance_to_json(estimate);
    if (Json places = hand_eye_to_json(campaign, estimate); !places.empty()) {
        document["hand_eye"] = std::move(places);
    }
    document["strongest_correlations"] = correlations_to_json(estimate);
    document["accuracy"] = accuracy_to_json(calibration);
    if (estimate.loss.kind != LossKind::Squares) {
        document["loss"] = {{"kind", loss_name(estimate.loss.kind)},
                            {"width_standard_deviations", estimate.loss.width}};
        document["outliers"] = outliers_to_json(*campaign.sensor, estimate);
    }
    if (calibration.refitted) document["refitted"] = refitted_to_json(calibration);
    if (calibration.selection)
        document["model_selection"] = selection_to_json(*calibration.selection);
    if (calibration.stated_spread) document["learned_sizes"] = sizes_to_json(calibration);
    document["assumes"] = detail::numbers_to_json(assumptions_of(campaign));
    document["doubts"] = detail::doubts_to_json(campaign, calibration.doubts);
    document["cures"] = detail::cures_to_json(campaign, calibration.cures);
    document["answers"] = detail::answers_to_json(made_from.answers);
    return document;
}

/// The error that is a joint's offset; the joint stands at its value plus `factor` times it.
struct JointOffset {
    Index parameter = -1;  ///< none was found
    double factor = 0;
};

std::vector<JointOffset> joint_offsets(const Chain& robot) {
    std::vector<JointOffset> offsets(static_cast<std::size_t>(robot.joint_count()));
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        const Index joint = parameter_owner(robot, k);
        if (robot.parameter_term(k) != nullptr || joint < 0) continue;
        const Element& element = robot.parameter_element(k);
        const auto own = std::ranges::find(element.joints, joint, &JointTerm::joint);
        offsets[static_cast<std::size_t>(joint)] = {k, 1 / own->coefficient};
    }
    return offsets;
}

}  // namespace

std::string checksum_of(const Measurements& measurements) {
    detail::Checksum checksum;
    for (const std::string& id : measurements.ids) checksum.add(id);
    checksum.add(measurements.configurations);
    checksum.add(measurements.observations);
    checksum.add(RowMatrixXd(measurements.is_seen.cast<double>()));
    return checksum.text();
}

std::string to_json(const Calibration& calibration, const Provenance& made_from) {
    return detail::json_text(estimate_to_json(calibration, made_from));
}

void write_estimate(const std::string& path, const Calibration& calibration,
                    const Provenance& made_from) {
    detail::write_json(path, estimate_to_json(calibration, made_from));
}

void write_offsets_csv(const std::string& path, const Campaign& campaign, const Estimate& estimate,
                       const ControllerJoints& controller) {
    const Chain& robot = campaign.robot;
    const Index robot_begin = base_parameter_count(campaign);
    const std::vector<JointOffset> offsets = joint_offsets(robot);
    const bool has_pulses = controller.pulses_per_unit().size() > 0;
    std::string text =
        std::string("joint,offset,deviation,unit") + (has_pulses ? ",pulses\n" : "\n");
    for (Index i = 0; i < controller.count(); ++i) {
        const VectorXd coefficients = controller.from_model().row(i).transpose();
        VectorXd effect = VectorXd::Zero(robot.parameter_count());  // of each error on this joint
        bool is_found = true;
        for (Index j = 0; j < coefficients.size(); ++j) {
            if (coefficients[j] == 0) continue;
            const JointOffset& offset = offsets[static_cast<std::size_t>(j)];
            is_found = is_found && offset.parameter >= 0;
            if (is_found) effect[offset.parameter] = coefficients[j] * offset.factor;
        }
        if (!is_found) continue;
        double found = 0;
        double variance = 0;
        for (Index k = 0; k < effect.size(); ++k) {
            if (effect[k] == 0) continue;
            found += effect[k] * estimate.parameters.robot[k];
            for (Index l = 0; l < effect.size(); ++l) {
                variance +=
                    effect[k] * effect[l] * estimate.covariance(robot_begin + k, robot_begin + l);
            }
        }
        const bool turns = controller.motion(i) == Motion::Rotation;
        const double unit = turns ? to_degrees(1) : mm_per_m;
        fmt::format_to(std::back_inserter(text), "{},{:.9g},{:.3g},{}",
                       detail::csv_field(controller.names()[static_cast<std::size_t>(i)]),
                       unit * found, unit * std::sqrt(variance), turns ? "deg" : "mm");
        if (has_pulses) {
            fmt::format_to(std::back_inserter(text), ",{:.0f}",
                           controller.pulses_per_unit()[i] * found);
        }
        text += '\n';
    }
    detail::write_file(path, text);
}

void write_predictions_csv(const std::string& path, const std::vector<std::string>& ids,
                           const std::vector<ErrorPrediction>& predictions) {
    std::string text = "config";
    for (const ErrorPrediction& prediction : predictions) {
        for (const auto& [name, value] : list_numbers(prediction.overall)) {
            text += ',' + name + detail::error_suffix(*prediction.units);
        }
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
        text += '\n' + detail::csv_field(ids[i]);
        for (const ErrorPrediction& prediction : predictions) {
            for (const auto& [name, value] : list_numbers(prediction.each[i])) {
                text += fmt::format(",{:.6f}", 1e3 * value);
            }
        }
    }
    detail::write_file(path, text + '\n');
}

}  // namespace posewise::io
