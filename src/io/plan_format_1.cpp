#include "plan_format.hpp"

namespace posewise::detail {
namespace {

/// Copies what is there.
void move_keys(const Json& from, Json& to,
               const std::vector<std::pair<const char*, const char*>>& keys) {
    if (!from.is_object()) return;
    for (const auto& [old_key, key] : keys) {
        if (const auto found = from.find(old_key); found != from.end()) to[key] = *found;
    }
}

Json part(const Json& object, const char* key) {
    return object.is_object() && object.contains(key) ? object[key] : Json();
}

Json upgrade_candidates(const Json& asked, const Json& pool) {
    Json candidates = {{"kind", "pool"}};
    move_keys(asked, candidates,
              {{"campaign_file", "campaign_file"}, {"pool", "drawn"}, {"repeats", "repeats"}});
    move_keys(pool, candidates, {{"feasible", "count"}});
    candidates["source"] = nullptr;
    return candidates;
}

Json upgrade_poses(const Json& old) {
    Json poses = old;
    if (!poses.is_array()) return poses;
    for (Json& pose : poses) {
        if (pose.is_object()) pose["times"] = 1;
    }
    return poses;
}

}  // namespace

Json upgrade_pose_plan(const Json& old) {
    const Json asked = part(old, "asked_for");
    const Json poses = part(old, "poses");
    Json plan = {{"kind", "posewise plan"}, {"format", plan_format}};
    move_keys(old, plan, {{"campaign", "campaign"}});
    plan["candidates"] = upgrade_candidates(asked, part(part(old, "bounds"), "pool"));
    Json& problem = plan["problem"] = Json::object();
    problem["pose_count"] = poses.size();
    move_keys(asked, problem,
              {{"prior", "prior"},
               {"focus", "focus"},
               {"augment", "augment"},
               {"repaired_plan", "repaired_plan"},
               {"dropped", "dropped"},
               {"workspace", "workspace"},
               {"workspace_poses", "workspace_poses"},
               {"workspace_box_mm", "workspace_box_mm"},
               {"workspace_target", "workspace_target"},
               {"time_limit_s", "time_limit_s"}});
    move_keys(old, plan, {{"criterion", "criterion"}, {"value", "value"}, {"bounds", "bounds"}});
    Json& search = plan["search"] = Json::object();
    move_keys(asked, search, {{"seed", "seed"}, {"starts", "starts"}});
    move_keys(old, search, {{"starts_at_best", "starts_at_best"}});
    const Json interrupted = part(old, "is_interrupted");
    if (interrupted.is_boolean()) {
        search["stop_reason"] = interrupted.get<bool>() ? "interrupted" : "converged";
    }
    move_keys(old, plan,
              {{"predicted", "predicted"},
               {"visiting_time_s", "visiting_time_s"},
               {"assumes", "assumes"}});
    if (old.contains("poses")) plan["poses"] = upgrade_poses(poses);
    return plan;
}

}  // namespace posewise::detail
