#include "plan_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "core/ending_names.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/fields.hpp"
#include "io/format/units.hpp"
#include "planner/focus_names.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// As much as the command line takes.
constexpr Index most_poses = 1000000;
constexpr Index most_continuous_poses = 10000;
constexpr Index most_drawn = 10000000;
constexpr Index most_target_number = 10000;

constexpr Names<CandidateKind, 5> candidate_kinds{
    {{CandidateKind::Measurements, "measurements"},
     {CandidateKind::Configurations, "configurations"},
     {CandidateKind::Random, "random"},
     {CandidateKind::Blocks, "blocks"},
     {CandidateKind::Pool, "pool"}}};

constexpr Names<bool EarlierUse::*, 2> moved_parts{
    {{&EarlierUse::has_new_base, "base"}, {&EarlierUse::has_new_targets, "targets"}}};

constexpr Names<Ending, 5> endings{
    {{Ending::Converged, name_of(ending_names, Ending::Converged)},
     {Ending::Optimal, name_of(ending_names, Ending::Optimal)},
     {Ending::TimeLimit, name_of(ending_names, Ending::TimeLimit)},
     {Ending::Interrupted, name_of(ending_names, Ending::Interrupted)},
     {Ending::NotRun, name_of(ending_names, Ending::NotRun)}}};

// ---- Forms of fields ----

/// The path of another file, null if there is none. A relative one is seen from the folder of the
/// plan; read, it leads there from here.
struct FilePath {
    std::string plan_path;

    Json write(const std::string& path) const {
        if (path.empty()) return nullptr;
        if (std::filesystem::path(path).is_absolute()) return path;
        std::error_code failed;
        const auto folder = std::filesystem::absolute(plan_path, failed).parent_path();
        const auto from_folder = std::filesystem::proximate(path, folder, failed);
        return failed ? path : from_folder.generic_string();
    }
    void read(const JsonValue& json, std::string& path) const {
        if (json.is_null()) return;
        path = json.text();
        const auto from_plan = std::filesystem::path(plan_path).parent_path() / path;
        std::error_code ignored;
        if (std::filesystem::exists(from_plan, ignored)) path = from_plan.string();
    }
};

/// Null if it is empty.
struct NameOrNull {
    Json write(const std::string& name) const { return name.empty() ? Json(nullptr) : Json(name); }
    void read(const JsonValue& json, std::string& name) const {
        if (!json.is_null()) name = json.text();
    }
};

/// Null is infinity.
struct NumbersByName {
    Json write(const std::vector<NamedNumber>& numbers) const {
        Json json;
        for (const NamedNumber& one : numbers) json[one.name] = one.value;
        return json;
    }
    void read(const JsonValue& json, std::vector<NamedNumber>& numbers) const {
        for (const std::string& name : json.keys()) numbers.push_back({name, infinity});
        std::size_t k = 0;
        for (const JsonValue& value : json.values()) numbers[k++].value = value.number_or(infinity);
    }
};

/// Numbers by name, some within objects: "expected_error/dq2_rad". NaN: it is no number.
struct NestedNumbers {
    Json write(const std::vector<NamedNumber>& numbers) const { return numbers_to_json(numbers); }
    void read(const JsonValue& json, std::vector<NamedNumber>& numbers) const {
        json.keys();  // an object
        const Json flat = json.json().flatten();
        for (const auto& [place, value] : flat.items()) {
            if (place.empty()) continue;
            numbers.push_back({place.substr(1), value.is_number() ? value.get<double>() : nan});
        }
    }
};

/// A configuration by the columns of the plan.
struct Joints {
    const std::vector<std::string>& columns;

    Json write(const VectorXd& q) const {
        Json json;
        for (Index j = 0; j < q.size(); ++j) json[columns[static_cast<std::size_t>(j)]] = q[j];
        return json;
    }
    void read(const JsonValue& json, VectorXd& q) const {
        if (json.keys() != columns) {
            throw json.error("has other joints than poses[0].joints; must have the same");
        }
        q.resize(std::ssize(columns));
        Index j = 0;
        for (const JsonValue& number : json.values()) q[j++] = number.number();
    }
    void read(const JsonValue& json, std::optional<VectorXd>& q) const {
        if (!json.is_null()) read(json, q.emplace());
    }
};

/// In degrees and mm, rounded; none of torques. They are for people, who must not be sent
/// elsewhere: what is read must agree with the configuration that is known.
struct ReadableJoints {
    const std::vector<std::string>& columns;

