#include <fmt/format.h>

#include <iterator>

#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/json.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::Json;

Json design_to_json(const ApproximateDesign& design) {
    const PlanRequest& request = design.request;
    Json document = detail::make_document("weights");
    document["campaign"] = design.campaign.empty() ? Json(nullptr) : Json(design.campaign);
    document["criterion"] = criterion_name(request.criterion);
    document["pose_count"] = request.pose_count;
    document["repeat_limit"] = request.repeat_limit;
    document["prior"] = request.has_prior;
    document["seed"] = request.seed.value();
    document["candidate_count"] = design.candidate_count;
    document["value"] = design.value;
    document["bound"] = design.bound;
    document["efficiency"] = design.efficiency;
    document["ending"] = ending_name(design.ending);
    Json& weights = document["weights"] = Json::array();
    for (const auto& [id, weight] : design.weights) {
        weights.push_back({{"id", id}, {"weight", weight}});
    }
    return document;
}

}  // namespace

std::string to_json(const ApproximateDesign& design) {
    return detail::json_text(design_to_json(design));
}

void write_weights(const std::string& path, const ApproximateDesign& design,
                   const std::vector<std::string>& warnings) {
    if (path.ends_with(".json")) {
        Json document = design_to_json(design);
        document["warnings"] = warnings;
        return detail::write_json(path, document);
    }
    if (!path.ends_with(".csv")) throw input_error_at({path}, "must end in .csv or .json");
    std::string text = "config,weight\n";
    for (const auto& [id, weight] : design.weights) {
        fmt::format_to(std::back_inserter(text), "{},{}\n", detail::csv_field(id), weight);
    }
    detail::write_file(path, text);
}

}  // namespace posewise::io
