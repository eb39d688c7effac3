#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "json_reader.hpp"
#include "plan_names.hpp"
#include "plan_paths.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/io/pose_plan_file.hpp"

namespace posewise::io {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

CandidateSource read_source(const JsonValue& json, const std::string& plan_path) {
    using Kind = CandidateSource::Kind;
    CandidateSource source;
    const std::string kind = json["kind"].text();
    const auto found = std::find_if(source_kinds.begin(), source_kinds.end(),
                                    [&](const auto& entry) { return entry.second == kind; });
    if (found == source_kinds.end()) {
        throw json["kind"].error("is '" + kind +
                                 "'; must be measurements, configurations, random or blocks");
    }
    source.kind = found->first;
    source.campaign = read_path(json["campaign_file"], plan_path);
    source.path = read_path(json["source"], plan_path);
    source.count = json["count"].count(1);
    if (source.kind == Kind::Random) source.seed = json["seed"].natural_number();
    if (source.kind == Kind::Blocks) {
        source.rows_per_block = json["rows_per_block"].count(1);
        source.variable = json["variable"].text();
    }
    source.repeats = json["repeats"].number();
    if (!(source.repeats >= 1)) throw json["repeats"].error("must be at least 1");
    return source;
}

SelectionRequest read_request(const JsonValue& document, const std::string& plan_path) {
    SelectionRequest request;
    request.source = read_source(document["candidates"], plan_path);
    try {
        request.criterion = parse_criterion(document["criterion"].text());
    } catch (const InputError& problem) {
        throw document["criterion"].error(problem.what());
    }
    const JsonValue problem = document["problem"];
    request.pose_count = problem["pose_count"].count(1);
    request.has_prior = problem["prior"].boolean();
    const std::string focus = problem["focus"].text();
    if (focus != "all" && focus != "robot") throw problem["focus"].error("must be all or robot");
    request.is_focused_on_robot = focus == "robot";
    request.augment = read_path(problem["augment"], plan_path);
    request.test_poses = read_path(problem["test_poses"], plan_path);
    request.groups = read_path(problem["groups"], plan_path);
    request.group_limit = problem["group_limit"].count(0);
    for (const JsonValue& id : problem["excluded"].list()) request.excluded.push_back(id.text());
    request.repeat_limit = problem["repeat_limit"].count(1);
    request.least_distance = problem["least_distance_rad"].number();
    if (!(request.least_distance >= 0)) {
        throw problem["least_distance_rad"].error("must not be negative");
    }
    return request;
}

Certificate read_certificate(const JsonValue& json) {
    Certificate certificate;
    certificate.sharpness = json["sharpness"].number_or(infinity);
    const auto rows = json["M_lower"].list();
    const auto size = static_cast<Index>(rows.size());
    certificate.M.resize(size, size);
    for (Index i = 0; i < size; ++i) {
        const JsonValue& row = rows[static_cast<std::size_t>(i)];
        const auto numbers = row.list();
        if (static_cast<Index>(numbers.size()) != i + 1) {
            throw row.error("has " + std::to_string(numbers.size()) + " numbers; must have " +
                            std::to_string(i + 1) + ", the lower triangle");
        }
        for (Index j = 0; j <= i; ++j) {
            certificate.M(i, j) = certificate.M(j, i) =
                numbers[static_cast<std::size_t>(j)].number();
        }
    }
    return certificate;
}

Choice read_result(const JsonValue& document) {
    Choice plan;
    plan.criterion = parse_criterion(document["criterion"].text());
    plan.value = document["value"].number_or(-infinity);
    plan.bound = document["bound"].number_or(infinity);
    plan.efficiency = document["efficiency"].number();
    const JsonValue search = document["search"];
    plan.seed = search["seed"].natural_number();
    plan.starts = search["starts"].count(1);
    plan.starts_at_best = search["starts_at_best"].count(0);
    const std::string reason = search["stop_reason"].text();
    const auto found =
        std::find_if(stop_reasons.begin(), stop_reasons.end(),
                     [&](Ending known) { return ending_name(known) == reason; });
    if (found == stop_reasons.end()) {
        throw search["stop_reason"].error("is '" + reason + "', which is none of posewise");
    }
    plan.ending = *found;
    plan.certificate = read_certificate(document["certificate"]);
    return plan;
}

bool agree(double a, double b) {
    return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

/// The poses, each with its proper id, none twice.
std::vector<PlannedPose> read_poses(const Json& document, const std::string& path) {
    const auto found = document.find("poses");
    if (found == document.end() || !found->is_array() || found->empty()) {
        throw input_error_at({path}, "poses: must be a list of at least one pose");
    }
    std::vector<PlannedPose> poses;
    std::map<std::string, std::size_t> places;
    for (const JsonValue& json : JsonValue(*found, path, "poses").list()) {
        PlannedPose pose;
        pose.id = json["id"].text();
        if (json.has("times")) pose.times = json["times"].count(1);
        const auto [first, is_new] = places.emplace(pose.id, poses.size());
        if (!is_new) {
            throw json["id"].error("'" + pose.id + "' occurs before in poses[" +
                                   std::to_string(first->second) + "]; keep one");
        }
        if (json.has("joints")) {
            const auto joints = json["joints"].values();
            pose.joints.resize(static_cast<Index>(joints.size()));
            Index j = 0;
            for (const JsonValue& joint : joints) pose.joints[j++] = joint.number();
        }
        poses.push_back(std::move(pose));
    }
    return poses;
}

}  // namespace

PlanFile read_plan(const std::string& path) {
    const Json json = read_document(path, "plan");
    const JsonValue document(json, path);
    PlanFile file;
    file.poses = read_poses(json, path);
    for (const JsonValue& pose : document["poses"].list()) pose["times"].count(1);
    file.request = read_request(document, path);
    file.candidate_count = file.request.source.count;
    file.checksum = document["candidates"]["checksum"].text();
    file.plan = read_result(document);
    return file;
}

std::vector<PlannedPose> read_plan_poses(const std::string& path) {
    return read_poses(read_document(path, is_pose_plan(path) ? "pose plan" : "plan"), path);
}

std::vector<std::string> find_changed_assumptions(const std::string& path,
                                                  const Campaign& campaign) {
    const Json json = read_document(path, is_pose_plan(path) ? "pose plan" : "plan");
    JsonValue(json, path)["assumes"].values();  // an object
    const Json stated = json["assumes"].flatten();
    const Json actual = assumptions_to_json(campaign).flatten();
    std::vector<std::string> changed;
    for (const auto& [place, value] : actual.items()) {
        const Json other = stated.contains(place) ? stated[place] : Json();
        const bool is_same = other.is_number() && agree(value.get<double>(), other.get<double>());
        if (is_same) continue;
        changed.push_back(
            fmt::format("{}: stated {}, is {}", place.substr(1), other.dump(), value.dump()));
    }
    for (const auto& [place, value] : stated.items()) {
        if (place.empty() || actual.contains(place)) continue;
        changed.push_back(
            fmt::format("{}: stated {}, is not assumed", place.substr(1), value.dump()));
    }
    return changed;
}

}  // namespace posewise::io
