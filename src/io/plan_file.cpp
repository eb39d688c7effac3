#include "posewise/io/plan_file.hpp"

#include <map>

#include "json.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::io {
namespace {

Json pose_to_json(const Campaign& campaign, const Measurements& candidates, Index pose) {
    Json entry;
    entry["id"] = candidates.ids[static_cast<std::size_t>(pose)];
    Json& joints = entry["joints"];
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        const bool turns = campaign.robot.joint_motion(j) == Motion::Rotation;
        joints[campaign.robot.joints()[static_cast<std::size_t>(j)].name + si_suffix(turns)] =
            candidates.configurations(pose, j);
    }
    return entry;
}

/// `path: poses[2].id: problem`, counted from 0 as in JSON.
InputError error_at(const std::string& path, const std::string& place, const std::string& problem) {
    return input_error_at({path}, place + ": " + problem);
}

}  // namespace

void write_plan(const std::string& path, const Plan& plan, const Campaign& campaign,
                const Measurements& candidates, const std::string& source) {
    Json document = make_document("plan");
    document["campaign"] = campaign.name;
    document["candidates"] = {{"source", source}, {"count", candidates.configuration_count()}};
    document["criterion"] = criterion_name(plan.criterion);
    document["value"] = plan.value;
    document["bound"] = plan.bound;
    document["efficiency"] = plan.efficiency;
    document["search"] = {{"seed", plan.seed},
                          {"starts", plan.starts},
                          {"starts_at_best", plan.starts_at_best},
                          {"stop_reason", stop_reason_name(plan.stop_reason)}};
    document["assumes"] = assumptions_to_json(campaign);
    Json& poses = document["poses"] = Json::array();
    for (const Index pose : plan.poses) poses.push_back(pose_to_json(campaign, candidates, pose));
    write_json(path, document);
}

std::vector<std::string> read_plan_ids(const std::string& path) {
    const Json document = read_document(path, "plan");
    const auto poses = document.find("poses");
    if (poses == document.end() || !poses->is_array() || poses->empty()) {
        throw error_at(path, "poses", "must be a list of at least one pose");
    }
    std::vector<std::string> ids;
    std::map<std::string, std::string> places;
    for (const Json& pose : *poses) {
        const std::string place = "poses[" + std::to_string(ids.size()) + "]";
        if (!pose.is_object()) throw error_at(path, place, "must be an object with an id");
        const auto id = pose.find("id");
        if (id == pose.end()) throw error_at(path, place + ".id", "is missing; must be text");
        if (!id->is_string()) {
            throw error_at(path, place + ".id",
                           std::string("is of type ") + id->type_name() + "; must be text");
        }
        ids.push_back(id->get<std::string>());
        const auto [first, is_new] = places.emplace(ids.back(), place);
        if (!is_new) {
            throw error_at(path, place + ".id",
                           "'" + ids.back() + "' occurs before in " + first->second + "; keep one");
        }
    }
    return ids;
}

}  // namespace posewise::io
