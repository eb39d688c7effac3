#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/text.hpp"
#include "io/format/json_reader.hpp"
#include "plan_format.hpp"
#include "plan_paths.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::Json;
using detail::JsonValue;

constexpr double infinity = std::numeric_limits<double>::infinity();

// As much as the command line takes.
constexpr Index most_poses = 1000000;
constexpr Index most_continuous_poses = 10000;
constexpr Index most_drawn = 10000000;
constexpr Index most_workspace_poses = 20000;
constexpr Index most_targets = 10000;
constexpr Index most_starts = 1000000;
constexpr double most_repeats = 1e9;

double read_not_negative(const JsonValue& json) {
    const double value = json.number();
    if (!(value >= 0)) throw json.error("must not be negative");
    return value;
}

/// From 0 to 1, but for rounding.
double read_efficiency(const JsonValue& json) {
    constexpr double rounding = 1e-9;
    const double value = json.number();
    if (!(value >= 0 && value <= 1 + rounding)) throw json.error("must be from 0 to 1");
    return value;
}

// ---- What was asked for ----

CandidateKind read_kind(const JsonValue& json) {
    const std::string kind = json.text();
    if (const auto found = detail::find_named(detail::candidate_kinds, kind)) return *found;
    throw json.error("is '" + kind + "'; must be measurements, configurations, random or blocks");
}

void read_candidates(const JsonValue& json, const std::string& path, Plan& plan) {
    PlanRequest& request = plan.request;
    plan.kind = read_kind(json["kind"]);
    request.sources.campaign = read_path(json["campaign_file"], path);
    request.sources.candidates = read_path(json["source"], path);
    if (plan.kind == CandidateKind::Blocks) {
        request.sources.rows_per_block = json["rows_per_block"].count(1, most_poses);
        request.sources.variable = json["variable"].text();
    }
    if (plan.is_continuous()) {
        request.pool_count = json["drawn"].count(1, most_drawn);
    } else {
        plan.checksum = json["checksum"].text();
    }
    plan.candidate_count =
        json["count"].count(1, plan.is_continuous() ? request.pool_count : most_drawn);
    request.repeats = json["repeats"].number();
    if (!(request.repeats >= 1)) throw json["repeats"].error("must be at least 1");
    if (request.repeats > most_repeats) throw json["repeats"].error("must be at most 1e9");
}

void read_choice_limits(const JsonValue& problem, const std::string& path, PlanRequest& request) {
    request.sources.test_poses = read_path(problem["test_poses"], path);
    request.sources.groups = read_path(problem["groups"], path);
    request.group_limit = problem["group_limit"].count(0, most_poses);
    request.excluded = problem["excluded"].texts();
    request.repeat_limit = problem["repeat_limit"].count(1, most_poses);
    request.least_distance = read_not_negative(problem["least_distance_rad"]);
}

void read_workspace(const JsonValue& problem, const std::string& path, PlanRequest& request) {
    request.sources.repaired = read_path(problem["repaired_plan"], path);
    request.dropped = problem["dropped"].texts();
    request.sources.workspace = read_path(problem["workspace"], path);
    request.workspace_count = problem["workspace_poses"].count(1, most_workspace_poses);
    for (const JsonValue& number : problem["workspace_box_mm"].list()) {
        request.workspace_box_mm.push_back(number.number());
    }
    if (request.workspace_box_mm.size() != 0 && request.workspace_box_mm.size() != 6) {
        throw problem["workspace_box_mm"].error("must have 6 numbers or none");
    }
    request.workspace_target = problem["workspace_target"].count(0, most_targets);
    request.time_limit = read_not_negative(problem["time_limit_s"]);
    if (problem.has("verification_count")) {
        request.verification_count = problem["verification_count"].count(0, most_continuous_poses);
    }
}

double read_drift(const JsonValue& json) {
    const double drift = json.number();
    if (!(drift > 0)) throw json.error("must be above 0");
    return drift;
}

void read_earlier(const JsonValue& json, const std::string& path, PlanRequest& request) {
    request.sources.estimate = read_path(json["file"], path);
    EarlierUse& use = request.earlier;
    use.is_prior = json["as_prior"].boolean();
    use.only = json["only"].texts();
    for (const JsonValue& part : json["moved"].list()) {
        const std::string name = part.text();
        if (name != "base" && name != "targets") throw part.error("must be base or targets");
        (name == "base" ? use.has_new_base : use.has_new_targets) = true;
    }
    if (!use.is_prior) return;
    use.drift = {read_drift(json["drift_m"]), read_drift(json["drift_offset_rad"]),
                 read_drift(json["drift_rad"])};
}

