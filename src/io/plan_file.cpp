#include "posewise/io/plan_file.hpp"

#include <algorithm>

#include "json.hpp"
#include "measurement_columns.hpp"
#include "plan_names.hpp"
#include "plan_paths.hpp"

namespace posewise::io {
namespace {

Json source_to_json(const PlanFile& file, const std::string& plan_path) {
    using Kind = CandidateSource::Kind;
    const CandidateSource& source = file.request.source;
    Json json;
    json["kind"] = std::find_if(source_kinds.begin(), source_kinds.end(), [&](const auto& entry) {
                       return entry.first == source.kind;
                   })->second;
    json["campaign_file"] = path_to_json(source.campaign, plan_path);
    json["source"] = path_to_json(source.path, plan_path);
    if (source.kind == Kind::Random) json["seed"] = source.seed;
    if (source.kind == Kind::Blocks) {
        json["rows_per_block"] = source.rows_per_block;
        json["variable"] = source.variable;
    }
    json["count"] = file.candidate_count;
    json["checksum"] = file.checksum;
    json["repeats"] = source.repeats;
    return json;
}

Json problem_to_json(const SelectionRequest& request, const std::string& plan_path) {
    return {{"pose_count", request.pose_count},
            {"prior", request.has_prior},
            {"focus", request.is_focused_on_robot ? "robot" : "all"},
            {"augment", path_to_json(request.augment, plan_path)},
            {"test_poses", path_to_json(request.test_poses, plan_path)},
            {"groups", path_to_json(request.groups, plan_path)},
            {"group_limit", request.group_limit},
            {"excluded", request.excluded},
            {"repeat_limit", request.repeat_limit},
            {"least_distance_rad", request.least_distance}};
}

/// The lower triangle: M is symmetric.
Json certificate_to_json(const Certificate& certificate) {
    Json rows = Json::array();
    for (Index i = 0; i < certificate.M.rows(); ++i) {
        Json row = Json::array();
        for (Index j = 0; j <= i; ++j) row.push_back(certificate.M(i, j));
        rows.push_back(std::move(row));
    }
    return {{"sharpness", certificate.sharpness}, {"M_lower", std::move(rows)}};
}

Json pose_to_json(const PlannedPose& pose, const Campaign* campaign) {
    Json json = {{"id", pose.id}, {"times", pose.times}};
    if (campaign == nullptr) return json;
    Json& joints = json["joints"];
    for (const WantedColumn& column : wanted_columns(*campaign)) {
        if (column.role != Role::Joint) continue;
        const bool is_length = column.quantity == Quantity::Length;
        joints[is_length ? column.stem + "_m" : column.example()] = pose.joints[column.index];
    }
    return json;
}

}  // namespace

void write_plan(const std::string& path, const PlanFile& file, const Campaign* campaign) {
    const Choice& plan = file.plan;
    Json document = make_document("plan");
    document["campaign"] = campaign != nullptr ? Json(campaign->name) : Json(nullptr);
    document["candidates"] = source_to_json(file, path);
    document["problem"] = problem_to_json(file.request, path);
    document["criterion"] = criterion_name(file.request.criterion);
    document["value"] = plan.value;
    document["bound"] = plan.bound;
    document["efficiency"] = plan.efficiency;
    document["search"] = {{"seed", plan.seed},
                          {"starts", plan.starts},
                          {"starts_at_best", plan.starts_at_best},
                          {"stop_reason", ending_name(plan.ending)}};
    if (campaign != nullptr) document["assumes"] = assumptions_to_json(*campaign);
    Json& poses = document["poses"] = Json::array();
    for (const PlannedPose& pose : file.poses) poses.push_back(pose_to_json(pose, campaign));
    document["certificate"] = certificate_to_json(plan.certificate);
    write_json(path, document);
}

}  // namespace posewise::io
