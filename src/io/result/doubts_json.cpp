#include "doubts_json.hpp"

#include <algorithm>
#include <cmath>

#include "core/names.hpp"
#include "posewise/core/types.hpp"
#include "residual_look_json.hpp"

namespace posewise::detail {
namespace {

/// Numbers of the planes, from 1.
Json planes_to_json(const std::vector<PlaneDoubt>& planes) {
    Json json = Json::array();
    for (const PlaneDoubt& doubt : planes) json.push_back(doubt.plane + 1);
    return json;
}

constexpr Names<PlaceDoubt::Unit, 3> place_units{{{PlaceDoubt::Unit::AsRead, "as read"},
                                                  {PlaceDoubt::Unit::Metres, "m"},
                                                  {PlaceDoubt::Unit::Millimetres, "mm"}}};

Json places_to_json(const std::vector<PlaceDoubt>& places) {
    Json json = Json::array();
    for (const PlaceDoubt& place : places) {
        json.push_back({{"what", place.name},
                        {"stated_mm", vector_to_json(mm_per_m * place.stated)},
                        {"measured_mm", vector_to_json(mm_per_m * place.found)},
                        {"unit", name_of(place_units, place.unit)}});
        if (!place.exchanged_with.empty()) json.back()["exchanged_with"] = place.exchanged_with;
        if (place.turn > 0) json.back()["turned_deg"] = to_degrees(place.turn);
    }
    return json;
}

Json sizes_to_json(const std::vector<SizeDoubt>& sizes) {
    Json json = Json::array();
    for (const SizeDoubt& size : sizes) {
        json.push_back({{"parameter", size.parameter},
                        {"value" + error_suffix(*size.units), mm_per_m * size.value},
                        {"times_expected", size.times}});
    }
    return json;
}

Json model_errors_to_json(const std::vector<ModelErrorDoubt>& errors) {
    Json json = Json::array();
    for (const ModelErrorDoubt& error : errors) {
        json.push_back({{"value" + error_suffix(error.is_angle), mm_per_m * error.value},
                        {"times_expected", error.times},
                        {"at_least", error.is_limit}});
    }
    return json;
}

Json views_to_json(const std::vector<ViewDoubt>& views) {
    Json json = Json::array();
    for (const ViewDoubt& view : views) {
        json.push_back(
            {{"sample", view.sample},
             {"camera", view.camera + 1},
             {"is_no_board", view.is_no_board},
             {"rms_px", std::isfinite(view.distance) ? Json(1e3 * view.distance) : Json()},
             {"others_rms_px", 1e3 * view.others}});
        if (!view.order.empty()) json.back()["order"] = view.order;
    }
    return json;
}

Json camera_to_json(const CameraDoubt& doubt) {
    Json json;
    if (doubt.sensor > 0) json["sensor"] = doubt.sensor;
    if (doubt.board_factor != 1) {
        json["board_factor"] = doubt.board_factor;
        json["rms_px"] = 1e3 * doubt.misfit;
        json["scaled_rms_px"] = 1e3 * doubt.scaled_misfit;
    }
    if (doubt.principal_point) {
        json["camera"] = doubt.camera + 1;
        json["principal_point_px"] = *doubt.principal_point;
        json["middle_px"] = doubt.middle;
    }
    if (doubt.focal_lengths) {
        json["camera"] = doubt.camera + 1;
        json["focal_lengths_px"] = *doubt.focal_lengths;
        if (const auto& stated = doubt.stated_focal_lengths) {
            json["stated_focal_lengths_px"] = *stated;
        }
    }
    if (doubt.is_seen_from_back) json["is_seen_from_back"] = true;
    if (doubt.scatter > 0) {
        json["scatter_px"] = doubt.scatter;
        json["sigma_px"] = doubt.sigma;
    }
    return json;
}

Json residuals_to_json(const Sensor& sensor, const std::vector<ResidualDoubt>& residuals) {
    Json json = Json::array();
    for (const ResidualDoubt& doubt : residuals) {
        json.push_back({{"ratio", doubt.ratio},
                        {"fitting_model_error" + error_suffix(sensor.units(doubt.is_angle)),
                         mm_per_m * doubt.fitting}});
    }
    return json;
}

}  // namespace

Json reading_to_json(const BetterReading& reading) {
    Json json{{"read_with", reading.words},
              {"cure", reading.cure},
              {"as_well", reading.as_well},
              {"rms_mm", mm_per_m * reading.misfit.distance_rms},
              {"as_stated_rms_mm", mm_per_m * reading.as_stated.distance_rms}};
    if (reading.as_stated.orientation_rms > 0) {
        const std::string unit = '_' + std::string(reading.misfit.orientation_units->reading);
        json["rms" + unit] = reading.misfit.orientation_reading();
        json["as_stated_rms" + unit] = reading.as_stated.orientation_reading();
    }
    return json;
}

Json doubts_to_json(const Campaign& campaign, const Doubts& doubts) {
    Json json = Json::object();
    if (const auto& misfit = doubts.misfit) {
        const std::string unit = error_suffix(campaign.sensor->main_units());
        json["misfit"] = {{"distance" + unit, mm_per_m * misfit->distance},
                          {"expected" + unit, mm_per_m * misfit->expected},
                          {"planes", planes_to_json(misfit->planes)}};
        if (misfit->camera || misfit->is_between_cameras) {
            json["misfit"]["others_px"] = 1e3 * misfit->others;
            json["misfit"]["is_between_cameras"] = misfit->is_between_cameras;
        }
        if (misfit->image) {
            json["misfit"]["image"] = misfit->image->words;
            json["misfit"]["with_image_px"] = 1e3 * misfit->image->distance;
        }
        if (misfit->on_other_side) {
            json["misfit"]["on_other_side_px"] = 1e3 * *misfit->on_other_side;
        }
        if (misfit->camera) json["misfit"]["camera"] = *misfit->camera + 1;
        if (const auto& reading = misfit->reading) {
            json["misfit"]["reversed"] = reading->reversed;
            json["misfit"]["reading"] = reading_to_json(*reading);
        }
    }
    if (!doubts.planes.empty()) json["planes"] = planes_to_json(doubts.planes);
    if (!doubts.places.empty()) json["places"] = places_to_json(doubts.places);
    if (doubts.gross_error) json["gross_error_mm"] = mm_per_m * *doubts.gross_error;
    if (doubts.orientations) {
        json["orientations"] = {{"rms_deg", to_degrees(*doubts.orientations)}};
    }
    if (!doubts.sizes.empty()) json["sizes"] = sizes_to_json(doubts.sizes);
    if (!doubts.learned_sizes.empty()) {
        json["learned_sizes"] = sizes_to_json(doubts.learned_sizes);
    }
    if (!doubts.model_errors.empty()) {
        json["model_errors"] = model_errors_to_json(doubts.model_errors);
    }
    if (const auto& scatter = doubts.scatter) {
        json["scatter"] = {{"ratio", scatter->ratio}, {"sample", scatter->sample}};
    }
    if (doubts.lacks_length) json["lacks_length"] = true;
    if (const auto& distance = doubts.distance) {
        json["distance"] = {{"socket", distance->socket},
                            {"from", distance->from},
                            {"stated_mm", mm_per_m * distance->stated},
                            {"measured_mm", mm_per_m * distance->found}};
    }
    if (!doubts.views.empty()) json["views"] = views_to_json(doubts.views);
    if (const auto& camera = doubts.camera) json["camera"] = camera_to_json(*camera);
    if (const auto& held_out = doubts.held_out) {
        const std::string unit = error_suffix(campaign.sensor->main_units());
        json["held_out"] = {{"calibrated" + unit, mm_per_m * held_out->calibrated},
                            {"nominal" + unit, mm_per_m * held_out->nominal},
                            {"rank_deviations", held_out->rank_deviations}};
    }
    if (const auto& workspace = doubts.workspace) {
        const std::string unit = error_suffix(campaign.sensor->main_units());
        json["workspace"] = {{"expected" + unit, mm_per_m * workspace->expected},
                             {"nominal" + unit, mm_per_m * workspace->nominal}};
    }
    if (!doubts.residuals.empty()) {
        const auto farthest = std::ranges::max(
            doubts.residuals, {},
            [](const ResidualDoubt& doubt) { return std::abs(std::log(doubt.ratio)); });
        json["residual_ratio"] = farthest.ratio;
        json["residuals"] = residuals_to_json(*campaign.sensor, doubts.residuals);
    }
    if (doubts.small_residuals) json["small_residuals"] = *doubts.small_residuals;
    if (doubts.missing_errors) json["missing_errors"] = *doubts.missing_errors;
    for (const Index joint : doubts.negative_compliances) {
        json["negative_compliances"].push_back(campaign.robot.joint(joint).name);
    }
    if (!doubts.look.is_empty()) {
        json["look"] = look_to_json(doubts.look, campaign.sensor->main_units());
    }
    return json;
}

Json cures_to_json(const Campaign& campaign, const Cures& cures) {
    const std::string unit = error_suffix(campaign.sensor->main_units());
    Json found = Json::array();
    for (const Cure& cure : cures.found) {
        found.push_back({{"option", spell(cure.remedy)},
                         {"held_out" + unit, mm_per_m * cure.after},
                         {"held_out_before" + unit, mm_per_m * cure.before}});
    }
    Json without_effect = Json::array();
    for (const Remedy& remedy : cures.without_effect) without_effect.push_back(spell(remedy));
    return {{"found", std::move(found)}, {"without_effect", std::move(without_effect)}};
}

}  // namespace posewise::detail
