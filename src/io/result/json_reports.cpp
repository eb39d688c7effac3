#include <algorithm>
#include <cmath>

#include "doubts_json.hpp"
#include "io/format/json.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "parameters_json.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/documents.hpp"

namespace posewise::io {
namespace {

using detail::Json;

/// What a list is made of, one value each.
template <class List, class Make>
Json make_list(const List& items, Make&& make) {
    Json list = Json::array();
    for (const auto& item : items) list.push_back(make(item));
    return list;
}

// ---- inspect ----

Json joint_to_json(const Joint& joint) {
    const AmountUnits& units = units_of(joint.motion);
    return {{"name", joint.name},
            {"kind", joint.motion == Motion::Rotation ? "revolute" : "prismatic"},
            {"limits_" + std::string(units.reading),
             {units.to_reading(joint.lower), units.to_reading(joint.upper)}}};
}

/// What drives an amount.
Json joint_terms_to_json(const std::vector<JointTerm>& terms, const Chain& robot) {
    return make_list(terms, [&](const JointTerm& term) {
        return Json{{"joint", robot.joint(term.joint).name}, {"coefficient", term.coefficient}};
    });
}

Json element_to_json(const Element& element, const Chain& robot) {
    const AmountUnits& units = units_of(element.motion);
    Json parameters = Json::array();
    if (!element.parameter.empty()) parameters.push_back(element.parameter);
    for (const ErrorTerm& term : element.terms) parameters.push_back(term.parameter);
    return {{"transform", transform_name(element)},
            {"nominal_" + std::string(units.reading), units.to_reading(element.value)},
            {"joints", joint_terms_to_json(element.joints, robot)},
            {"parameters", std::move(parameters)}};
}

/// Each parameter with its expected error and, if measurements cannot tell it from others, those
/// that do the same: so many m or rad of each for 1 m or rad of it.
Json identifiability_to_json(const Campaign& campaign, const Identifiability& found) {
    const std::vector<std::string> names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    const VectorXd scale = parameter_scale(campaign);
    Json list = Json::array();
    for (std::size_t k = 0; k < names.size(); ++k) {
        list.push_back({{"name", names[k]},
                        {"expected_error" + detail::error_suffix(*units[k]),
                         mm_per_m * scale[static_cast<Index>(k)]},
                        {"identifiable", true},
                        {"absorbed_by", Json::array()}});
    }
    for (const DroppedParameter& dropped : found.dropped) {
        Json& parameter = list[static_cast<std::size_t>(dropped.parameter)];
        parameter["identifiable"] = false;
        parameter["absorbed_by"] = make_list(dropped.absorbed_by, [&](const ParameterTerm& term) {
            return Json{{"parameter", names[static_cast<std::size_t>(term.parameter)]},
                        {"coefficient", term.coefficient}};
        });
    }
    return list;
}

Json inspection_to_json(const Inspection& inspection) {
    const Campaign& campaign = inspection.campaign;
    const bool is_stated = inspection.stated.has_value();
    const Identifiability& found = is_stated ? *inspection.stated : inspection.of_complete;
    Json document = detail::make_document("inspection");
    document["campaign"] = campaign.name;
    document["model_error_mm"] = mm_per_m * campaign.model_error;
    document["model_error_mrad"] = mrad_per_rad * campaign.model_error_orientation;
    document["prior"] = campaign.spread.is_prior;
    document["joints"] = make_list(campaign.robot.joints(), joint_to_json);
    document["elements"] = make_list(campaign.robot.elements(), [&](const Element& element) {
        return element_to_json(element, campaign.robot);
    });
    document["model"] = is_stated ? "stated" : "complete";
    document["parameters"] =
        identifiability_to_json(is_stated ? campaign : inspection.complete, found);
    document["rank"] = found.kept.size();
    document["least_kept_residual"] = found.least_kept_residual;
    document["largest_dropped_residual"] = found.largest_dropped_residual;
    document["doubtful"] = find_doubtful_parameters(inspection);
    document["complete_model"] = {{"parameter_count", parameter_count(inspection.complete)},
                                  {"rank", inspection.of_complete.kept.size()}};
    document["calibrated_parameter_count"] = parameter_count(campaign);
    document["least_pose_count"] = inspection.least_pose_count;
    document["unknowable"] = {
        {"parameters", inspection.unknowable.parameters},
        {"cures", make_list(inspection.unknowable.cures, [](const KnownAxes& known) {
             return Json{{"base", known.base}, {"targets", known.targets}};
         })}};
    document["on_axis"] = make_list(inspection.on_axis, [](const OnAxis& one) {
        return Json{{"target", one.target + 1}, {"joint", one.joint}};
    });
    document["rounded_angle_count"] = inspection.rounded_angle_count;
    return document;
}

// ---- indices ----

Json indices_to_json(const Indices& indices) {
    Json json;
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        json[std::string(criterion_name(all_criteria[i]))] = indices.values[i];
    }
    json["condition"] = indices.condition;
    return json;
}

Json direction_to_json(const WeakDirection& direction, const Campaign& campaign) {
    const std::vector<std::string> names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    const VectorXd scale = parameter_scale(campaign);
    return {{"singular_value", direction.singular_value},
            {"terms", make_list(direction.terms, [&](const ParameterTerm& term) {
                 const auto k = static_cast<std::size_t>(term.parameter);
                 return Json{{"parameter", names[k]},
                             {"error" + detail::error_suffix(*units[k]),
                              mm_per_m * term.coefficient * scale[term.parameter]}};
             })}};
}

// ---- study ----

Json advantage_to_json(const Advantage& advantage) {
    return {{"ratio", advantage.ratio},
            {"lower", advantage.lower},
            {"upper", advantage.upper},
            {"left_out", advantage.left_out},
            {"verdict", verdict_name(verdict_of(advantage))}};
}

/// `first` is the same row of the first error model.
Json planned_to_json(const Study& study, const StudyRow& row, const StudyRow& first) {
    const std::string unit = detail::error_suffix(*study.units);
    Json list = Json::array();
    for (std::size_t c = 0; c < study.criteria.size(); ++c) {
        const auto cases = planned_cases(row, c, study.criteria.size());
        Json& json = list.emplace_back();
        json["criterion"] = criterion_name(study.criteria[c]);
        json["held_out_rms" + unit] = detail::millimetres(held_out_quantile(cases, 0.5));
        json["held_out_rms_p10" + unit] = detail::millimetres(held_out_quantile(cases, 0.1));
        json["held_out_rms_p90" + unit] = detail::millimetres(held_out_quantile(cases, 0.9));
        json["expected_rms" + unit] = detail::millimetres(median_expected(cases));
        if (const auto advantage = planned_advantage(study, row, c)) {
            json["against_random"] = advantage_to_json(*advantage);
        }
        if (&row == &first) continue;
        if (const auto advantage = planned_advantage(study, row, c, first)) {
            json["against_random_of_first_model"] = advantage_to_json(*advantage);
        }
    }
    return list;
}

Json study_row_to_json(const Study& study, const StudyRow& row, const StudyRow& first) {
    const std::string unit = detail::error_suffix(*study.units);
    const auto quantile = [&](double p) {
        return detail::millimetres(held_out_quantile(row.random, p));
    };
    const Index splits = study.splits > 0 ? split_count(row, study.criteria.size()) : 0;
    return {{"pose_count", row.pose_count},
            {"splits", splits},
            {"planned", planned_to_json(study, row, first)},
            {"random",
             {{"subsets", row.random.size()},
              {"unidentified", count_unidentified(row.random)},
              {"held_out_rms_p10" + unit, quantile(0.1)},
              {"held_out_rms_p50" + unit, quantile(0.5)},
              {"held_out_rms_p90" + unit, quantile(0.9)}}}};
}

// ---- correct ----

Json pose_error_to_json(const std::vector<Correction>& corrections,
                        const PoseError Correction::*error) {
    double positions = 0, orientations = 0, farthest = 0, widest = 0;
    for (const Correction& correction : corrections) {
        const PoseError& one = correction.*error;
        positions += one.position * one.position;
        orientations += one.orientation * one.orientation;
        farthest = std::max(farthest, one.position);
        widest = std::max(widest, one.orientation);
    }
    const auto count = static_cast<double>(corrections.size());
    return {{"position_rms_mm", mm_per_m * std::sqrt(positions / count)},
            {"position_max_mm", mm_per_m * farthest},
            {"orientation_rms_mrad", mrad_per_rad * std::sqrt(orientations / count)},
            {"orientation_max_mrad", mrad_per_rad * widest}};
}

Json correction_to_json(const std::string& id, const Correction& correction,
                        const Campaign& campaign) {
    Json json = {{"id", id}};
    const std::vector<std::string> columns = detail::reading_columns(campaign);
    for (std::size_t j = 0; j < columns.size(); ++j) {
        const auto joint = static_cast<Index>(j);
        json["joints"][columns[j]] = detail::for_people(campaign, joint, correction.joints[joint]);
    }
    json["residual_mm"] = mm_per_m * correction.residual.position;
    json["residual_mrad"] = mrad_per_rad * correction.residual.orientation;
    json["uncorrected_mm"] = mm_per_m * correction.uncorrected.position;
    json["uncorrected_mrad"] = mrad_per_rad * correction.uncorrected.orientation;
    json["note"] = describe_shortfall(campaign.robot, correction);
    return json;
}

// ---- export ----

Json urdf_to_json(const CalibratedUrdf& urdf) {
    return {{"joints", make_list(urdf.changes,
                                 [](const OriginChange& change) {
                                     return Json{{"name", change.joint},
                                                 {"moved_mm", mm_per_m * change.translation},
                                                 {"turned_mrad", mrad_per_rad * change.rotation}};
                                 })},
            {"not_expressed", urdf.not_expressed}};
}

Json dh_row_to_json(const DhRow& row, const Chain& robot) {
    return {{"a_mm", mm_per_m * row.a},
            {"alpha_deg", to_degrees(row.alpha)},
            {"d_mm", mm_per_m * row.d},
            {"theta_deg", to_degrees(row.theta)},
            {"beta_deg", to_degrees(row.beta)},
            {"drives", row.motion == Motion::Rotation ? "theta" : "d"},
            {"joints", joint_terms_to_json(row.joints, robot)}};
}

Json loss_to_json(const PositionLoss& lost) {
    return {{"rms_mm", mm_per_m * lost.rms}, {"largest_mm", mm_per_m * lost.largest}};
}

Json read_back_to_json(const ReadBack& file) {
    return {{"path", file.path},
            {"position_m", file.difference.position},
            {"orientation_rad", file.difference.orientation},
            {"configurations", file.difference.configuration_count}};
}

Json map_error_to_json(const MapError& error) {
    return {{"rms_mm", mm_per_m * error.rms},
            {"p95_mm", mm_per_m * error.p95},
            {"largest_mm", mm_per_m * error.largest},
            {"rms_mrad", mrad_per_rad * error.orientation}};
}

Json map_to_json(const CorrectionMap& map) {
    return {{"terms", map.terms.size()},
            {"configurations", map.pose_count},
            {"geometry_alone", map_error_to_json(map.geometry_alone)},
            {"with_map", map_error_to_json(map.with_map)}};
}

Json intrinsics_to_json(const Intrinsics& camera) {
    Json json;
    const VectorXd values = camera.values();
    const auto names = camera.names();
    for (std::size_t k = 0; k < names.size(); ++k) {
        const double value = values[static_cast<Index>(k)];
        const bool is_px = k < 4;
        json[is_px ? names[k] + "_px" : names[k]] = is_px ? pixel_units.to_reading(value) : value;
    }
    return json;
}

Json camera_to_json(const CameraPlaces& places) {
    Json json;
    json["on"] = places.is_on_flange ? "flange" : "base";
    json["place"] = detail::base_to_json(places.camera);
    json["board"] = detail::base_to_json(places.board);
    if (places.intrinsics) json["intrinsics"] = intrinsics_to_json(*places.intrinsics);
    for (const PlacedCamera& other : places.others) {
        json["others"].push_back({{"in_first", detail::base_to_json(other.in_first)},
                                  {"intrinsics", intrinsics_to_json(other.intrinsics)}});
    }
    return json;
}

}  // namespace

