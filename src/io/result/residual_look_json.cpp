#include "residual_look_json.hpp"

#include "posewise/core/types.hpp"

namespace posewise::detail {
namespace {

/// Numbers before and after, in mm or mrad.
Json change_to_json(const HeldOutChange& change, const AmountUnits& units) {
    return {{"before" + error_suffix(units), mm_per_m * change.before},
            {"after" + error_suffix(units), mm_per_m * change.after}};
}

Json outlying_to_json(const OutlyingConfigurations& outlying, const AmountUnits& units) {
    Json json = {{"configurations", outlying.ids},
                 {"squares_left", outlying.squares_left},
                 {"held_out", change_to_json(outlying.held_out, units)}};
    if (const auto& pair = outlying.exchanged) json["exchanged"] = {pair->first, pair->second};
    return json;
}

Json set_up_change_to_json(const SetUpChange& change, const AmountUnits& units) {
    return {{"part", change.part},
            {"is_gradual", change.is_gradual},
            {"last_before", change.last_before},
            {"first_after", change.first_after},
            {"translation_mm", vector_to_json(mm_per_m * change.translation)},
            {"rotation_mrad", vector_to_json(1e3 * change.rotation)},
            {"excluded", change.excluded},
            {"held_out", change_to_json(change.held_out, units)}};
}

Json joint_to_json(const JointPattern& pattern, const AmountUnits& units) {
    Json json = {{"joint", pattern.joint}, {"held_out", change_to_json(pattern.held_out, units)}};
    if (pattern.kind == JointPattern::Kind::Scale) {
        json["scale"] = pattern.size;
    } else {
        json["backlash" + error_suffix(pattern.is_angle)] = mm_per_m * pattern.size;
    }
    return json;
}

}  // namespace

Json look_to_json(const ResidualLook& look, const AmountUnits& units) {
    Json json = Json::object();
    if (look.outlying) json["outlying"] = outlying_to_json(*look.outlying, units);
    for (const SetUpChange& change : look.changes) {
        json["changes"].push_back(set_up_change_to_json(change, units));
    }
    if (const auto& lengths = look.lengths; lengths && lengths->errors) {
        json["lengths"] = {{"excess", lengths->excess},
                           {"deviation", lengths->deviation},
                           {"errors_before", lengths->errors->before},
                           {"errors_after", lengths->errors->after}};
    }
    for (const JointPattern& joint : look.joints) {
        json["joints"].push_back(joint_to_json(joint, units));
    }
    if (const auto& rounded = look.rounded) {
        json["rounded"] = {{"step_deg", to_degrees(rounded->step)},
                           {"effect" + error_suffix(units), mm_per_m * rounded->effect},
                           {"held_out", change_to_json(rounded->held_out, units)}};
    }
    if (const auto& rounded = look.rounded_readings) {
        json["rounded_readings"] = {{"step_mm", mm_per_m * rounded->step},
                                    {"effect_mm", mm_per_m * rounded->effect},
                                    {"left_mm", mm_per_m * rounded->left}};
    }
    if (const auto& shifted = look.shifted) {
        json["shifted"] = {{"first", shifted->first},
                           {"shift", shifted->shift},
                           {"median", change_to_json({shifted->before, shifted->after}, units)}};
    }
    return json;
}

}  // namespace posewise::detail