    Json write(const VectorXd& q) const {
        Json json;
        for (Index j = 0; j < q.size(); ++j) {
            const std::string& column = columns[static_cast<std::size_t>(j)];
            for (const AmountUnits& units : {angle_units, length_units}) {
                if (!column.ends_with('_' + std::string(units.si))) continue;
                const std::string stem = column.substr(0, column.size() - units.si.size());
                json[stem + std::string(units.reading)] =
                    std::round(1e4 * units.to_reading(q[j])) / 1e4;
            }
        }
        return json;
    }
    void read(const JsonValue& json, const VectorXd& q) const {
        constexpr double rounding = 1e-3;  // deg or mm
        const Json expected = write(q);
        for (const auto& [name, value] : expected.items()) {
            const JsonValue stated = json[name];
            if (std::abs(stated.number() - value.get<double>()) <= rounding) continue;
            throw stated.breaks("must be " + value.dump() +
                                ", as joints say, or readable left out");
        }
    }
};

/// Numbers from 1, each once.
struct TargetNumbers {
    Json write(const std::vector<Index>& targets) const {
        Json json = Json::array();
        for (const Index target : targets) json.push_back(target + 1);
        return json;
    }
    void read(const JsonValue& json, std::vector<Index>& targets) const {
        for (const JsonValue& target : json.list()) {
            const Index shown = target.count(1, most_target_number) - 1;
            if (std::ranges::find(targets, shown) != targets.end()) {
                throw target.error("occurs before; keep one");
            }
            targets.push_back(shown);
        }
        if (targets.empty()) throw json.error("is empty: the pose shows no target; must name one");
    }
};

/// The rows of a symmetric matrix up to its diagonal.
struct LowerTriangle {
    Json write(const MatrixXd& matrix) const {
        Json rows = Json::array();
        for (Index i = 0; i < matrix.rows(); ++i) {
            rows.push_back(vector_to_json(matrix.row(i).head(i + 1).transpose()));
        }
        return rows;
    }
    void read(const JsonValue& json, MatrixXd& matrix) const {
        std::vector<std::vector<double>> rows;
        detail::read(json, rows, AnyValue{});
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (rows[i].size() == i + 1) continue;
            throw json.list()[i].error(fmt::format(
                "has {} numbers; must have {}, the lower triangle", rows[i].size(), i + 1));
        }
        matrix.resize(std::ssize(rows), std::ssize(rows));
        for (Index i = 0; i < matrix.rows(); ++i) {
            const std::vector<double>& row = rows[static_cast<std::size_t>(i)];
            for (Index j = 0; j <= i; ++j) {
                matrix(i, j) = matrix(j, i) = row[static_cast<std::size_t>(j)];
            }
        }
    }
};

// ---- Fields, in the order of the file ----

void candidate_fields(const Fields& file, Plan& plan, const FilePath& path) {
    PlanRequest& request = plan.request;
    file("kind", plan.kind, OneOf(candidate_kinds));
    file("campaign_file", request.sources.campaign, path);
    file("source", request.sources.candidates, path);
    if (plan.kind == CandidateKind::Blocks) {
        file("rows_per_block", request.sources.rows_per_block, Count{1, most_poses});
        file("variable", request.sources.variable);
    }
    if (plan.is_continuous()) file("drawn", request.pool_count, Count{1, most_drawn});
    file("count", plan.candidate_count,
         Count{1, plan.is_continuous() ? request.pool_count : most_drawn});
    if (!plan.is_continuous()) file("checksum", plan.checksum);
    file("repeats", request.repeats, Number{.least = 1, .most = 1e9});
}

void earlier_fields(const Fields& file, PlanRequest& request, const FilePath& path) {
    EarlierUse& use = request.earlier;
    std::vector<bool EarlierUse::*> moved;
    for (const auto& [part, unused] : moved_parts) {
        if (use.*part) moved.push_back(part);
    }
    file("file", request.sources.estimate, path);
    file("as_prior", use.is_prior);
    file("moved", moved, OneOf(moved_parts));
    file("only", use.only);
    for (const auto part : moved) use.*part = true;
    if (!use.is_prior) return;
    file("drift_m", use.drift.length, Number{.above = 0});
    file("drift_offset_rad", use.drift.offset, Number{.above = 0});
    file("drift_rad", use.drift.angle, Number{.above = 0});
}