std::string with_sentences(const std::string& document, const std::vector<std::string>& warnings,
                           const std::optional<std::vector<Answer>>& answers) {
    Json json = Json::parse(document, nullptr, false);
    if (!json.is_object()) throw InputError("a document is not JSON; must be one of posewise");
    if (answers) json["answers"] = detail::answers_to_json(*answers);
    json["warnings"] = warnings;
    return detail::json_text(json);
}

std::string to_json(const Inspection& inspection) {
    return detail::json_text(inspection_to_json(inspection));
}

std::string to_json(const Inspection& inspection, const ReadingSearch& readings) {
    Json document = inspection_to_json(inspection);
    document["joint_directions"] = make_list(readings.tried, [](const TriedReading& tried) {
        Json one{{"read_with", tried.words},
                 {"reversed", tried.reversed},
                 {"distance_rms_mm", mm_per_m * tried.misfit.distance_rms}};
        const ReadingMisfit& misfit = tried.misfit;
        const bool are_pixels = misfit.orientation_units == &pixel_units;
        if (misfit.orientation_rms > 0) {
            one[are_pixels ? "reprojection_rms_px" : "orientation_rms_deg"] =
                misfit.orientation_reading();
        }
        return one;
    });
    if (readings.better) document["better_reading"] = detail::reading_to_json(*readings.better);
    return detail::json_text(document);
}