void read_problem(const JsonValue& problem, const std::string& path, Plan& plan) {
    PlanRequest& request = plan.request;
    request.pose_count =
        problem["pose_count"].count(1, plan.is_continuous() ? most_continuous_poses : most_poses);
    request.has_prior = problem["prior"].boolean();
    const std::string focus = problem["focus"].text();
    if (focus != "all" && focus != "robot") throw problem["focus"].error("must be all or robot");
    request.is_focused_on_robot = focus == "robot";
    request.sources.augment = read_path(problem["augment"], path);
    if (problem.has("estimate")) read_earlier(problem["estimate"], path, request);
    if (plan.is_continuous()) {
        if (request.pose_count != static_cast<Index>(plan.poses.size())) {
            throw problem["pose_count"].error("is " + std::to_string(request.pose_count) +
                                              "; must be " + std::to_string(plan.poses.size()) +
                                              ", as many as there are poses");
        }
        read_workspace(problem, path, request);
    } else {
        read_choice_limits(problem, path, request);
    }
}

// ---- What was found ----

Certificate read_certificate(const JsonValue& json) {
    Certificate certificate;
    certificate.sharpness = json["sharpness"].number_or(infinity);
    if (!(certificate.sharpness > 0)) throw json["sharpness"].error("must be positive");
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

void read_bounds(const JsonValue& document, Plan& plan) {
    plan.value = document["value"].number_or(-infinity);
    if (!plan.is_continuous()) {
        plan.choice_value = plan.value;
        plan.bound = document["bound"].number_or(infinity);
        plan.efficiency = document["efficiency"].number();
        plan.certificate = read_certificate(document["certificate"]);
        return;
    }
    const JsonValue pool = document["bounds"]["pool"];
    plan.choice_value = pool["value"].number_or(-infinity);
    plan.bound = pool["bound"].number_or(infinity);
    plan.efficiency = read_efficiency(pool["efficiency"]);
    const JsonValue searched = document["bounds"]["continuous"];
    plan.searched_bound = searched["bound"].number_or(infinity);
    plan.searched_efficiency = read_efficiency(searched["efficiency"]);
    const JsonValue proof = searched["is_proven"];
    if (proof.boolean()) throw proof.error("is true; a bound that a search found is never proven");
}

void read_search(const JsonValue& search, Plan& plan) {
    plan.request.seed = search["seed"].natural_number();
    plan.request.starts = search["starts"].count(0, most_starts);
    plan.starts_at_best = search["starts_at_best"].count(0, plan.request.starts);
    if (search.has("tried")) plan.tried = search["tried"].count(0);
    if (search.has("proof_s")) plan.request.proof = read_not_negative(search["proof_s"]);
    const std::string reason = search["stop_reason"].text();
    const auto found = std::find_if(detail::plan_endings.begin(), detail::plan_endings.end(),
                                    [&](Ending known) { return ending_name(known) == reason; });
    if (found == detail::plan_endings.end()) {
        throw search["stop_reason"].error("is '" + reason + "', which is none of posewise");
    }
    plan.ending = *found;
    if (plan.is_continuous() && plan.ending == Ending::Optimal) {
        throw search["stop_reason"].error("is 'optimal', which of continuous poses nothing proves");
    }
}

std::vector<std::string> keys_of(const Json& object) {
    std::vector<std::string> keys;
    for (const auto& [key, unused] : object.items()) keys.push_back(key);
    return keys;
}

/// Names and numbers of an object and of the objects in it: "expected_error/dq2_rad".
std::vector<NamedNumber> read_numbers(const Json& json) {
    std::vector<NamedNumber> numbers;
    const Json flat = json.flatten();
    for (const auto& [place, value] : flat.items()) {
        if (place.empty()) continue;
        numbers.push_back({place.substr(1), value.is_number()
                                                ? value.get<double>()
                                                : std::numeric_limits<double>::quiet_NaN()});
    }
    return numbers;
}

void read_prediction(const JsonValue& document, const Json& json, Plan& plan) {
    const JsonValue predicted = document["predicted"];
    plan.predicted.emplace();
    plan.predicted->rms = predicted["position_error_rms_m"].number();
    plan.predicted->percentile95 = predicted["position_error_p95_m"].number();
    const auto values = predicted["standard_deviation"].values();
    const auto names = keys_of(json["predicted"]["standard_deviation"]);
    for (std::size_t k = 0; k < names.size(); ++k) {
        plan.standard_deviations.push_back({names[k], values[k].number_or(infinity)});
    }
    const JsonValue time = document["visiting_time_s"];
    plan.visiting_time = time.is_null() ? infinity : read_not_negative(time);
}

// ---- The poses ----

VectorXd read_configuration(const JsonValue& json) {
    const auto numbers = json.values();
    VectorXd q(static_cast<Index>(numbers.size()));
    Index j = 0;
    for (const JsonValue& number : numbers) q[j++] = number.number();
    return q;
}

/// Degrees and mm beside the joints are for people, who must not be sent elsewhere.
void check_readable(const JsonValue& readable, const JsonValue& joints) {
    constexpr double rounding = 1e-3;  // deg or mm
    const std::vector<std::string> columns = keys_of(joints.json());
    const auto values = joints.values();
    for (std::size_t j = 0; j < columns.size(); ++j) {
        const auto readable_value = detail::readable_joint(columns[j], values[j].number());
        if (!readable_value) continue;
        const JsonValue stated = readable[readable_value->name];
        if (std::abs(stated.number() - readable_value->value) <= rounding) continue;
        throw stated.error(
            fmt::format("is {}, but joints.{} says {:.4f}; must be the same, or readable left out",
                        stated.number(), columns[j], readable_value->value));
    }
}

PlannedPose read_pose(const JsonValue& json) {
    PlannedPose pose;
    pose.id = json["id"].text();
    if (pose.id.empty()) throw json["id"].error("is empty; must be a name");
    if (json.has("times")) pose.times = json["times"].count(1);
    if (json.has("joints")) pose.configuration = read_configuration(json["joints"]);
    if (json.has("readable")) check_readable(json["readable"], json["joints"]);
    if (json.has("visible_targets")) {
        for (const JsonValue& target : json["visible_targets"].list()) {
            const Index shown = target.count(1, most_targets) - 1;
            if (std::ranges::find(pose.targets, shown) != pose.targets.end()) {
                throw target.error("occurs before; keep one");
            }
            pose.targets.push_back(shown);
        }
        if (pose.targets.empty()) {
            throw json["visible_targets"].error(
                "is empty: the pose shows no target; must name one");
        }
    }
    if (json.has("via") && !json["via"].is_null()) pose.via = read_configuration(json["via"]);
    if (json.has("way_is_blocked")) pose.is_blocked = json["way_is_blocked"].boolean();
    if (json.has("clearance_m") && !json["clearance_m"].is_null()) {
        const std::vector<std::string> bodies = json["nearest"].texts();
        if (bodies.size() != 2) throw json["nearest"].error("must be two names");
        pose.clearance = Clearance{json["clearance_m"].number(), bodies[0], bodies[1]};
    }
    if (json.has("kept")) pose.is_kept = json["kept"].boolean();
    return pose;
}

/// Where each id was read.
using Places = std::map<std::string, std::string>;

/// Poses of one list of a plan, each with its proper id, none twice, all with the same joints.
std::vector<PlannedPose> read_poses(const Json& list, const std::string& path, const char* key,
                                    Places& places, Plan& plan) {
    std::vector<PlannedPose> poses;
    for (const JsonValue& json : JsonValue(list, path, key).list()) {
        PlannedPose pose = read_pose(json);
        const auto [first, is_new] =
            places.emplace(pose.id, fmt::format("{}[{}]", key, poses.size()));
        if (!is_new) {
            throw json["id"].error(detail::quote(pose.id) + " occurs before in " + first->second +
                                   "; keep one");
        }
        const Json& read = list[poses.size()];
        if (json.has("joints")) {
            const auto columns = keys_of(read["joints"]);
            if (places.size() == 1) plan.columns = columns;
            if (columns != plan.columns) throw json["joints"].error("differ from poses[0].joints");
        }
        if (pose.via && keys_of(read["via"]) != plan.columns) {
            throw json["via"].error("has other joints than poses[0].joints; must have the same");
        }
        poses.push_back(std::move(pose));
    }
    return poses;
}

void read_all_poses(const Json& document, const std::string& path, Plan& plan) {
    const auto found = document.find("poses");
    if (found == document.end() || !found->is_array() || found->empty()) {
        throw input_error_at({path}, "poses: must be a list of at least one pose");
    }
    Places places;
    plan.poses = read_poses(*found, path, "poses", places, plan);
    const auto others = document.find("verification");
    if (others == document.end()) return;
    plan.verification = read_poses(*others, path, "verification", places, plan);
}

/// What stands with every pose of a plan of this kind.
void check_poses(const JsonValue& list, const Plan& plan) {
    for (const JsonValue& pose : list.list()) {
        const Index times = pose["times"].count(1);
        if (plan.kind != CandidateKind::Blocks) pose["joints"].values();
        if (!plan.is_continuous()) continue;
        if (times != 1) {
            throw pose["times"].error("is " + std::to_string(times) +
                                      "; must be 1, since each pose is planned once");
        }
        pose["visible_targets"].list();
        pose["via"];  // null, or a configuration
    }
}

}  // namespace

Plan read_plan(const std::string& path) {
    const Json json = detail::read_document(path, "plan");
    const JsonValue document(json, path);
    Plan plan;
    read_all_poses(json, path, plan);
    read_candidates(document["candidates"], path, plan);
    check_poses(document["poses"], plan);
    if (document.has("verification")) {
        check_poses(document["verification"], plan);
        plan.verification_time = document["verification_time_s"].number_or(infinity);
    }
    plan.request.criterion = read_criterion(document["criterion"]);
    read_problem(document["problem"], path, plan);
    if (document.has("cell_doubts")) plan.cell_doubts = document["cell_doubts"].texts();
    read_bounds(document, plan);
    read_search(document["search"], plan);
    if (plan.is_continuous()) read_prediction(document, json, plan);
    if (plan.kind != CandidateKind::Blocks) {
        plan.campaign = document["campaign"].text();
        document["assumes"].values();  // an object
        plan.assumptions = read_numbers(json["assumes"]);
    }
    return plan;
}

}  // namespace posewise::io