void problem_fields(const Fields& file, Plan& plan, const FilePath& path) {
    PlanRequest& request = plan.request;
    PlanSources& sources = request.sources;
    file("pose_count", request.pose_count,
         Count{1, plan.is_continuous() ? most_continuous_poses : most_poses});
    file("prior", request.has_prior);
    file("focus", request.focus, OneOf(focus_names));
    file("augment", sources.augment, path);
    file.optional("measured_plan", !sources.measured_plan.empty(), sources.measured_plan, path);
    file.optional("points_unit", !sources.points_unit.empty(), sources.points_unit);
    if (file.has("estimate", !sources.estimate.empty())) {
        earlier_fields(file["estimate"], request, path);
    }
    if (plan.is_continuous()) {
        file("repaired_plan", sources.repaired, path);
        file("dropped", request.dropped);
        file("workspace", sources.workspace, path);
        file("workspace_poses", request.workspace_count, Count{1, 20000});
        file("workspace_box_mm", request.workspace_box_mm);
        file.check("workspace_box_mm",
                   request.workspace_box_mm.empty() || request.workspace_box_mm.size() == 6,
                   "must have 6 numbers or none");
        file("workspace_target", request.workspace_target, Count{0, most_target_number});
        file.optional("verification_count", true, request.verification_count,
                      Count{0, most_continuous_poses});
        file.optional("random_order", request.random_order > 0, request.random_order,
                      Number{.least = 1});
        file("time_limit_s", request.time_limit, Number{.least = 0});
    } else {
        file("test_poses", sources.test_poses, path);
        file("groups", sources.groups, path);
        file("group_limit", request.group_limit, Count{0, most_poses});
        file("excluded", request.excluded);
        file("repeat_limit", request.repeat_limit, Count{1, most_poses});
        file("least_distance_rad", request.least_distance, Number{.least = 0});
    }
}

void bound_fields(const Fields& file, Plan& plan) {
    const Number bound{.null = infinity};
    if (!plan.is_continuous()) {
        file("bound", plan.bound, bound);
        file("efficiency", plan.efficiency);
        return;
    }
    const Number efficiency{.least = 0, .most = 1 + 1e-9};  // but for rounding
    bool is_proven = true;
    const Fields bounds = file["bounds"];
    const Fields pool = bounds["pool"];
    pool("value", plan.choice_value, Number{.null = -infinity});
    pool("bound", plan.bound, bound);
    pool("efficiency", plan.efficiency, efficiency);
    pool("is_proven", is_proven);
    const Fields beyond = bounds["continuous"];
    is_proven = false;
    beyond("bound", plan.searched_bound, bound);
    beyond("efficiency", plan.searched_efficiency, efficiency);
    beyond("is_proven", is_proven);
    beyond.check("is_proven", !is_proven, "a bound that a search found is never proven");
}

void search_fields(const Fields& file, Plan& plan) {
    PlanRequest& request = plan.request;
    file("seed", request.seed);
    file("starts", request.starts, Count{0, 1000000});
    file("starts_at_best", plan.starts_at_best, Count{0, request.starts});
    file("stop_reason", plan.ending, OneOf(endings));
    file.check("stop_reason", !plan.is_continuous() || plan.ending != Ending::Optimal,
               "nothing proves that of continuous poses");
    file.optional("tried", plan.tried > 0, plan.tried, Count{});
    file.optional("proof_s", request.proof.has_value(), request.proof, Number{.least = 0});
}

void prediction_fields(const Fields& file, Plan& plan) {
    if (!plan.predicted) plan.predicted.emplace();
    file("position_error_rms_m", plan.predicted->rms);
    file("position_error_p95_m", plan.predicted->percentile95);
    file("standard_deviation", plan.standard_deviations, NumbersByName{});
}

void clearance_fields(const Fields& file, std::optional<Clearance>& clearance) {
    double distance = clearance ? clearance->distance : nan;
    std::vector<std::string> bodies;
    if (clearance) bodies = {clearance->body, clearance->other};
    file("clearance_m", distance, Number{.null = nan});
    file("nearest", bodies);
    if (std::isnan(distance)) return;
    file.check("nearest", bodies.size() == 2, "must be two names");
    clearance = Clearance{distance, bodies[0], bodies[1]};
}