std::string to_json(const Rating& rating, const Campaign& campaign) {
    Json document = detail::make_document("indices");
    document["campaign"] = campaign.name;
    document["configurations"] = rating.configurations;
    document["parameters"] = rating.parameters;
    document["repeats"] = rating.repeats;
    document["prior"] = campaign.spread.is_prior;
    document["scaled"] = indices_to_json(rating.scaled);
    document["plain"] = indices_to_json(rating.plain);
    document["weakest_directions"] = make_list(rating.weakest, [&](const WeakDirection& direction) {
        return direction_to_json(direction, campaign);
    });
    return detail::json_text(document);
}

std::string to_json(const Verification& verification, const Plan& plan, const std::string& path) {
    Json document = detail::make_document("verification");
    document["plan_file"] = path;
    document["pose_count"] = plan.request.pose_count;
    document["candidate_count"] = verification.candidate_count;
    document["criterion"] = criterion_name(plan.request.criterion);
    document["is_right"] = verification.is_right();
    document["findings"] = make_list(verification.findings, [](const Finding& finding) {
        Json json = {{"name", finding.name}, {"is_right", finding.is_right}};
        if (finding.text.empty()) {
            json["stated"] = finding.stated;
            json["actual"] = finding.actual;
        } else {
            json["text"] = finding.text;
        }
        return json;
    });
    if (!verification.obstacle.empty()) document["obstacle"] = verification.obstacle;
    return detail::json_text(document);
}

