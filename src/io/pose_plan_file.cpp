#include "posewise/io/pose_plan_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <map>

#include "csv_reader.hpp"
#include "json_reader.hpp"
#include "measurement_columns.hpp"
#include "plan_paths.hpp"
#include "posewise/core/text.hpp"
#include "posewise/io/atomic_file.hpp"

namespace posewise::io {
namespace {

constexpr const char* kind = "pose plan";

bool turns(const Campaign& campaign, Index joint) {
    return campaign.robot.joint(joint).motion == Motion::Rotation;
}

const std::string& joint_name(const Campaign& campaign, Index joint) {
    return campaign.robot.joints()[static_cast<std::size_t>(joint)].name;
}

Json joints_to_json(const Campaign& campaign, const VectorXd& q) {
    Json json;
    for (Index j = 0; j < q.size(); ++j) {
        json[joint_name(campaign, j) + si_suffix(turns(campaign, j))] = q[j];
    }
    return json;
}

Json pose_to_json(const Campaign& campaign, const ContinuousPose& pose) {
    Json json = {{"id", pose.id}, {"joints", joints_to_json(campaign, pose.joints)}};
    for (Index j = 0; j < pose.joints.size(); ++j) {
        const AmountUnits& units = units_of(campaign.robot.joint(j).motion);
        json["readable"][fmt::format("{}_{}", joint_name(campaign, j), units.reading)] =
            std::round(1e4 * for_people(campaign, j, pose.joints[j])) / 1e4;
    }
    json["visible_targets"] = Json::array();
    for (const Index target : pose.visible) json["visible_targets"].push_back(target + 1);
    json["via"] = pose.via ? joints_to_json(campaign, *pose.via) : Json(nullptr);
    json["way_is_blocked"] = pose.is_blocked;
    json["kept"] = pose.is_kept;
    return json;
}

Json request_to_json(const PosePlanRequest& request, const std::string& plan_path) {
    return {{"campaign_file", path_to_json(request.campaign, plan_path)},
            {"prior", request.has_prior},
            {"focus", request.is_focused_on_robot ? "robot" : "all"},
            {"augment", path_to_json(request.augment, plan_path)},
            {"repaired_plan", path_to_json(request.repaired, plan_path)},
            {"dropped", request.dropped},
            {"workspace", path_to_json(request.workspace, plan_path)},
            {"workspace_poses", request.workspace_count},
            {"workspace_box_mm", request.workspace_box_mm},
            {"workspace_target", request.workspace_target},
            {"pool", request.pool_count},
            {"starts", request.starts},
            {"repeats", request.repeats},
            {"time_limit_s", request.time_limit},
            {"seed", request.seed}};
}

Json bounds_to_json(const PosePlanFile& file) {
    return {{"pool",
             {{"feasible", file.feasible_count},
              {"value", file.pool_value},
              {"bound", file.pool_bound},
              {"efficiency", file.pool_efficiency},
              {"is_proven", true}}},
            {"continuous",
             {{"bound", file.searched_bound},
              {"efficiency", file.searched_efficiency},
              {"is_proven", false}}}};
}

Json deviations_to_json(const Campaign& campaign, const VectorXd& deviations) {
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    Json json;
    for (Index k = 0; k < deviations.size(); ++k) {
        const auto i = static_cast<std::size_t>(k);
        json[names[i] + si_suffix(is_angle[i])] = deviations[k];
    }
    return json;
}

ContinuousPose read_pose(const JsonValue& json, const Campaign& campaign) {
    ContinuousPose pose;
    pose.id = json["id"].text();
    pose.joints.resize(campaign.robot.joint_count());
    const JsonValue joints = json["joints"];
    for (Index j = 0; j < pose.joints.size(); ++j) {
        pose.joints[j] = joints[joint_name(campaign, j) + si_suffix(turns(campaign, j))].number();
    }
    if (static_cast<Index>(joints.values().size()) != pose.joints.size()) {
        throw joints.error(fmt::format("has {} joints, the campaign's robot has {}",
                                       joints.values().size(), pose.joints.size()));
    }
    const Index targets = campaign.sensor->target_count();
    for (const JsonValue& target : json["visible_targets"].list()) {
        const Index number = target.count(1);
        if (number > targets) {
            throw target.error(fmt::format("is {}, the campaign has {} targets", number, targets));
        }
        pose.visible.push_back(number - 1);
    }
    return pose;
}

std::vector<ContinuousPose> read_poses(const JsonValue& json, const Campaign& campaign) {
    std::vector<ContinuousPose> poses;
    std::map<std::string, std::size_t> places;
    for (const JsonValue& item : json.list()) {
        ContinuousPose pose = read_pose(item, campaign);
        const auto [first, is_new] = places.emplace(pose.id, poses.size());
        if (!is_new) {
            throw item["id"].error(fmt::format("{} occurs before in poses[{}]; keep one",
                                               quote(pose.id), first->second));
        }
        poses.push_back(std::move(pose));
    }
    if (poses.empty()) throw json.error("is empty; must hold at least one pose");
    return poses;
}

}  // namespace

void write_pose_plan(const std::string& path, const PosePlanFile& file, const Campaign& campaign) {
    Json document = make_document(kind);
    document["campaign"] = campaign.name;
    document["asked_for"] = request_to_json(file.request, path);
    document["criterion"] = criterion_name(file.request.criterion);
    document["value"] = file.value;
    document["bounds"] = bounds_to_json(file);
    document["starts_at_best"] = file.starts_at_best;
    document["is_interrupted"] = file.is_interrupted;
    document["predicted"] = {
        {"position_error_rms_m", file.predicted_rms},
        {"position_error_p95_m", file.predicted_p95},
        {"standard_deviation", deviations_to_json(campaign, file.standard_deviations)}};
    document["visiting_time_s"] = file.visiting_time;
    document["assumes"] = assumptions_to_json(campaign);
    Json& poses = document["poses"] = Json::array();
    for (const ContinuousPose& pose : file.poses) poses.push_back(pose_to_json(campaign, pose));
    write_json(path, document);
}

bool is_pose_plan(const std::string& path) { return is_document_of(path, kind); }

PosePlanRequest read_pose_plan_request(const std::string& path) {
    const Json json = read_document(path, kind);
    const JsonValue document(json, path);
    const JsonValue asked = document["asked_for"];
    PosePlanRequest request;
    request.campaign = read_path(asked["campaign_file"], path);
    try {
        request.criterion = parse_criterion(document["criterion"].text());
    } catch (const InputError& problem) {
        throw document["criterion"].error(problem.what());
    }
    request.has_prior = asked["prior"].boolean();
    request.is_focused_on_robot = asked["focus"].text() == "robot";
    request.augment = read_path(asked["augment"], path);
    request.workspace = read_path(asked["workspace"], path);
    request.workspace_count = asked["workspace_poses"].count(1);
    for (const JsonValue& number : asked["workspace_box_mm"].list()) {
        request.workspace_box_mm.push_back(number.number());
    }
    if (request.workspace_box_mm.size() != 0 && request.workspace_box_mm.size() != 6) {
        throw asked["workspace_box_mm"].error("must have 6 numbers or none");
    }
    request.workspace_target = asked["workspace_target"].count(0);
    request.repeats = asked["repeats"].number();
    if (!(request.repeats >= 1)) throw asked["repeats"].error("must be at least 1");
    request.seed = asked["seed"].natural_number();
    return request;
}

PosePlanFile read_pose_plan(const std::string& path, const Campaign& campaign) {
    const Json json = read_document(path, kind);
    const JsonValue document(json, path);
    const std::string name = document["campaign"].text();
    if (name != campaign.name) {
        throw document["campaign"].error("is " + quote(name) + "; must be a plan of " +
                                         quote(campaign.name));
    }
    PosePlanFile file;
    file.request = read_pose_plan_request(path);
    file.poses = read_poses(document["poses"], campaign);
    file.value = document["value"].number();
    const JsonValue predicted = document["predicted"];
    file.predicted_rms = predicted["position_error_rms_m"].number();
    file.predicted_p95 = predicted["position_error_p95_m"].number();
    return file;
}

void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<ContinuousPose>& poses) {
    std::string text = fmt::format("config{},{}\n", joint_header(campaign), visible_targets);
    const auto out = std::back_inserter(text);
    for (const ContinuousPose& pose : poses) {
        text += csv_field(pose.id) + joint_cells(campaign, pose.joints);
        std::string targets;
        for (const Index target : pose.visible) {
            targets += (targets.empty() ? "" : " ") + std::to_string(target + 1);
        }
        fmt::format_to(out, ",{}\n", targets);
    }
    write_file(path, text);
}

}  // namespace posewise::io