void pose_fields(const Fields& file, PlannedPose& pose, const Plan& plan) {
    const bool is_continuous = plan.is_continuous();
    file("id", pose.id);
    file.check("id", !pose.id.empty(), "must be a name");
    file("times", pose.times, Count{1});
    file.check("times", !is_continuous || pose.times == 1,
               "must be 1, since each pose is planned once");
    const bool has_joints = file.has("joints", pose.configuration.size() > 0);
    if (plan.kind == CandidateKind::Blocks && !has_joints) return;
    file("joints", pose.configuration, Joints{plan.columns});
    file.optional("readable", is_continuous, pose.configuration, ReadableJoints{plan.columns});
    if (is_continuous || file.has("visible_targets", true)) {
        file("visible_targets", pose.targets, TargetNumbers{});
    }
    if (is_continuous || file.has("via", false)) file("via", pose.via, Joints{plan.columns});
    file.optional("way_is_blocked", is_continuous, pose.is_blocked);
    if (file.has("clearance_m", is_continuous)) clearance_fields(file, pose.clearance);
    file.optional("kept", is_continuous, pose.is_kept);
}

/// Reading needs Plan::columns first.
void plan_fields(const Fields& file, Plan& plan, const FilePath& path) {
    std::map<std::string, std::string> places;  // id to its place
    const auto state = [&](const Fields& item, PlannedPose& pose) {
        pose_fields(item, pose, plan);
        const auto [first, is_new] = places.emplace(pose.id, item.place());
        item.check("id", is_new, "must be another than that of " + first->second);
    };
    file("campaign", plan.campaign, NameOrNull{});
    candidate_fields(file["candidates"], plan, path);
    const bool has_campaign = plan.kind != CandidateKind::Blocks;
    file.check("campaign", !has_campaign || !plan.campaign.empty(), "must be its name");
    problem_fields(file["problem"], plan, path);
    file("criterion", plan.request.criterion);
    file("value", plan.value, Number{.null = -infinity});
    bound_fields(file, plan);
    search_fields(file["search"], plan);
    if (plan.is_continuous() && file.has("predicted", plan.predicted.has_value())) {
        prediction_fields(file["predicted"], plan);
        file("visiting_time_s", plan.visiting_time, Number{.least = 0, .null = infinity});
        file.optional("duration_s", true, plan.duration, Number{.least = 0, .null = infinity});
        file.optional("target_runs", plan.target_runs > 1, plan.target_runs, Count{1});
        file.optional("target_changed_at_poses", plan.is_target_changed_at_poses,
                      plan.is_target_changed_at_poses);
    }
    file.optional("cell_doubts", !plan.cell_doubts.empty(), plan.cell_doubts);
    if (has_campaign || file.has("assumes", !plan.assumptions.empty())) {
        file("assumes", plan.assumptions, NestedNumbers{});
    }
    file.list("poses", plan.poses, state);
    const Index count = std::ssize(plan.poses);
    file["problem"].check("pose_count", !plan.is_continuous() || plan.request.pose_count == count,
                          fmt::format("must be {}, as many as there are poses", count));
    if (file.has("verification", !plan.verification.empty())) {
        file.list("verification", plan.verification, state);
        file("verification_time_s", plan.verification_time, Number{.null = infinity});
    }
    if (plan.is_continuous()) return;
    const Fields certificate = file["certificate"];
    certificate("sharpness", plan.certificate.sharpness, Number{.above = 0, .null = infinity});
    certificate("M_lower", plan.certificate.M, LowerTriangle{});
}

/// The joints of the first pose, which all have; none of plain blocks.
std::vector<std::string> columns_of(const JsonValue& poses) {
    const std::vector<JsonValue> list = poses.list();
    if (list.empty()) throw poses.error("must be a list of at least one pose");
    return list[0].has("joints") ? list[0]["joints"].keys() : std::vector<std::string>();
}

}  // namespace

Json plan_to_json(const Plan& plan, const std::string& path) {
    Json document = make_document("plan");
    Plan written = plan;  // fields are stated for reading, too
    plan_fields(Fields(document), written, {path});
    return document;
}

}  // namespace posewise::detail

namespace posewise::io {

Plan read_plan(const std::string& path) { return parse_plan(detail::read_file(path), path); }

Plan parse_plan(const std::string& content, const std::string& path) {
    const detail::Json json = detail::parse_document(content, path, "plan");
    const detail::JsonValue document(json, path);
    Plan plan;
    plan.columns = detail::columns_of(document["poses"]);
    detail::plan_fields(detail::Fields(document), plan, {path});
    if (plan.is_continuous()) {
        document["predicted"];  // must be there
    } else {
        plan.choice_value = plan.value;
    }
    return plan;
}

}  // namespace posewise::io