std::string to_json(const std::vector<Study>& studies) {
    const Study& first = studies.front();
    Json document = detail::make_document("study");
    document["campaign"] = first.campaign;
    document["ending"] = ending_name(first.ending);
    document["splits"] = first.splits;
    document["judged_on"] = first.test_count;
    document["simulated"] = first.is_simulated;
    document["unit"] = first.units->error;
    document["models"] = make_list(studies, [&](const Study& study) {
        Json model = {{"name", study.model}, {"rows", Json::array()}};
        if (study.is_simulated) model["trials"] = study.splits;
        for (std::size_t i = 0; i < study.rows.size(); ++i) {
            model["rows"].push_back(study_row_to_json(study, study.rows[i], first.rows[i]));
        }
        return model;
    });
    return detail::json_text(document);
}

std::string to_json(const Simulation& simulation, const Campaign& campaign) {
    Json document = detail::make_document("simulation");
    document["campaign"] = campaign.name;
    document["configurations"] = simulation.measurements.configuration_count();
    document["samples"] = simulation.measurements.observations.rows();
    document["truth"] = detail::parameters_to_json(campaign, simulation.truth);
    return detail::json_text(document);
}

std::string to_json(const CorrectedPoses& poses, const Campaign& campaign,
                    const std::vector<long>& left) {
    Json document = detail::make_document("correction");
    document["campaign"] = campaign.name;
    document["uncorrected"] = pose_error_to_json(poses.corrections, &Correction::uncorrected);
    document["corrected"] = pose_error_to_json(poses.corrections, &Correction::residual);
    document["not_brought_home"] = Json::array();
    for (const Index i : poses.not_home) {
        document["not_brought_home"].push_back(poses.ids[static_cast<std::size_t>(i)]);
    }
    document["lines_not_corrected"] = left;
    Json& list = document["configurations"] = Json::array();
    for (std::size_t i = 0; i < poses.ids.size(); ++i) {
        list.push_back(correction_to_json(poses.ids[i], poses.corrections[i], campaign));
    }
    return detail::json_text(document);
}

std::string to_json(const ExportedRobot& robot, const Campaign& campaign) {
    const Geometry& written = robot.written();
    Json document = detail::make_document("export");
    document["campaign"] = campaign.name;
    document["geometry"] = robot.is_nearest ? "nearest" : "estimate";
    document["lost"]["nominal"] = loss_to_json(robot.nominal);
    document["lost"]["estimate"] = loss_to_json(robot.estimated.lost);
    if (robot.nearest) document["lost"]["nearest"] = loss_to_json(robot.nearest->lost);
    document["base"] = detail::base_to_json(written.world_from_base);
    document["targets_m"] = make_list(
        written.targets, [](const Vector3d& target) { return detail::vector_to_json(target); });
    if (written.tool) document["tool"] = detail::base_to_json(*written.tool);
    if (robot.urdf) document["urdf"] = urdf_to_json(*robot.urdf);
    if (!robot.dh.empty()) {
        document["dh"] = make_list(
            robot.dh, [&](const DhRow& row) { return dh_row_to_json(row, campaign.robot); });
    }
    if (robot.frames) document["ur_kinematics"] = make_list(*robot.frames, detail::base_to_json);
    document["not_exported"] = robot.terms;
    if (robot.map) document["map"] = map_to_json(*robot.map);
    if (robot.camera) document["camera"] = camera_to_json(*robot.camera);
    document["read_back"] = make_list(robot.read_back, read_back_to_json);
    return detail::json_text(document);
}

}  // namespace posewise::io
