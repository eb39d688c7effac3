#include "io/format/json.hpp"
#include "posewise/io/documents.hpp"

namespace posewise::io {
namespace {

using detail::Json;

Json band_to_json(const RandomBand& band) {
    Json json = {{"subsets", band.subsets}, {"unidentified", band.unidentified}};
    if (band.subsets == 0) return json;
    json["value_p5"] = band.p5.value;
    json["value_p50"] = band.p50.value;
    json["value_p95"] = band.p95.value;
    json["efficiency_p5"] = band.p5.efficiency;
    json["efficiency_p50"] = band.p50.efficiency;
    json["efficiency_p95"] = band.p95.efficiency;
    return json;
}

Json study_row_to_json(const BlocksStudy& study, const BlocksStudyRow& row) {
    const Choice& chosen = row.chosen;
    Json json = {{"pose_count", row.pose_count},    {"criterion", criterion_name(row.criterion)},
                 {"value", chosen.value},           {"bound", chosen.bound},
                 {"efficiency", chosen.efficiency}, {"ending", ending_name(chosen.ending)},
                 {"poses", chosen.poses},           {"random", band_to_json(row.random)},
                 {"subsets", Json::array()}};
    for (const auto& [number, found] : row.own) {
        json["subsets"].push_back({{"name", study.subsets[number].name},
                                   {"value", found.value},
                                   {"efficiency", found.efficiency}});
    }
    return json;
}

Json values_to_json(const Indices& indices) {
    Json json;
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        json[std::string(criterion_name(all_criteria[i]))] = indices.values[i];
    }
    json["condition"] = indices.condition;
    return json;
}

}  // namespace

std::string to_json(const BlocksStudy& study) {
    Json document = detail::make_document("blocks study");
    document["campaign"] = nullptr;
    document["ending"] = ending_name(study.ending);
    document["candidate_count"] = study.candidate_count;
    document["parameter_count"] = study.parameter_count;
    document["prior"] = study.request.has_prior;
    document["repeat_limit"] = study.request.repeat_limit;
    document["excluded"] = study.request.excluded;
    document["seed"] = study.request.seed.value();
    Json& rows = document["rows"] = Json::array();
    for (const BlocksStudyRow& row : study.rows) rows.push_back(study_row_to_json(study, row));
    return detail::json_text(document);
}

std::string to_json(const Rating& rating, const std::vector<std::string>& names, bool has_prior) {
    Json document = detail::make_document("indices");
    document["campaign"] = nullptr;
    document["configurations"] = rating.configurations;
    document["parameters"] = rating.parameters;
    document["repeats"] = rating.repeats;
    document["prior"] = has_prior;
    document["scaled"] = values_to_json(rating.scaled);
    document["plain"] = values_to_json(rating.plain);
    Json& directions = document["weakest_directions"] = Json::array();
    for (const WeakDirection& direction : rating.weakest) {
        Json terms = Json::array();
        for (const ParameterTerm& term : direction.terms) {
            terms.push_back({{"parameter", names[static_cast<std::size_t>(term.parameter)]},
                             {"coefficient", term.coefficient}});
        }
        directions.push_back({{"singular_value", direction.singular_value}, {"terms", terms}});
    }
    return detail::json_text(document);
}

}  // namespace posewise::io
